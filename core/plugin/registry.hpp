/// \file
/// The registry: every plugin by kind and id. Tests and single binaries enroll plugins directly; the host in
/// `plugins/host` loads them from shared libraries when they are asked for.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "withy/core/plugin/parameters.hpp"

namespace withy {

class Body;
class Hinge;
class ModeFamily;
class Formulation;
class Integrator;
class Load;
class Motion;
class StrainKinematics;
class Sensor;
class Registry;

/// What a plugin is told when it makes something: where other plugins are found, where to report, for which object.
struct MakeContext {
  Registry& registry;
  Diagnostics& diagnostics;
  std::string directory = {};  ///< where relative file names start: the scene's; empty: the working directory
};

/// A plugin: its id (`[a-z0-9-]{1,64}`), what it is for, the parameters it takes, and its factory. `make` returns null
/// after it has reported to MakeContext::diagnostics.
template <class Interface>
struct Plugin {
  std::string id;
  std::string summary;  ///< one sentence
  std::vector<ParameterSpec> parameters;
  std::unique_ptr<Interface> (*make)(const Value& parameters, const MakeContext& context) = nullptr;
  std::string origin = "built in";  ///< file it was loaded from
};

/// The kinds of plugins, with their names in manifests and messages.
template <class Interface>
constexpr std::string_view kind_name();
template <>
constexpr std::string_view kind_name<Body>() {
  return "body";
}
template <>
constexpr std::string_view kind_name<Hinge>() {
  return "hinge";
}
template <>
constexpr std::string_view kind_name<ModeFamily>() {
  return "mode-family";
}
template <>
constexpr std::string_view kind_name<Formulation>() {
  return "formulation";
}
template <>
constexpr std::string_view kind_name<Integrator>() {
  return "integrator";
}
template <>
constexpr std::string_view kind_name<Load>() {
  return "load";
}

template <>
constexpr std::string_view kind_name<Motion>() {
  return "motion";
}

template <>
constexpr std::string_view kind_name<StrainKinematics>() {
  return "strain-kinematics";
}

template <>
constexpr std::string_view kind_name<Sensor>() {
  return "sensor";
}

inline constexpr std::array<std::string_view, 9> plugin_kinds = {
    kind_name<Body>(),       kind_name<Hinge>(), kind_name<ModeFamily>(), kind_name<Formulation>(),
    kind_name<Integrator>(), kind_name<Load>(),  kind_name<Motion>(),     kind_name<StrainKinematics>(),
    kind_name<Sensor>()};

/// Whether a text can be a plugin's id: 1 to 64 of a-z, 0-9 and '-'.
bool is_plugin_id(std::string_view text);

/// A plugin library cannot be used: what() says which one and why, in a sentence. No fault of the scene's.
class PluginError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The plugins one library brings, before they are admitted.
class Enrollment {
 public:
  template <class Interface>
  void add(Plugin<Interface> plugin) {
    std::get<std::vector<Plugin<Interface>>>(plugins_).push_back(std::move(plugin));
  }
  template <class Interface>
  [[nodiscard]] std::vector<Plugin<Interface>>& all() {
    return std::get<std::vector<Plugin<Interface>>>(plugins_);
  }
  /// Summaries of all plugins by "kind/id", sorted; of two with one name the first.
  [[nodiscard]] std::map<std::string, std::string> summaries() const;

 private:
  friend class Registry;
  std::tuple<std::vector<Plugin<Body>>, std::vector<Plugin<Hinge>>, std::vector<Plugin<ModeFamily>>,
             std::vector<Plugin<Formulation>>, std::vector<Plugin<Integrator>>, std::vector<Plugin<Load>>,
             std::vector<Plugin<Motion>>, std::vector<Plugin<StrainKinematics>>, std::vector<Plugin<Sensor>>>
      plugins_;
};

/// Threads may share a registry: what it has found stays where it is, and libraries are loaded by one thread at a time.
class Registry {
 public:
  /// Admits all plugins of a library, or none.
  /// \throws std::invalid_argument where an id is malformed, taken (both origins are named), a factory is null or a
  /// parameter cannot be (parameter_faults.hpp).
  void admit(Enrollment enrollment, const std::string& origin);

  /// The plugin of a kind with this id; null where there is none. It may load a library: see set_loader.
  /// \throws PluginError where there is one whose library is refused.
  template <class Interface>
  [[nodiscard]] const Plugin<Interface>* find(std::string_view id) {
    const std::lock_guard lock(*mutex_);
    auto& plugins = std::get<Map<Interface>>(maps_);
    auto it = plugins.find(id);
    if (it == plugins.end() && loader_ && loader_(*this, kind_name<Interface>(), id)) it = plugins.find(id);
    return it == plugins.end() ? nullptr : &it->second;
  }
  /// Ids of a kind that are admitted or that the lister knows, sorted.
  template <class Interface>
  [[nodiscard]] std::vector<std::string> ids() const {
    const std::lock_guard lock(*mutex_);
    std::vector<std::string> names = lister_ ? lister_(kind_name<Interface>()) : std::vector<std::string>{};
    for (const auto& [id, plugin] : std::get<Map<Interface>>(maps_)) names.push_back(id);
    return sorted_unique(std::move(names));
  }

  /// `load` is asked for a plugin that is not yet admitted; it admits the library that has it and returns true, or
  /// returns false where it knows none, or throws PluginError. `list` gives the ids of a kind that could be loaded.
  void set_loader(std::function<bool(Registry& registry, std::string_view kind, std::string_view id)> load,
                  std::function<std::vector<std::string>(std::string_view kind)> list);

 private:
  template <class Interface>
  using Map = std::map<std::string, Plugin<Interface>, std::less<>>;
  static std::vector<std::string> sorted_unique(std::vector<std::string> names);

  std::tuple<Map<Body>, Map<Hinge>, Map<ModeFamily>, Map<Formulation>, Map<Integrator>, Map<Load>, Map<Motion>,
             Map<StrainKinematics>, Map<Sensor>>
      maps_;
  /// A loader admits what it loads: recursive. On the heap, so that a registry can be moved before it is shared.
  std::unique_ptr<std::recursive_mutex> mutex_ = std::make_unique<std::recursive_mutex>();
  std::function<bool(Registry&, std::string_view, std::string_view)> loader_;
  std::function<std::vector<std::string>(std::string_view)> lister_;
};

}  // namespace withy
