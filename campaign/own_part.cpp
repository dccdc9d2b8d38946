#include "withy/campaign/own_part.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <string>
#include <string_view>
#include <system_error>

namespace withy::campaign {
namespace {

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// Whether the process that writes a part has ended without finishing it: of this machine where there is no such
/// process, of others, which write to the same store, where nothing was written for a day.
/// \param writer "4711-123.node7", or without the middle, as earlier versions have it
bool is_left_behind(const std::filesystem::path& part, std::string_view writer) {
  constexpr std::chrono::hours long_ago(24);
  constexpr std::string_view unwritten = ".part";  // of a part that is itself written by a Part
  if (writer.ends_with(unwritten)) writer.remove_suffix(unwritten.size());
  pid_t process = 0;
  const auto read = std::from_chars(writer.data(), writer.data() + writer.size(), process);
  if (read.ec != std::errc() || process <= 0) return false;
  const std::size_t dot = writer.find('.');
  if (dot != std::string_view::npos && writer.substr(dot + 1) == host_name())
    return ::kill(process, 0) != 0 && errno == ESRCH;
  std::error_code failed;
  const auto written = std::filesystem::last_write_time(part, failed);
  return !failed && std::filesystem::file_time_type::clock::now() - written > long_ago;
}

}  // namespace

std::filesystem::path own_part(const std::filesystem::path& file) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
  return fmt::format("{}.part{}-{}.{}", file.string(), ::getpid(), now, host_name());
}

void clear_parts(const std::filesystem::path& file) {
  const std::string begin = file.filename().string() + ".part";
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(begin) && is_left_behind(entry.path(), std::string_view(name).substr(begin.size())))
      std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace withy::campaign
