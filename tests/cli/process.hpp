/// \file
/// Runs programs as a user would, in a folder of their own, and keeps what they print.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace withy::test {

/// A new folder, removed at the end, in which `scenes` leads to the project's scenes.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::string read(const std::filesystem::path& file) const;
  void write(const std::filesystem::path& file, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

struct Finished {
  int status = -1;  ///< exit status; −signal where a signal ended it
  std::string out;
  std::string err;
};

/// A program under way, its working folder `folder`; standard output goes to `out` where that is given.
class Process {
 public:
  Process(const Folder& folder, std::vector<std::string> arguments, const std::string& out = "");
  [[nodiscard]] pid_t id() const { return id_; }
  Finished wait();

 private:
  const Folder& folder_;
  std::string out_;
  pid_t id_ = -1;
};

/// Waits until a condition holds; it is a failure of the test where it does not within minutes.
/// \returns whether it does
bool comes_true(const std::function<bool()>& condition);

/// Runs `withy` with arguments to its end.
Finished withy(const Folder& folder, std::vector<std::string> arguments);
/// Splits at spaces.
std::vector<std::string> words(const std::string& text);
std::vector<std::string> lines(const std::string& text);

}  // namespace withy::test
