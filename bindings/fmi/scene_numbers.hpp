/// \file
/// The numbers of a scene that a user would vary.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/scene/scene.hpp"

namespace withy::fmi {

struct SceneNumber {
  std::string path;  ///< as SceneValues::set takes it
  std::string unit;  ///< SI; "1": none
  std::string meaning;
  double value = 0;
  std::optional<double> least, most;  ///< of what is allowed
};

/// Gravity, and the numbers and vectors of bodies, hinges, loads, motions and of the integrator, in the order of the
/// file; not counts, which change the number of coordinates, and not tables.
std::vector<SceneNumber> scene_numbers(const Scene& scene, Registry& registry);

}  // namespace withy::fmi
