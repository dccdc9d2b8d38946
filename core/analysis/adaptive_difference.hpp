/// \file
/// Numerical derivatives of what analyses do not know the scale of.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "withy/core/plugin/central_difference.hpp"

namespace withy {

/// Derivatives of several numbers, with what the last refinement changed in them.
struct Differenced {
  Eigen::VectorXd slope;
  Eigen::VectorXd change;
};

/// f′(0) by central differences of eighth order with steps h, h/8 … h/4096: for each number that of the two steps
/// which agree best. Friction that saturates within a thousandth of h is still seen.
template <class Function>
Differenced adaptive_difference(Function&& f, double h) {
  constexpr int steps = 5;
  std::array<Eigen::VectorXd, steps> slopes;
  for (std::size_t k = 0; k < steps; ++k)
    slopes[k] = central_difference(f, h * std::exp2(-3.0 * static_cast<double>(k)));
  Differenced best{slopes[0], (slopes[0] - slopes[1]).cwiseAbs()};
  for (std::size_t k = 1; k + 1 < steps; ++k) {
    const Eigen::VectorXd change = (slopes[k] - slopes[k + 1]).cwiseAbs();
    for (Eigen::Index i = 0; i < change.size(); ++i) {
      if (!(change[i] < best.change[i])) continue;
      best.change[i] = change[i];
      best.slope[i] = slopes[k][i];
    }
  }
  return best;
}

}  // namespace withy
