/// \file
/// Times just before others.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace withy {

/// The last time before `time` and not before `from` [s] that is one in a run's arithmetic, where denormal numbers
/// count as zero: what jumps at `time` has not yet jumped there.
inline double just_before(double time, double from) {
  constexpr double least = std::numeric_limits<double>::min();
  const double before = std::nextafter(time, from);
  if (before == 0 || std::abs(before) >= least) return before;
  return std::max(before > 0 ? 0.0 : -least, from);
}

}  // namespace withy
