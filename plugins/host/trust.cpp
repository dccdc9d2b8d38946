#include "withy/plugins/host/trust.hpp"

namespace withy {

std::string exposure(const std::filesystem::path& path) {
  using std::filesystem::perms;
  const auto has = [](perms all, perms bit) { return (all & bit) != perms::none; };
  for (std::filesystem::path p = path;; p = p.parent_path()) {
    const perms mode = std::filesystem::status(p).permissions();
    const bool above = p != path;
    if (has(mode, perms::others_write) && !(above && has(mode, perms::sticky_bit))) {
      return p.string() + " is writable by everybody, so its code cannot be trusted";
    }
    if (p == p.parent_path()) return {};
  }
}

}  // namespace withy
