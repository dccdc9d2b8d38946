#include "withy/plugins/host/trust.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/dll/runtime_symbol_info.hpp>
#include <cerrno>
#include <set>

namespace withy {
namespace {

struct stat status_of(const std::filesystem::path& path) {
  struct stat s = {};
  if (::stat(path.c_str(), &s) != 0)
    throw std::filesystem::filesystem_error("stat", path, std::error_code(errno, std::generic_category()));
  return s;
}

/// Who could replace this very program, and need not be kept from adding to it: the administrator, its user, and who
/// may write its own library or a folder above it.
struct Trusted {
  std::set<uid_t> users = {0, ::geteuid()};
  std::set<gid_t> groups = {0};

  Trusted() {
    for (std::filesystem::path p = std::filesystem::canonical(boost::dll::this_line_location());; p = p.parent_path()) {
      const struct stat s = status_of(p);
      users.insert(s.st_uid);
      if ((s.st_mode & S_IWGRP) != 0) groups.insert(s.st_gid);
      if (p == p.parent_path()) break;
    }
  }
  /// A user's own group has the user's number (Debian).
  [[nodiscard]] bool group(gid_t id) const { return groups.contains(id) || (id != 0 && users.contains(id)); }
};

/// \param sticky whether a sticky bit protects what is in it
std::string exposure_of(const std::filesystem::path& path, bool sticky) {
  static const Trusted trusted;
  const struct stat s = status_of(path);
  const auto why = [&](const std::string& text) { return path.string() + text + ", so its code cannot be trusted"; };
  if (!trusted.users.contains(s.st_uid)) return why(fmt::format(" belongs to another user ({})", s.st_uid));
  if (sticky && (s.st_mode & S_ISVTX) != 0) return {};
  if ((s.st_mode & S_IWOTH) != 0) return why(" is writable by everybody");
  if ((s.st_mode & S_IWGRP) != 0 && !trusted.group(s.st_gid))
    return why(fmt::format(" is writable by a group ({})", s.st_gid));
  return {};
}

}  // namespace

std::string exposure(const std::filesystem::path& path) {
  for (std::filesystem::path p = path;; p = p.parent_path()) {
    if (std::string exposed = exposure_of(p, p != path); !exposed.empty()) return exposed;
    if (p == p.parent_path()) return {};
  }
}

std::string exposure_in_safe_directory(const std::filesystem::path& file) { return exposure_of(file, false); }

}  // namespace withy
