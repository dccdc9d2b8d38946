// A plugin with one parameter, `fault`, of which its class is made.
#pragma once

#include <memory>
#include <utility>

#include "withy/core/plugin/registry.hpp"

namespace withy::test {

/// Of a class whose constructor takes the fault as text; "nothing" where a scene names none.
template <class Interface, class Faulty>
Plugin<Interface> faulty_plugin(const char* id) {
  Plugin<Interface> plugin;
  plugin.id = id;
  plugin.parameters = {text("fault", "what is wrong with it").otherwise("nothing")};
  plugin.make = [](const Value& p, const MakeContext&) -> std::unique_ptr<Interface> {
    return std::make_unique<Faulty>(p.text_at("fault"));
  };
  return plugin;
}

}  // namespace withy::test
