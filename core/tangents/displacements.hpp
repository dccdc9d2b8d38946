/// \file
/// Small displacements of a tree's state.
#pragma once

#include <span>

#include "withy/core/model/model.hpp"

namespace withy {

/// Moves y by δ, one number a speed: x changes as if the speeds were δ for a unit of time, to the first order; then
/// quaternions are scaled to unit length. \param delta displacements [rad, m, 1]
void displace(const Model& model, std::span<double> y, std::span<const double> delta);

}  // namespace withy
