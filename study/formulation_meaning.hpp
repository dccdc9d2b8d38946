/// \file
/// What a formulation means, in words. One that is chosen by its two choices has no name that says it.
#pragma once

#include <string>

#include "withy/core/plugin/registry.hpp"
#include "withy/scene/scene.hpp"

namespace withy::study {

/// What a scene says of a formulation: its id, or a map with `name` and options.
struct FormulationWords {
  std::string name;   ///< its id
  std::string title;  ///< for heads of tables: the id, of `general` with its choices, "general: linear, strict"
  std::string
      meaning;  ///< in a sentence; of `general` with the formulation of one name that it equals, if there is one
};
FormulationWords formulation_words_of(const Value& choice, Registry& registry);
/// Of a whole scene.
FormulationWords formulation_words_of(const Scene& scene, Registry& registry);
/// For heads of tables.
std::string formulation_title(const Scene& scene);
std::string formulation_title(const Value& choice);

}  // namespace withy::study
