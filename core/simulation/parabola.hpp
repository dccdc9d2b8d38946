/// \file
/// The parabola through three points.
#pragma once

#include <algorithm>
#include <array>

namespace withy {

/// Where it has its extreme, clamped to the span of the points; t increases.
inline double vertex(const std::array<double, 3>& t, const std::array<double, 3>& x) {
  const double a = (x[1] - x[0]) / (t[1] - t[0]), b = (x[2] - x[1]) / (t[2] - t[1]);
  const double bend = (b - a) / (t[2] - t[0]);
  if (bend == 0) return t[1];
  return std::clamp((t[0] + t[1]) / 2 - a / (2 * bend), t[0], t[2]);
}

/// Its value.
inline double along(const std::array<double, 3>& t, const std::array<double, 3>& x, double at) {
  const double a = (x[1] - x[0]) / (t[1] - t[0]), b = (x[2] - x[1]) / (t[2] - t[1]);
  return x[0] + a * (at - t[0]) + (b - a) / (t[2] - t[0]) * (at - t[0]) * (at - t[1]);
}

}  // namespace withy
