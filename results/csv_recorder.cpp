#include "withy/results/csv_recorder.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>

#include "withy/results/csv.hpp"
#include "withy/results/results_error.hpp"
#include "withy/scene/csv_rows.hpp"

namespace withy {
namespace {

constexpr const char* remedy = "; run without --resume to begin anew";

/// Adds the bytes from `first` to `last` of a file; false where there are fewer.
bool add_bytes(Sha256& hash, const std::filesystem::path& path, std::uint64_t first, std::uint64_t last) {
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(first));
  std::array<char, 1 << 16> part;
  while (first < last && in) {
    in.read(part.data(), static_cast<std::streamsize>(std::min<std::uint64_t>(part.size(), last - first)));
    const auto count = static_cast<std::size_t>(in.gcount());
    hash.add({part.data(), count});
    first += count;
  }
  return first == last;
}

/// The path, once its file is cut off at the mark.
std::filesystem::path cut(std::filesystem::path path, const RecordMark& mark) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(path, none);
  if (none || size < mark.bytes) throw ResultsError(path.string() + " is shorter than at its checkpoint" + remedy);
  Sha256 hash;
  if (!add_bytes(hash, path, 0, mark.bytes) || hash.digest() != mark.sha256)
    throw ResultsError(path.string() + " is not what it was at its checkpoint" + remedy);
  std::filesystem::resize_file(path, mark.bytes);
  return path;
}

}  // namespace

CsvRecorder::CsvRecorder(std::filesystem::path path) : path_(std::move(path)), file_(path_) {}

CsvRecorder::CsvRecorder(std::filesystem::path path, const RecordMark& mark)
    : path_(cut(std::move(path), mark)), at_(mark), file_(path_, true) {}

void CsvRecorder::begin(const std::vector<Column>& columns) {
  const std::string head = csv_head(columns);
  if (at_.bytes == 0) return write(head);
  std::ifstream in(path_, std::ios::binary);
  std::string kept(head.size(), '\0');
  in.read(kept.data(), static_cast<std::streamsize>(kept.size()));
  if (!in || kept != head) throw ResultsError(path_.string() + " has other columns" + remedy);
}

void CsvRecorder::row(std::span<const double> numbers) {
  write(csv_line(numbers));
  ++at_.rows;
}

RecordMark CsvRecorder::mark() {
  file_.sync();
  if (!add_bytes(hash_, path_, hashed_, at_.bytes))
    throw ResultsError(path_.string() + " has become shorter while it was written");
  hashed_ = at_.bytes;
  at_.sha256 = hash_.digest();
  return at_;
}

void CsvRecorder::end() { file_.close(); }

void CsvRecorder::write(const std::string& text) {
  file_.write(text);
  at_.bytes += text.size();
  // A call of the system for every row costs more than the row.
  const auto now = std::chrono::steady_clock::now();
  if (now - flushed_ < std::chrono::milliseconds(200)) return;
  file_.flush();
  flushed_ = now;
}

void read_csv(const std::filesystem::path& path, Recorder& recorder, OpenLine last) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::system_error(errno, std::generic_category(), path.string());
  std::string line;
  std::size_t number = 0, columns = 0;
  std::vector<double> numbers;
  try {
    while (std::getline(in, line) && (last == OpenLine::taken || !in.eof())) {
      if (line.ends_with('\r')) line.pop_back();
      if (++number == 1) {
        const std::vector<Column> head = read_csv_head(behind_mark(line));
        columns = head.size();
        recorder.begin(head);
        continue;
      }
      read_csv_line(line, numbers);
      if (numbers.size() != columns)
        throw std::invalid_argument("expected " + std::to_string(columns) + " numbers, as there are columns, got " +
                                    std::to_string(numbers.size()));
      recorder.row(numbers);
    }
  } catch (const std::invalid_argument& e) {
    throw ResultsError(path.string() + ':' + std::to_string(number) + ": " + e.what());
  }
}

}  // namespace withy
