/// \file
/// Outputs that a scene does not define, asked for by what they are: `boom.tip.acceleration`, `shoulder.effort`.
/// Setting `outputs` of a scene to such a name, or a list of them, adds them to those that it defines.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "withy/core/plugin/value.hpp"

namespace withy {

class SceneValues;

/// An output by its name: `[OBJECT.]QUANTITY[@ARGUMENT]`.
struct AskedOutput {
  std::string name;  ///< without what stands behind it: a component, `.max`
  Value definition;  ///< as a scene has it under `outputs`
};

/// What a name says: its last word that is a quantity, of the object before it, a body, `body.frame`, hinge, constraint
/// or load of the scene. Nothing where it has no such word. An object that the scene does not have is reported where
/// the definition is checked.
/// \param scene its values as they were written; what it has under `outputs` does not matter
std::optional<AskedOutput> asked_output(const Value& scene, std::string_view name);

/// What is wrong with a name of a quantity of a beam's section, behind whose @ no number stands; empty where it is not
/// that.
std::string problem_of_place(const Value& scene, std::string_view name);

/// The names that a scene may be asked for, but those with an argument that may be left out; for messages.
std::vector<std::string> asked_names(const Value& scene);

/// Whether a definition is what its name says, and perhaps more.
bool says_its_name(const Value& scene, const std::string& name, const Value& definition);

/// Whether the scene defines an output of which this is the name, or the name of a number of it.
bool defines_output(const Value& scene, std::string_view name);

/// Adds the outputs among these names that say what they are, and leaves the others to whoever knows them. Stands for
/// "--output 'NAME'" in messages.
void ask_outputs(SceneValues& values, const std::vector<std::string>& names);

}  // namespace withy
