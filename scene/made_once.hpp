/// \file
/// Equal parts of a scene are one object.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>

#include "withy/scene/make.hpp"
#include "withy/scene/same_content.hpp"

namespace withy {

/// Makes the objects of a scene, each once for all maps that give its plugin the same parameters. Objects are
/// immutable, so that nobody sees whether they are one; a chain of equal links has the modes and integrals of one link.
template <class Interface>
class MadeOnce {
 public:
  /// As make_or_recall; null after reported problems.
  std::shared_ptr<const Interface> of(const Plugin<Interface>& plugin, const Value& value, const Checker& checker) {
    std::string key = plugin.id;
    for (const ParameterSpec& parameter : plugin.parameters) {
      key += '\n' + parameter.key;
      if (const Value* given = value.find(parameter.key)) append_content(key, *given);
    }
    std::shared_ptr<const Interface>& made = made_[key];
    if (made == nullptr) made = make_or_recall(plugin, value, checker);
    return made;
  }

 private:
  std::unordered_map<std::string, std::shared_ptr<const Interface>> made_;
};

}  // namespace withy
