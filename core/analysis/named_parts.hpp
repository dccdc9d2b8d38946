/// \file
/// The derivatives of a tree's equations in parts that have names.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/state.hpp"
#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy {

/// A part of the derivatives that can be named.
struct NamedPart {
  std::string name;
  Eigen::MatrixXd by_position, by_speed;
  bool of_load = false;
};

/// Stiffness and damping of bodies, and what loads do on speeds; the rest last, "inertia and weight", which holds what
/// loads do at frames and says so. They add up to the tangents.
std::vector<NamedPart> named_parts(const TangentDynamics& dynamics, const State& state, const Tangents& tangents);

}  // namespace withy
