/// \file
/// A table as a file of comma-separated values, written row by row.
#pragma once

#include <filesystem>

#include "withy/results/output_file.hpp"
#include "withy/results/recorder.hpp"
#include "withy/scene/sha256.hpp"

namespace withy {

/// Every row has reached the system before the next begins: a run that is killed leaves whole lines.
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
};

}  // namespace withy
