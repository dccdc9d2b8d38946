/// \file
/// The integrators of the project.
#pragma once

#include "withy/core/plugin/integrator.hpp"
#include "withy/tests/conformance/plugins.hpp"

extern "C" {
extern const withy::PluginDescriptor withy_plugin_rk4;
extern const withy::PluginDescriptor withy_plugin_rk4_adaptive;
extern const withy::PluginDescriptor withy_plugin_dopri5;
extern const withy::PluginDescriptor withy_plugin_dop853;
extern const withy::PluginDescriptor withy_plugin_rosenbrock_w;
}

namespace withy {

inline Registry integrator_registry() {
  return registry_of({&withy_plugin_rk4, &withy_plugin_rk4_adaptive, &withy_plugin_dopri5, &withy_plugin_dop853,
                      &withy_plugin_rosenbrock_w});
}

inline std::unique_ptr<Integrator> make_integrator(const std::string& id, std::vector<Value::Member> given) {
  Registry registry = integrator_registry();
  return make_plugin<Integrator>(registry, id, std::move(given));
}

}  // namespace withy
