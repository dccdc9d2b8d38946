/// \file
/// Numerical derivatives of what says nothing of its scale.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "withy/core/plugin/central_difference.hpp"

namespace withy {

/// Derivatives with what is left between the two steps that told them.
template <class Matrix>
struct RefinedDifference {
  Matrix slope, change;
};

/// f′(0) of a function that returns an Eigen matrix which owns its elements, by the central difference of eighth order
/// with the step h where a step of h/8 gives the same, element by element; else by shorter ones until two agree, or
/// until rounding is more than what two have left. Truncation falls by 8⁸ from one to the next: a spring of a
/// millimetre is as exact as one of a metre, whose numbers are those of h, and a controller is seen within its limit.
/// What no two of `levels` pairs agree on is told as the two do that are nearest: a jump as h has it.
template <class Function>
auto refine_difference(Function&& f, double h, int levels) {
  constexpr double agreed = 1e-12, rounding = 64 * std::numeric_limits<double>::epsilon();
  Eigen::ArrayXXd sizes;  // greatest |f| of a step, for the rounding of its difference
  const auto with_step = [&] {
    sizes.resize(0, 0);
    return central_difference(
        [&](double at) {
          auto values = f(at);
          if (sizes.size() == 0) sizes.setZero(values.rows(), values.cols());
          sizes = sizes.max(values.array().abs());
          return values;
        },
        h);
  };
  auto before = with_step();
  RefinedDifference<decltype(before)> best{before, before};
  best.change.setConstant(std::numeric_limits<double>::infinity());
  Eigen::ArrayXX<bool> settled = Eigen::ArrayXX<bool>::Constant(before.rows(), before.cols(), false);
  for (int level = 0; level < levels && !settled.all(); ++level) {
    const Eigen::ArrayXXd left_before = rounding * sizes / h;
    h /= 8;
    auto finer = with_step();
    for (Eigen::Index i = 0; i < before.size(); ++i) {
      if (settled(i)) continue;
      const double left = std::abs(before(i) - finer(i)), least = left_before(i) + rounding * sizes(i) / h;
      // Steps of which rounding is most may agree by chance, the shortest on nothing at all.
      settled(i) = least > best.change(i);
      if (settled(i)) continue;
      settled(i) = left <= agreed * std::abs(finer(i)) + least;
      if (!settled(i) && !(left < best.change(i))) continue;
      best.change(i) = left;
      best.slope(i) = before(i);
    }
    before = std::move(finer);
  }
  return best;
}

/// The derivatives alone, with steps down to h/8⁸.
template <class Function>
auto refined_difference(Function&& f, double h) {
  return refine_difference(f, h, 8).slope;
}

}  // namespace withy
