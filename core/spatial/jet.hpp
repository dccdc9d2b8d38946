/// \file
/// Numbers that carry their derivatives along several directions at once.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/AutoDiff>

namespace withy {

/// A value and its derivatives along eight directions: one or two vector registers of them.
using Jet = Eigen::AutoDiffScalar<Eigen::Matrix<double, 8, 1>>;

inline double value_of(double x) { return x; }
inline double value_of(const Jet& x) { return x.value(); }

/// The greatest of |x| and its derivatives, for stopping criteria.
inline double magnitude(double x) { return std::abs(x); }
inline double magnitude(const Jet& x) { return std::max(std::abs(x.value()), x.derivatives().cwiseAbs().maxCoeff()); }

}  // namespace withy
