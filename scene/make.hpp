/// \file
/// From a checked map of a scene to the object that a plugin makes of it.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <new>

#include "withy/core/plugin/floating_point.hpp"
#include "withy/scene/check.hpp"
#include "withy/scene/names.hpp"

namespace withy {

/// What became of one named map of a scene.
template <class Interface>
struct Made {
  const Plugin<Interface>* plugin = nullptr;  ///< null: unknown
  Value value;                                ///< the members that are right, in SI units
  std::unique_ptr<Interface> object;          ///< null after reported problems
};

/// Makes the object; every problem is reported at the value's key.
/// \throws PluginError where a library the plugin asks for is refused, or the plugin changes the processor's
/// arithmetic.
template <class Interface>
std::unique_ptr<Interface> make_object(const Plugin<Interface>& plugin, const Value& value, const Checker& checker) {
  const std::size_t before = checker.diagnostics().errors().size();
  const std::string& path = value.place().path;
  const auto blame = [&](const std::string& why) {
    checker.key_error(path, fmt::format("{} '{}' {}", kind_name<Interface>(), plugin.id, why));
  };
  std::unique_ptr<Interface> object;
  FloatingPointGuard arithmetic;
  try {
    object = plugin.make(value, checker.make_context());
  } catch (const PluginError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    blame(std::string("cannot be made: ") + e.what());
    return nullptr;
  } catch (...) {
    blame("cannot be made: it throws what is no exception of C++");
    return nullptr;
  }
  arithmetic.check(fmt::format("{} '{}' of {}", kind_name<Interface>(), plugin.id, plugin.origin));
  if (checker.diagnostics().errors().size() != before) return nullptr;
  if (object == nullptr) blame("cannot be made and does not say why");
  return object;
}

/// Checks a map against the members common to its kind and those of the plugin that `key` names.
/// \returns `made.value`, or null where not all of it is right.
template <class Interface>
const Value* check_plugin_map(const Value& given, const std::string& key, const std::vector<ParameterSpec>& members,
                              const Checker& checker, Made<Interface>& made) {
  made.value = Value::map({}, given.place());
  const auto expected = [&] {
    return fmt::format("a map with '{}' and what that {} takes", key, kind_name<Interface>());
  };
  if (!checker.is_map(given, expected)) return nullptr;
  const Value* id = given.find(key);
  Value fallback;
  if (id == nullptr) {
    for (const ParameterSpec& m : members) {
      if (m.key == key && m.fallback) fallback = placed(*m.fallback, given.place());
    }
    id = &fallback;
  }
  if (id->kind() == Value::Kind::null) {
    checker.key_error(given.place().path + "/" + key,
                      fmt::format("missing; need one of: {}", listed(checker.registry().ids<Interface>())));
    return nullptr;
  }
  made.plugin = checker.plugin<Interface>(*id);
  if (made.plugin == nullptr) return nullptr;
  return checker.read_members(given, {&members, &made.plugin->parameters}, made.value) ? &made.value : nullptr;
}

}  // namespace withy
