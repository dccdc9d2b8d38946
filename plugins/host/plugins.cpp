#include "withy/plugins/host/plugins.hpp"

namespace withy {
namespace {

std::vector<std::filesystem::path> with_own(std::vector<std::filesystem::path> directories) {
  directories.push_back(PluginHost::default_directory());
  return directories;
}

}  // namespace

Plugins::Plugins(std::vector<std::filesystem::path> directories) : host_(with_own(std::move(directories))) {
  host_.attach(registry_);
}

}  // namespace withy
