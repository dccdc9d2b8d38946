/// \file
/// The project's plugins, for tests of studies.
#pragma once

#include "withy/plugins/host/plugin_host.hpp"

namespace withy::test {

/// A registry that finds every plugin of the build tree; one a process.
inline Registry& plugins() {
  static const PluginHost host({PluginHost::default_directory()});
  static Registry* const registry = [] {
    auto* made = new Registry;  // plugins stay for the life of the process
    host.attach(*made);
    return made;
  }();
  return *registry;
}

}  // namespace withy::test
