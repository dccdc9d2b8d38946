/// \file
/// Checks values against the specifications of parameters: the one place where a scene's numbers get their units,
/// ranges and defaults.
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "withy/core/plugin/registry.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/sources.hpp"

namespace withy {

class SceneParts;

/// Names, in the order they came and quick to find.
class NameList {
 public:
  void add(std::string name) {
    if (known_.insert(name).second) names_.push_back(std::move(name));
  }
  [[nodiscard]] bool has(const std::string& name) const { return known_.contains(name); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::unordered_set<std::string> known_;
};

/// The names of a scene that other values may refer to.
struct SceneNames {
  NameList bodies;
  NameList hinges;
  NameList frames;  ///< "body" and "body.frame", with the stations that the scene names
  /// Where the scene names places that bodies have not: all frames and the stations of these bodies, for messages.
  NameList places;
  NameList loads;
  NameList sliding;  ///< rates of hinges that are velocities, as "slide.0"; the others turn
  /// SI units of hinges' columns, of outputs that loads may measure and of what inputs act with, by their names.
  std::map<std::string, std::string> units;
  NameList signals;  ///< columns of hinges, outputs and loads, without what stands behind a dot of the latter two
  bool frames_complete = true;  ///< false where a body could not be made: any frame name is taken then
};

/// Checks values of one document; every problem goes to the diagnostics.
class Checker {
 public:
  Checker(const Document& document, Registry& registry, Diagnostics& diagnostics)
      : document_(document), registry_(registry), diagnostics_(diagnostics), directory_(document.directory_now()) {}

  /// The same checks with another place to report to, of what is not remembered.
  Checker(const Checker& like, Diagnostics& diagnostics)
      : document_(like.document_),
        registry_(like.registry_),
        diagnostics_(diagnostics),
        directory_(like.directory_),
        names_(like.names_),
        sources_(like.sources_) {}

  /// From now on references are compared with these names; before, any name is taken.
  void know(const SceneNames* names) { names_ = names; }
  /// From now on plugins that are found are noted there.
  /// \returns where they were noted before
  SceneSources* note(SceneSources* sources) const { return std::exchange(sources_, sources); }
  [[nodiscard]] SceneSources* noted() const { return sources_; }
  /// From now on what `parts` remembers is not checked and made again; null: nothing is remembered.
  void remember(SceneParts* parts) { parts_ = parts; }
  [[nodiscard]] SceneParts* parts() const { return parts_; }

  /// The value in SI units with defaults filled in; nothing where it, or anything in it, is wrong.
  /// A text specification that has a unit takes a name or a number in that unit; one that refers to a mode family takes
  /// its name or a map of its `name` and options, one that refers to a motion the same with `type`, which becomes a
  /// map. A unit as "rad|m" is that of what the map's hinge does: the first where it turns, the second where it slides.
  /// Of a map about a signal, its `of`, it is the signal's, and an effort as "N m|N" that of its `hinge` or of the
  /// input that it goes `to`; both are taken where that is not known.
  std::optional<Value> check(const Value& value, const ParameterSpec& spec) const;
  /// The same for a map with these members.
  std::optional<Value> check_members(const Value& value, const std::vector<ParameterSpec>& members) const;
  /// The same for members of several lists: those that are right are in `result`, whatever the others are.
  /// \returns whether all are right.
  bool read_members(const Value& value, std::initializer_list<const std::vector<ParameterSpec>*> lists,
                    Value& result) const;
  /// True for a map or, as an empty map, null; otherwise reports what was expected: a text, or what makes one.
  template <class Expected>
  bool is_map(const Value& value, const Expected& expected) const {
    if (value.kind() == Value::Kind::map || value.kind() == Value::Kind::null) return true;
    if constexpr (std::is_invocable_v<Expected>) {
      no_map(value, expected());
    } else {
      no_map(value, expected);
    }
    return false;
  }

  /// What `checked` returns, which checks maps of what may turn or slide: both units are taken.
  template <class Checked>
  auto of_either(const Checked& checked) const {
    const Subject outside = std::exchange(subject_, {Moves::either, Moves::either, {}});
    auto result = checked();
    subject_ = outside;
    return result;
  }
  /// Whether a value that was taken so has the unit of what turns or slides; reports where it has not.
  bool has_unit(const Value& value, const ParameterSpec& spec, bool slides) const;

  Registry& registry() const { return registry_; }
  Diagnostics& diagnostics() const { return diagnostics_; }
  /// For what the document's values are made into.
  MakeContext make_context() const { return {registry_, diagnostics_, directory_}; }
  /// suggestion() where it is cheap or among the first: of a thousand wrong names nobody reads what each may have
  /// meant, and among thousands of candidates it takes long to say.
  std::string suggest(std::string_view name, const std::vector<std::string>& candidates) const;
  /// Reports that there is no such frame, with the nearest one.
  void no_frame(const Place& place, const std::string& name, const SceneNames& names) const;
  /// Reports a problem with a key rather than with its value.
  void key_error(const std::string& path, std::string message) const;

  /// The plugin of this id; null after reporting the nearest id and all ids there are.
  template <class Interface>
  const Plugin<Interface>* plugin(const Value& id) const {
    if (id.kind() == Value::Kind::text && is_plugin_id(id.text())) {
      if (const Plugin<Interface>* found = registry_.find<Interface>(id.text())) {
        if (sources_ != nullptr)
          sources_->add(PluginUsed{std::string(kind_name<Interface>()), found->id, found->origin});
        return found;
      }
    }
    unknown_plugin(id, std::string(kind_name<Interface>()), registry_.ids<Interface>());
    return nullptr;
  }

 private:
  Value default_with(const Value& elements, const Value& fallback) const;
  bool read_member(const Value& value, const ParameterSpec& spec, Value& result) const;
  std::optional<Value> number(const Value& value, const ParameterSpec& spec, const std::string& unit) const;
  enum class Moves { turning, sliding, either };
  /// What a map is about: what is measured and what is driven, of most the rate of one hinge.
  struct Subject {
    Moves measured = Moves::turning, driven = Moves::turning;
    std::string unit;  ///< of a signal that is neither an angle nor a length; else empty
  };
  [[nodiscard]] Moves moves(const std::string& hinge, const Value& map) const;
  [[nodiscard]] std::string unit_of_signal(const Value& names) const;
  [[nodiscard]] std::optional<Subject> subject(const Value& map) const;
  [[nodiscard]] std::string unit_here(const std::string& unit) const;
  [[nodiscard]] static std::string gain_of_signal(const std::string& per, const std::string& signal, Moves driven);
  std::optional<Value> text(const Value& value, const ParameterSpec& spec) const;
  std::optional<Value> mode_family(const Value& value) const;
  std::optional<Value> formulation(const Value& value) const;
  std::optional<Value> motion(const Value& value) const;
  std::optional<Value> row(const Value& value, const ParameterSpec& spec) const;
  std::optional<Value> table(const Value& value, const ParameterSpec& spec) const;
  std::optional<Value> named(const Value& value, const ParameterSpec& spec) const;
  std::optional<Value> matrix(const Value& value, const ParameterSpec& spec) const;
  std::optional<Value> texts(const Value& value, const ParameterSpec& spec) const;
  static bool in_range(double x, const ParameterSpec& spec);
  bool refers(const Place& place, const std::string& name, ParameterSpec::Refers what) const;
  void unknown_plugin(const Value& id, const std::string& kind, const std::vector<std::string>& ids) const;
  void got(const Value& value, const ParameterSpec& spec, const std::string& why = {}) const;
  void no_map(const Value& value, const std::string& expected) const;

  const Document& document_;
  Registry& registry_;
  Diagnostics& diagnostics_;
  std::string directory_;  ///< where relative names of files begin
  const SceneNames* names_ = nullptr;
  mutable SceneSources* sources_ = nullptr;
  SceneParts* parts_ = nullptr;
  mutable int suggested_ = 0;  ///< among many candidates
  mutable Subject subject_;    ///< of the map at hand
};

}  // namespace withy
