/// \file
/// The numbers of a scene that a user would vary.
#pragma once

#include <map>
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

/// The units of what scenes name: columns of results and inputs.
using SignalUnits = std::map<std::string, std::string>;

/// Gravity, and the numbers and vectors of bodies, hinges, loads, motions and of the integrator, in the order of the
/// file; not counts, which change the number of coordinates, and not tables. Those of what acts along a hinge that
/// slides have units of a force and a length, where they would have those of a moment and an angle.
std::vector<SceneNumber> scene_numbers(const Scene& scene, Registry& registry, const SignalUnits& units);

}  // namespace withy::fmi
