#include "withy/scene/sources.hpp"

#include <algorithm>
#include <tuple>

namespace withy {
namespace {

/// Puts it in its place, unless it is there.
template <class T, class Key>
void insert(std::vector<T>& all, T one, Key&& key) {
  const auto before = [&](const T& a, const T& b) { return key(a) < key(b); };
  const auto at = std::lower_bound(all.begin(), all.end(), one, before);
  if (at == all.end() || before(one, *at)) all.insert(at, std::move(one));
}

}  // namespace

void SceneSources::add(FileUsed file) {
  insert(files, std::move(file), [](const FileUsed& f) { return std::tie(f.path, f.sha256); });
}

void SceneSources::add(PluginUsed plugin) {
  insert(plugins, std::move(plugin), [](const PluginUsed& p) { return std::tie(p.kind, p.id); });
}

}  // namespace withy
