#include "withy/tests/cli/process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

namespace withy::test {
namespace fs = std::filesystem;

Folder::Folder() {
  std::string name = (fs::temp_directory_path() / "withy-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category(), name);
  path_ = name;
  fs::create_directory_symlink(fs::path(WITHY_SOURCES) / "scenes", path_ / "scenes");
}

Folder::~Folder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string Folder::read(const fs::path& file) const {
  const std::ifstream in(path_ / file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void Folder::write(const fs::path& file, const std::string& text) const {
  fs::create_directories((path_ / file).parent_path());
  std::ofstream(path_ / file) << text;
}

Process::Process(const Folder& folder, std::vector<std::string> arguments, const std::string& out)
    : folder_(folder), out_(out.empty() ? (folder.path() / ".stdout").string() : out) {
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  argv.push_back(nullptr);
  const std::string err = (folder.path() / ".stderr").string();
  id_ = ::fork();
  if (id_ != 0) return;
  const int out_file = ::open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err_file = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(out_file, STDOUT_FILENO);
  ::dup2(err_file, STDERR_FILENO);
  if (::chdir(folder.path().c_str()) == 0) ::execv(argv[0], argv.data());
  ::_exit(127);
}

Finished Process::wait() {
  int status = 0;
  ::waitpid(id_, &status, 0);
  Finished f;
  f.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  if (out_ != "/dev/full") f.out = folder_.read(out_);
  f.err = folder_.read(".stderr");
  return f;
}

bool comes_true(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(3);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) {
      ADD_FAILURE() << "what is waited for has not come true";
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

Finished withy(const Folder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), WITHY_PROGRAM);
  return Process(folder, std::move(arguments)).wait();
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> all;
  for (std::string w; in >> w;) all.push_back(w);
  return all;
}

std::vector<std::string> lines(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> all;
  for (std::string l; std::getline(in, l);) all.push_back(l);
  return all;
}

}  // namespace withy::test
