/// \file
/// What bodies feel of the motion of a tree under loads on distributed mass.
#pragma once

#include <span>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/tree_motion.hpp"

namespace withy {

/// The motions without what fields give: a satellite in free fall carries no load from its orbit. A field counts as
/// uniform over each body. Allocates.
std::vector<BodyMotion> felt_motions(const Model& model, const EquationsOfMotion& equations, const State& state,
                                     const std::vector<BodyMotion>& motions);

}  // namespace withy
