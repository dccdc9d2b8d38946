/// \file
/// What the rates of a hinge measure, as it says or found from its motion: for units and for loads on single
/// coordinates.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "withy/core/plugin/hinge.hpp"

namespace withy {

class Model;

struct HingeRate {
  bool angular = false;                   ///< that of an angle [rad/s]; else of a length [m/s] (Hinge::angular)
  std::optional<std::size_t> coordinate;  ///< the coordinate whose derivative it is; none where x holds a quaternion
};

/// One for each rate of the hinge, in its order.
std::vector<HingeRate> hinge_rates(const Hinge& hinge);

/// A rate of one of a model's hinges, and where it stands.
struct ModelRate {
  std::size_t speed = 0;                ///< of the generalized speeds
  std::optional<std::size_t> position;  ///< of the positions the one whose derivative it is, as HingeRate::coordinate
  bool angular = false;                 ///< as HingeRate::angular
  std::size_t hinge = 0;                ///< index in Model::hinges()
};

/// One for each rate of the model's hinges, in the order of these.
std::vector<ModelRate> hinge_rates(const Model& model);

}  // namespace withy
