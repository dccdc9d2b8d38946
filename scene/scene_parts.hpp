/// \file
/// What scenes made one after the other have in common, checked and made once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include "withy/scene/scene.hpp"

namespace withy {

struct SceneNames;

/// Remembers the checked maps of a scene (a body, a load, the integrator) and the objects that plugins made of them,
/// each under its path. A scene made with it takes what it has said before, in the same words at the same place: cases
/// of a sweep that differ in a few numbers check and make only what has these. Everything is as without it: the values,
/// objects, sources, and what is reported of the rest. What reads files, or was reported, is not remembered; what says
/// something else in every scene, as a body whose mass a sweep draws, only now and then. Of one thread and one
/// registry, which must outlive it.
class SceneParts {
 public:
  SceneParts();
  ~SceneParts();
  SceneParts(const SceneParts&) = delete;
  SceneParts& operator=(const SceneParts&) = delete;

  /// A map that was right.
  struct Checked {
    const void* plugin = nullptr;  ///< the Plugin<Interface> it names
    Value value;                   ///< in SI units, with defaults
    SceneSources sources;          ///< plugins that were found on the way
  };

  /// For those who check and make scenes. A new scene begins; until names are known, references are not compared.
  void begin() { names_now_ = 0; }
  /// From now on references are compared with these names: what was checked against others does not count.
  /// \param stage of making a scene, each with names of its own: 0, 1 or 2
  void know(std::size_t stage, const SceneNames& names);
  /// What was remembered of this map; null: nothing, or not of this one. \param kind of plugin
  [[nodiscard]] const Checked* checked(std::string_view kind, const Value& given);
  /// As Checked has them.
  void remember(std::string_view kind, const Value& given, const void* plugin, const Value& value,
                SceneSources sources);
  /// What a plugin made of a map that says the same; null: nothing.
  [[nodiscard]] std::shared_ptr<const void> made(std::string_view kind, const void* plugin, const Value& value);
  void remember(std::string_view kind, const void* plugin, const Value& value, std::shared_ptr<const void> object);

 private:
  /// Whether remembering pays.
  struct Steadiness {
    unsigned changes = 0;  ///< how often in a row it was asked for something else
    /// Asked for something else: whether to remember that. Copies that nobody takes cost a part of making a scene.
    bool worth_another() {
      constexpr unsigned few = 4, rarely = 32;
      return ++changes <= few || changes % rarely == 0;
    }
  };
  struct Map : Steadiness {
    Value given;
    std::uint64_t names = 0;  ///< that its references were compared with
    Checked checked;
  };
  struct Object : Steadiness {
    const void* plugin = nullptr;
    Value value;
    std::shared_ptr<const void> object;
  };
  template <class Part>
  static void put(std::unordered_map<std::string, Part>& parts, std::string key, const auto& fill);

  static constexpr std::size_t stages = 3;
  std::unordered_map<std::string, Map> maps_;        ///< by kind and path
  std::unordered_map<std::string, Object> objects_;  ///< likewise
  std::unique_ptr<SceneNames> names_[stages];
  std::uint64_t names_of_[stages] = {};  ///< a number for each set of names there has been
  std::uint64_t names_now_ = 0, last_names_ = 0;
};

/// As make_scene(values, registry), with what `parts` remembers.
Scene make_scene(const SceneValues& values, Registry& registry, SceneParts& parts);

}  // namespace withy
