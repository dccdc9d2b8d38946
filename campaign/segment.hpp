/// \file
/// Segments: files of framed records, each appended to by one worker and never changed otherwise.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "withy/campaign/case_run.hpp"
#include "withy/results/output_file.hpp"

namespace withy::campaign {

/// The bytes of a record: all of a case's result, numbers bit by bit.
std::string encode(const CaseResult& result);
/// Nothing where the bytes are no record.
std::optional<CaseResult> decode(std::string_view bytes);

/// A frame is a tag, which is the beginning of the store's fingerprint, the length of the record, a CRC-32 of length
/// and record, and the record. A reader that meets anything else looks for the next tag, so that damage costs the
/// records it touches and no others.
class SegmentWriter {
 public:
  /// Appends to the file, which is locked as long as this lives.
  /// \throws FolderBusy where another process has it; std::system_error, as do the others.
  SegmentWriter(const std::filesystem::path& path, const std::string& fingerprint);
  ~SegmentWriter();
  SegmentWriter(const SegmentWriter&) = delete;
  SegmentWriter& operator=(const SegmentWriter&) = delete;
  /// Hands a record to the system: it survives the end of this process, whatever that is. A few times a minute it is
  /// made to survive a loss of power too.
  void append(const CaseResult& result);
  /// Once, last.
  void close();

 private:
  using Clock = std::chrono::steady_clock;
  int lock_;
  std::optional<OutputFile> file_;
  std::string tag_;
  Clock::time_point synced_ = Clock::now();
};

/// Reads the frames of a segment one after the other, with memory for a few of them.
class SegmentReader {
 public:
  /// \throws std::system_error where it cannot be read.
  SegmentReader(const std::filesystem::path& path, const std::string& fingerprint);
  /// Whether the head of the file is whole, and of the fingerprint.
  [[nodiscard]] bool begins_well() const { return begins_well_; }
  /// The record of the next frame that is whole, until the next call; nothing at the end.
  std::optional<std::string_view> next();
  /// Where in the file the last frame begins.
  [[nodiscard]] std::uint64_t place() const { return place_; }
  /// The record of the frame that begins there; nothing where it is not whole.
  std::optional<std::string_view> at(std::uint64_t place);
  /// Bytes so far that belong to no whole frame: damage, or the end of one that was being written.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  bool has(std::size_t count);
  void skip(std::size_t count);
  std::optional<std::string_view> frame();

  std::filesystem::path path_;
  std::ifstream file_;
  std::string tag_, head_;
  std::string buffer_;
  std::size_t from_ = 0;     ///< in the buffer
  std::uint64_t begin_ = 0;  ///< of the buffer in the file
  std::uint64_t place_ = 0, lost_ = 0;
  bool begins_well_ = false;
};

}  // namespace withy::campaign
