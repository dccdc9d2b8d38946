#include "withy/plugins/host/trust.hpp"

namespace withy {
namespace {

/// \param sticky whether a sticky bit protects what is in it
std::string exposure_of(const std::filesystem::path& path, bool sticky) {
  using std::filesystem::perms;
  const perms mode = std::filesystem::status(path).permissions();
  const auto has = [&](perms bit) { return (mode & bit) != perms::none; };
  if (!has(perms::others_write) || (sticky && has(perms::sticky_bit))) return {};
  return path.string() + " is writable by everybody, so its code cannot be trusted";
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
