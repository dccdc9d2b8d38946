#include "withy/results/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "withy/study/input_error.hpp"

namespace withy {

OutputFile::OutputFile(std::filesystem::path path, bool append)
    : path_(std::move(path)), file_(std::fopen(path_.c_str(), append ? "ae" : "we")) {
  if (!file_) fail();
}

void OutputFile::write(std::string_view text) {
  constexpr std::size_t many = 1 << 16;
  if (text.size() >= many) {  // not copied
    flush();
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() || std::fflush(file_.get()) != 0) fail();
    return;
  }
  if (waiting_.capacity() == 0) waiting_.reserve(many + (many >> 2));
  waiting_ += text;
  if (waiting_.size() >= many) flush();
}

void OutputFile::flush() {
  if (!hand_over()) fail();
}

bool OutputFile::hand_over() noexcept {
  const bool written = std::fwrite(waiting_.data(), 1, waiting_.size(), file_.get()) == waiting_.size();
  waiting_.clear();
  return std::fflush(file_.get()) == 0 && written;
}

OutputFile::~OutputFile() {
  if (file_) hand_over();  // of a run that ends by an exception
}

void OutputFile::sync() {
  flush();
  if (::fsync(::fileno(file_.get())) != 0) fail();
}

void OutputFile::close() {
  flush();
  if (std::fclose(file_.release()) != 0) fail();
}

void OutputFile::fail() const { throw std::system_error(errno, std::generic_category(), path_.string()); }

namespace {

/// What a name leads to through links, there or not.
std::filesystem::path target_of(std::filesystem::path file) {
  constexpr int most_links = 40;
  std::error_code failed;
  for (int links = 0; links < most_links && std::filesystem::is_symlink(file, failed); ++links) {
    const std::filesystem::path next = std::filesystem::read_symlink(file, failed);
    if (failed) break;
    file = next.is_absolute() ? next : file.parent_path() / next;
  }
  return file;
}

}  // namespace

Part::Part(const std::filesystem::path& file) : file_(file) {
  std::error_code ignored;
  const std::filesystem::file_status there = std::filesystem::status(file, ignored);
  if (std::filesystem::is_directory(there))
    throw study::InputError(file.string() + " is a folder; need the name of a file to write");
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) {
    path_ = file_;
    return;
  }
  path_ = file_ = target_of(file);
  path_ += ".part";
}

Part::~Part() {
  std::error_code ignored;
  if (!finished_ && !is_stream()) std::filesystem::remove(path_, ignored);
}

void Part::finish() {
  if (!is_stream()) std::filesystem::rename(path_, file_);
  finished_ = true;
}

void write_file(const std::filesystem::path& path, const std::function<void(OutputFile&)>& write) {
  Part part(path);
  OutputFile file(part.path());
  write(file);
  file.close();
  part.finish();
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  write_file(path, [&](OutputFile& file) { file.write(text); });
}

void write_lasting_file(const std::filesystem::path& path, std::string_view text) {
  Part part(path);
  OutputFile file(part.path());
  file.write(text);
  file.sync();
  file.close();
  part.finish();
  const int folder = ::open(path.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = folder >= 0 && ::fsync(folder) == 0;
  if (folder >= 0) ::close(folder);
  if (!synced) throw std::system_error(errno, std::generic_category(), path.parent_path().string());
}

}  // namespace withy
