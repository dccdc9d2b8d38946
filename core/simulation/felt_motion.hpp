/// \file
/// What bodies feel of the motion of a tree under loads on distributed mass.
#pragma once

#include <span>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/tree_motion.hpp"

namespace withy {

/// The motions without what fields give: a satellite in free fall carries no load from its orbit. Forces are those on
/// all mass points, where the bodies' first order has them; over a body a field counts as linear, by its value and its
/// gradient at the body's frame, which is exact but for point-gravity: there the rest is of the order (l/d)² of the
/// gradient's part, with l the length of the body and d the distance. Allocates.
std::vector<BodyMotion> felt_motions(const Model& model, const EquationsOfMotion& equations, const State& state,
                                     const std::vector<BodyMotion>& motions);

}  // namespace withy
