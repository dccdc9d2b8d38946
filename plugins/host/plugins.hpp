/// \file
/// The plugins of a program, found once.
#pragma once

#include <filesystem>
#include <vector>

#include "withy/core/plugin/registry.hpp"
#include "withy/plugins/host/plugin_host.hpp"

namespace withy {

/// The plugins in a list of directories and in the package's own. Make one of a program and let its threads share it:
/// directories are read once, and a library is loaded when a scene first names what it has.
class __attribute__((visibility("default"))) Plugins {
 public:
  /// \param directories  searched beside PluginHost::default_directory()
  explicit Plugins(std::vector<std::filesystem::path> directories = {});
  [[nodiscard]] Registry& registry() { return registry_; }
  [[nodiscard]] const PluginHost& host() const { return host_; }

 private:
  PluginHost host_;
  Registry registry_;
};

}  // namespace withy
