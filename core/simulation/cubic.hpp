/// \file
/// The cubic through values and derivatives at the ends of a step.
#pragma once

namespace withy {

/// Its value at s = 0 … 1, from values and derivatives with respect to s at 0 and 1.
constexpr double cubic(double s, double x0, double v0, double x1, double v1) {
  const double r = 1 - s;
  return x0 * r * r * (1 + 2 * s) + x1 * s * s * (1 + 2 * r) + v0 * s * r * r - v1 * s * s * r;
}

}  // namespace withy
