/// \file
/// From a checked map of a scene to the object that a plugin makes of it.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <new>
#include <type_traits>

#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/file_notes.hpp"
#include "withy/core/plugin/floating_point.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/scene/check.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/scene_parts.hpp"
#include "withy/scene/sha256.hpp"

namespace withy {

/// What became of one named map of a scene.
template <class Interface>
struct Made {
  const Plugin<Interface>* plugin = nullptr;  ///< null: unknown
  Value value;                                ///< the members that are right, in SI units
  std::unique_ptr<Interface> object;          ///< null after reported problems
};

/// What is wrong with an object that a plugin has made, or empty. A formulation is asked what it is here, so that what
/// it throws is reported where the scene names it.
template <class Interface>
std::string fault_of_made(const Interface& object) {
  if constexpr (std::is_same_v<Interface, Hinge>) {
    if (const std::string fault = find_fault(object); !fault.empty()) return "made a motion that cannot be: " + fault;
  } else if constexpr (std::is_same_v<Interface, Motion>) {
    if (const std::string fault = find_fault(object); !fault.empty()) return "made a course that cannot be: " + fault;
  } else if constexpr (std::is_same_v<Interface, Formulation>) {
    static_cast<void>(object.terms());
    static_cast<void>(object.standing());
  }
  return {};
}

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
  const auto reported = [&](const std::string& what, auto&& call) {
    try {
      call();
      return true;
    } catch (const PluginError&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& e) {
      blame(what + ": " + e.what());
    } catch (...) {
      blame(what + ": it throws what is no exception of C++");
    }
    return false;
  };
  std::unique_ptr<Interface> object;
  FloatingPointGuard arithmetic;
  if (!reported("cannot be made", [&] { object = plugin.make(value, checker.make_context()); })) return nullptr;
  arithmetic.check(fmt::format("{} '{}' of {}", kind_name<Interface>(), plugin.id, plugin.origin));
  if (checker.diagnostics().errors().size() != before) return nullptr;
  if (object == nullptr) {
    blame("cannot be made and does not say why");
    return nullptr;
  }
  std::string fault;
  if (!reported("does not say what it is", [&] { fault = fault_of_made(*object); })) return nullptr;
  if (!fault.empty()) {
    blame(fault);
    return nullptr;
  }
  return object;
}

/// The same, or the object that was made of the same before, where the checker has remembered it.
template <class Interface>
std::shared_ptr<const Interface> make_or_recall(const Plugin<Interface>& plugin, const Value& value,
                                                const Checker& checker) {
  SceneParts* const parts = checker.parts();
  if (parts == nullptr) return make_object(plugin, value, checker);
  if (auto known = parts->made(kind_name<Interface>(), &plugin, value))
    return std::static_pointer_cast<const Interface>(std::move(known));
  bool reads = false;
  std::shared_ptr<const Interface> object;
  {
    const FileNotes notes([&](const std::string& file, std::string_view bytes) {
      reads = true;
      if (checker.noted() != nullptr) checker.noted()->add(FileUsed{file, sha256(bytes)});
    });
    object = make_object(plugin, value, checker);
  }
  if (object != nullptr && !reads) parts->remember(kind_name<Interface>(), &plugin, value, object);
  return object;
}

/// check_plugin_map of what is not remembered.
template <class Interface>
const Value* check_plugin_map_anew(const Value& given, const std::string& key,
                                   const std::vector<ParameterSpec>& members, const Checker& checker,
                                   Made<Interface>& made) {
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

/// Checks a map against the members common to its kind and those of the plugin that `key` names.
/// \returns `made.value`, or null where not all of it is right.
template <class Interface>
const Value* check_plugin_map(const Value& given, const std::string& key, const std::vector<ParameterSpec>& members,
                              const Checker& checker, Made<Interface>& made) {
  SceneParts* const parts = checker.parts();
  if (parts == nullptr) return check_plugin_map_anew(given, key, members, checker, made);
  if (const SceneParts::Checked* known = parts->checked(kind_name<Interface>(), given)) {
    for (const PluginUsed& plugin : known->sources.plugins) checker.noted()->add(plugin);
    made.plugin = static_cast<const Plugin<Interface>*>(known->plugin);
    made.value = known->value;
    return &made.value;
  }
  const std::size_t before = checker.diagnostics().errors().size();
  SceneSources sources;
  SceneSources* const all = checker.note(&sources);
  const Value* const value = check_plugin_map_anew(given, key, members, checker, made);
  checker.note(all);
  for (const PluginUsed& plugin : sources.plugins) all->add(plugin);
  if (value != nullptr && checker.diagnostics().errors().size() == before)
    parts->remember(kind_name<Interface>(), given, made.plugin, *value, std::move(sources));
  return value;
}

}  // namespace withy
