#include "withy/results/picture_file.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>

#include "withy/results/output_file.hpp"
#include "withy/scene/document.hpp"
#include "withy/study/input_error.hpp"

namespace withy {
namespace {

namespace fs = std::filesystem;

/// A file beside another, removed at the end unless it has been renamed.
class FileBeside {
 public:
  FileBeside(const fs::path& file, const char* end) : path_(fmt::format("{}.{}{}", file.string(), ::getpid(), end)) {}
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;
  ~FileBeside() {
    std::error_code none;
    fs::remove(path_, none);
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Runs rsvg-convert, whose words go to standard error. \return its exit status
int convert(const std::string& svg, const std::string& png) {
  std::array<std::string, 8> words = {"rsvg-convert", "--zoom",   "2", "--background-color",
                                      "white",        "--output", png, svg};
  std::array<char*, words.size() + 1> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  pid_t child = 0;
  const int failed = ::posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ);
  if (failed == ENOENT)
    throw std::runtime_error(
        "a .png is drawn by rsvg-convert, which is not installed (Debian: apt install librsvg2-bin); --out with a name "
        "that ends in .svg needs nothing");
  if (failed != 0) throw std::system_error(failed, std::generic_category(), "rsvg-convert");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "rsvg-convert");
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

void write_picture(const fs::path& file, std::string_view svg) {
  const std::string end = file.extension().string();
  if (end == ".svg") return write_file(file, svg);
  if (end != ".png")
    throw study::InputError(
        fmt::format("got the file '{}' for a picture; need a name that ends in .svg or .png", file.string()));
  const FileBeside from(file, ".svg"), to(file, ".png");
  write_file(from.path(), svg);
  const int status = convert(from.path(), to.path());
  if (status != 0 || !fs::exists(to.path()))
    throw std::runtime_error(
        fmt::format("{} could not be drawn: rsvg-convert ended with status {}", file.string(), status));
  write_file(file, read_bytes(to.path()));
}

}  // namespace withy
