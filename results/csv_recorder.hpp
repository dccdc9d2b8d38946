/// \file
/// A table as a file of comma-separated values, written row by row.
#pragma once

#include <chrono>
#include <filesystem>

#include "withy/results/output_file.hpp"
#include "withy/results/recorder.hpp"
#include "withy/scene/sha256.hpp"

namespace withy {

/// Rows reach the system some at a time, never a part of one: a run that is killed leaves whole lines. None waits
/// longer than a fifth of a second for the next: who watches a long run sees it.
class CsvRecorder final : public Recorder {
 public:
  /// A file from its beginning, in the place of any other.
  explicit CsvRecorder(std::filesystem::path path);
  /// Goes on behind a mark; what was written after it is cut off, since it is written again.
  /// \throws ResultsError where the file is not what it was at the mark.
  CsvRecorder(std::filesystem::path path, const RecordMark& mark);

  void begin(const std::vector<Column>& columns) override;
  void row(std::span<const double> numbers) override;
  RecordMark mark() override;
  void end() override;

 private:
  void write(const std::string& text);

  std::filesystem::path path_;
  RecordMark at_;
  std::uint64_t hashed_ = 0;  ///< bytes that hash_ has seen
  Sha256 hash_;
  OutputFile file_;
  std::chrono::steady_clock::time_point flushed_ = std::chrono::steady_clock::now();
};

/// A last line that has no end: of a run that was killed it may be cut, other programs leave the end out.
enum class OpenLine { left_out, taken };
/// Gives a recorder the table of such a file, which is not ended. \throws ResultsError naming the line where it is no
/// such file; std::system_error where it cannot be read
void read_csv(const std::filesystem::path& path, Recorder& recorder, OpenLine last = OpenLine::left_out);

}  // namespace withy
