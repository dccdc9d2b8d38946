/// \file
/// Plugins from parameters, as a scene would make them, for tests that need no scene.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <string>

#include "withy/core/plugin/entry.hpp"

namespace withy {

/// A map of parameters with what is not given at its default.
inline Value with_defaults(const std::vector<ParameterSpec>& specs, std::vector<Value::Member> given) {
  Value map = Value::map(std::move(given));
  for (const ParameterSpec& spec : specs) {
    if (spec.fallback && !map.has(spec.key)) map.set(spec.key, *spec.fallback);
  }
  return map;
}

/// A registry with the plugins of some libraries.
inline Registry registry_of(std::initializer_list<const PluginDescriptor*> libraries) {
  Registry registry;
  for (const PluginDescriptor* d : libraries) registry.admit(enroll_from(*d, d->name), d->name);
  return registry;
}

/// Makes something with a plugin. Null, with the problems in `diagnostics`, where its factory reports some.
template <class Interface>
std::unique_ptr<Interface> make_plugin(Registry& registry, const std::string& id, std::vector<Value::Member> given,
                                       Diagnostics& diagnostics) {
  const Plugin<Interface>* plugin = registry.find<Interface>(id);
  if (plugin == nullptr) {
    ADD_FAILURE() << "no plugin '" << id << "'";
    return nullptr;
  }
  return plugin->make(with_defaults(plugin->parameters, std::move(given)), {registry, diagnostics});
}

/// The same where no problem is expected.
template <class Interface>
std::unique_ptr<Interface> make_plugin(Registry& registry, const std::string& id,
                                       std::vector<Value::Member> given = {}) {
  Diagnostics diagnostics;
  auto made = make_plugin<Interface>(registry, id, std::move(given), diagnostics);
  for (const Diagnostic& d : diagnostics.errors()) ADD_FAILURE() << id << ": " << d.message;
  return made;
}

}  // namespace withy
