/// \file
/// Small displacements of a tree's state.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// Moves y by δ, one number a speed: x changes as if the speeds were δ for a unit of time, to the first order; then
/// quaternions are scaled to unit length. \param delta displacements [rad, m, 1]
void displace(const Model& model, std::span<double> y, std::span<const double> delta);

/// The greatest of the numbers of a state that `move(y, h)` changes, where h is added to: differences take no step that
/// it does not resolve (refined_difference.hpp).
template <class Move>
double greatest_moved(std::span<const double> y, Move&& move) {
  std::vector<double> moved(y.begin(), y.end());
  move(moved, 1.0);
  double greatest = 0;
  for (std::size_t i = 0; i < moved.size(); ++i)
    if (moved[i] != y[i]) greatest = std::max(greatest, std::abs(y[i]));
  return greatest;
}

}  // namespace withy
