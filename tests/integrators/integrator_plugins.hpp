/// \file
/// The integrators of the project.
#pragma once

#include "withy/core/plugin/integrator.hpp"
#include "withy/tests/conformance/plugins.hpp"

extern "C" {
extern const withy::PluginDescriptor withy_plugin_integrators;
}

namespace withy {

inline Registry integrator_registry() { return registry_of({&withy_plugin_integrators}); }

inline std::unique_ptr<Integrator> make_integrator(const std::string& id, std::vector<Value::Member> given) {
  Registry registry = integrator_registry();
  return make_plugin<Integrator>(registry, id, std::move(given));
}

/// Error control that accepts every step: equal steps. Iterations go on to rounding.
inline std::unique_ptr<Integrator> make_uncontrolled(const std::string& id, double step) {
  std::vector<Value::Member> given{
      {"rtol", Value(1.0)}, {"atol", Value(1e200)}, {"initial_step", Value(step)}, {"max_step", Value(step)}};
  if (id == "radau") given.emplace_back("iteration_error", Value(1e-214));
  return make_integrator(id, std::move(given));
}

}  // namespace withy
