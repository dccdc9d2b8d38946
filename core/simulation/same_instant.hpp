/// \file
/// Times that mean the same although they were computed in different ways.
#pragma once

#include <cmath>
#include <limits>

namespace withy {

/// Whether two times [s] are apart by no more than the rounding of a product or sum: 0.3 and the third multiple of 0.1.
inline bool same_instant(double a, double b) {
  return a == b || std::abs(a - b) < 4 * std::numeric_limits<double>::epsilon() * std::abs(b);
}

}  // namespace withy
