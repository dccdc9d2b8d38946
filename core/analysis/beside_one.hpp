/// \file
/// What rounding leaves of numbers in a matrix.
#pragma once

#include <Eigen/Core>

namespace withy {

/// What a number beside one is rounded to, in a matrix of so many rows.
inline double beside_one(Eigen::Index rows) { return 2e-16 * static_cast<double>(rows); }

}  // namespace withy
