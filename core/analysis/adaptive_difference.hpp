/// \file
/// Numerical derivatives of what analyses do not know the scale of.
#pragma once

#include <Eigen/Core>

#include "withy/core/plugin/refined_difference.hpp"

namespace withy {

/// Derivatives of several numbers, with what the last refinement changed in them.
using Differenced = RefinedDifference<Eigen::VectorXd>;

/// f′(0) by central differences of eighth order with steps h, h/8 … h/8¹⁶, 4e-15 h: friction that saturates, and what
/// a controller gives within its limit, are seen wherever they are wider than that.
/// \param place the number that steps are added to, where it is known: none is shorter than it resolves
template <class Function>
Differenced adaptive_difference(Function&& f, double h, double place = 0) {
  return refine_difference([&](double at) -> Eigen::VectorXd { return f(at); }, h, most_refinements, place);
}

}  // namespace withy
