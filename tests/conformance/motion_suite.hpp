/// \file
/// What any prescribed motion must satisfy, built in or foreign.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "withy/core/plugin/motion.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {

/// Points are finite and cost no allocation; rate and acceleration are the derivatives of the position between the
/// discontinuities; these increase, and none comes after the end where there is one.
inline void expect_motion_conforms(const Motion& motion) {
  const std::vector<double> jumps = motion.discontinuities();
  EXPECT_TRUE(std::is_sorted(jumps.begin(), jumps.end()));
  if (motion.end() > 0 && !jumps.empty()) {
    EXPECT_LE(jumps.back(), motion.end());
  }
  if (motion.locks()) return;
  const double span = motion.end() > 0 ? motion.end() : 1.0;
  constexpr double h = 1e-4;
  for (int i = -3; i <= 33; ++i) {
    const double t = span * (0.013 + 0.05 * i);
    const std::size_t before = allocations();
    const MotionPoint p = motion.at(t), earlier = motion.at(t - h), later = motion.at(t + h);
    EXPECT_EQ(allocations(), before);
    EXPECT_TRUE(std::isfinite(p.position) && std::isfinite(p.rate) && std::isfinite(p.acceleration));
    const bool near_jump = std::any_of(jumps.begin(), jumps.end(), [&](double at) { return std::abs(at - t) < 2 * h; });
    if (near_jump) continue;
    // Differences over 2e-4 s leave 2e-9 of the third derivative, here below 1e3.
    EXPECT_NEAR((later.position - earlier.position) / (2 * h), p.rate, 1e-5);
    EXPECT_NEAR((later.rate - earlier.rate) / (2 * h), p.acceleration, 1e-3);
  }
}

}  // namespace withy::test
