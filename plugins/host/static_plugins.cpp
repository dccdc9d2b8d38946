#include "withy/plugins/host/static_plugins.hpp"

#include "withy/core/plugin/entry.hpp"

namespace withy {

void enroll_static_plugins(Registry& registry) {
  for (const PluginDescriptor* plugin : static_plugins()) {
    registry.admit(enroll_from(*plugin, std::string("the built-in plugin ") + plugin->name), "built in");
  }
}

}  // namespace withy
