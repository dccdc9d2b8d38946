/// \file
/// Directions given by vectors of any length.
#pragma once

#include <cmath>
#include <optional>

#include "withy/core/spatial/pose.hpp"

namespace withy {

/// The unit vector along a vector, however long or short it is; nothing where it is zero or not finite. Scaling a
/// vector by a power of two changes no bit of it.
template <int n>
std::optional<Eigen::Matrix<double, n, 1>> unit_along(const Eigen::Matrix<double, n, 1>& v) {
  const double greatest = v.cwiseAbs().maxCoeff();
  if (!v.allFinite() || greatest == 0) return {};
  // Squares of what is great or small leave the range of numbers.
  const int power = -std::ilogb(greatest);
  const Eigen::Matrix<double, n, 1> scaled = v.unaryExpr([power](double x) { return std::scalbn(x, power); });
  return scaled.normalized();
}

}  // namespace withy
