#include "withy/campaign/segment.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/crc.hpp>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "withy/results/json_text.hpp"
#include "withy/results/results_folder.hpp"

namespace withy::campaign {
namespace {

/// In the order of their numbers in records; what is none of them is written as "unknown".
constexpr std::array<std::string_view, 10> statuses = {"completed",      "refused",     "diverged", "singular",
                                                       "step-underflow", "interrupted", "unknown",  "inaccurate",
                                                       "load-failed",    "too-stiff"};
constexpr std::uint8_t unknown_status = 6;
constexpr std::size_t most_message = 4096;
constexpr std::size_t most_record = std::size_t{1} << 24;
constexpr std::size_t frame_head = 16;
constexpr auto between_syncs = std::chrono::seconds(10);

/// Numbers as the processor has them, which is little-endian wherever this runs.
template <class T>
void put(std::string& bytes, T x) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &x, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

/// Takes a record apart; `good` turns false where it is too short.
struct Parts {
  std::string_view rest;
  bool good = true;

  template <class T>
  T take() {
    T x{};
    if (rest.size() < sizeof(T)) {
      good = false;
      return x;
    }
    std::memcpy(&x, rest.data(), sizeof(T));
    rest.remove_prefix(sizeof(T));
    return x;
  }
  std::string text() {
    const auto length = take<std::uint32_t>();
    if (length > rest.size()) good = false;
    if (!good) return {};
    std::string taken(rest.substr(0, length));
    rest.remove_prefix(length);
    return taken;
  }
};

void put_text(std::string& bytes, std::string_view text) {
  put(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

enum class Cell : std::uint8_t { none, number, text, null };

void put_value(std::string& bytes, const std::optional<Value>& value) {
  if (!value) return put(bytes, Cell::none);
  switch (value->kind()) {
    case Value::Kind::null:
      return put(bytes, Cell::null);
    case Value::Kind::number:
      put(bytes, Cell::number);
      return put(bytes, value->number());
    default:
      put(bytes, Cell::text);
      put_text(bytes, value->kind() == Value::Kind::text ? value->text() : value_json(*value).dump());
  }
}

std::optional<Value> take_value(Parts& parts) {
  switch (parts.take<Cell>()) {
    case Cell::none:
      return {};
    case Cell::null:
      return Value();
    case Cell::number:
      return Value(parts.take<double>());
    default:
      return Value(parts.text());
  }
}

std::uint32_t checksum(std::uint32_t length, std::string_view record) {
  boost::crc_32_type crc;
  crc.process_bytes(&length, sizeof length);
  crc.process_bytes(record.data(), record.size());
  return crc.checksum();
}

/// The first eight bytes of a fingerprint.
std::string tag_of(const std::string& fingerprint) {
  std::string tag;
  for (std::size_t i = 0; i < 16; i += 2) tag += static_cast<char>(std::stoi(fingerprint.substr(i, 2), nullptr, 16));
  return tag;
}

/// The error that is left; who only looks whether a segment is locked has it for a moment.
int lock(int file) {
  constexpr int attempts = 20;
  for (int i = 0; i < attempts; ++i) {
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) return 0;
    if (errno != EWOULDBLOCK) return errno;
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }
  return EWOULDBLOCK;
}

std::string head_of(const std::string& fingerprint) { return "withy-segment/1 " + fingerprint + '\n'; }

}  // namespace

std::string encode(const CaseResult& result) {
  std::string bytes;
  put(bytes, result.index);
  put(bytes, result.seconds);
  const auto known = std::find(statuses.begin(), statuses.end(), result.status);
  put(bytes, known == statuses.end() ? unknown_status : static_cast<std::uint8_t>(known - statuses.begin()));
  put_text(bytes, std::string_view(result.message).substr(0, most_message));
  put(bytes, static_cast<std::uint32_t>(result.values.size()));
  for (const std::optional<Value>& value : result.values) put_value(bytes, value);
  put(bytes, static_cast<std::uint32_t>(result.numbers.size()));
  for (const double x : result.numbers) put(bytes, x);
  return bytes;
}

std::optional<CaseResult> decode(std::string_view bytes) {
  Parts parts{bytes};
  CaseResult result;
  result.index = parts.take<std::uint64_t>();
  result.seconds = parts.take<double>();
  const auto status = parts.take<std::uint8_t>();
  if (status >= statuses.size()) return {};
  result.status = statuses.at(status);
  result.message = parts.text();
  for (auto left = parts.take<std::uint32_t>(); left > 0 && parts.good; --left) {
    result.values.push_back(take_value(parts));
  }
  for (auto left = parts.take<std::uint32_t>(); left > 0 && parts.good; --left)
    result.numbers.push_back(parts.take<double>());
  if (!parts.good || !parts.rest.empty()) return {};
  return result;
}

SegmentWriter::SegmentWriter(const std::filesystem::path& path, const std::string& fingerprint)
    : lock_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)), tag_(tag_of(fingerprint)) {
  if (lock_ < 0) throw std::system_error(errno, std::generic_category(), path.string());
  if (const int error = lock(lock_); error != 0) {
    ::close(lock_);
    if (error != EWOULDBLOCK) throw std::system_error(error, std::generic_category(), path.string());
    throw FolderBusy(fmt::format("{} is being written by another process; wait for its end, or give another --shard",
                                 path.string()));
  }
  try {
    file_.emplace(path, true);
    if (std::filesystem::file_size(path) == 0) file_->write(head_of(fingerprint));
  } catch (...) {
    ::close(lock_);
    throw;
  }
}

SegmentWriter::~SegmentWriter() { ::close(lock_); }

void SegmentWriter::append(const CaseResult& result) {
  const std::string record = encode(result);
  const auto length = static_cast<std::uint32_t>(record.size());
  std::string frame = tag_;
  put(frame, length);
  put(frame, checksum(length, record));
  file_->write(frame + record);
  if (Clock::now() - synced_ < between_syncs) return file_->flush();
  file_->sync();
  synced_ = Clock::now();
}

void SegmentWriter::close() {
  file_->sync();
  file_->close();
}

SegmentReader::SegmentReader(const std::filesystem::path& path, const std::string& fingerprint)
    : path_(path), file_(path, std::ios::binary), tag_(tag_of(fingerprint)), head_(head_of(fingerprint)) {
  if (!file_) throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(), path.string());
  begins_well_ = has(head_.size()) && buffer_.starts_with(head_);
  if (begins_well_) from_ = head_.size();
}

/// Whether there are so many bytes from the present one on.
bool SegmentReader::has(std::size_t count) {
  constexpr std::size_t block = std::size_t{1} << 16;
  if (buffer_.size() - from_ < count) file_.clear();  // it may have reached the end, and the file grown since
  while (buffer_.size() - from_ < count) {
    buffer_.erase(0, from_);
    begin_ += from_;
    from_ = 0;
    const std::size_t had = buffer_.size();
    buffer_.resize(had + block);
    file_.read(buffer_.data() + had, block);
    if (file_.bad()) throw std::system_error(EIO, std::generic_category(), path_.string());
    buffer_.resize(had + static_cast<std::size_t>(file_.gcount()));
    if (buffer_.size() == had) return false;
  }
  return true;
}

void SegmentReader::skip(std::size_t count) {
  from_ += count;
  lost_ += count;
}

/// The record of the frame at the present byte; nothing where there is no whole one.
std::optional<std::string_view> SegmentReader::frame() {
  if (!has(frame_head) || buffer_.compare(from_, tag_.size(), tag_) != 0) return {};
  std::uint32_t length = 0, crc = 0;
  std::memcpy(&length, buffer_.data() + from_ + 8, sizeof length);
  std::memcpy(&crc, buffer_.data() + from_ + 12, sizeof crc);
  if (length > most_record || !has(frame_head + length)) return {};
  const std::string_view record(buffer_.data() + from_ + frame_head, length);
  if (checksum(length, record) != crc) return {};
  return record;
}

std::optional<std::string_view> SegmentReader::next() {
  while (has(1)) {
    if (const auto record = frame()) {
      place_ = begin_ + from_;
      from_ += frame_head + record->size();
      return record;
    }
    skip(1);
    // To the next byte that may begin a tag.
    const std::size_t at = std::min(buffer_.find(tag_[0], from_), buffer_.size());
    skip(at - from_);
  }
  return {};
}

std::optional<std::string_view> SegmentReader::at(std::uint64_t place) {
  if (place < begin_ || place >= begin_ + buffer_.size()) {
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(place));
    buffer_.clear();
    begin_ = place;
  }
  from_ = place - begin_;
  return frame();
}

}  // namespace withy::campaign
