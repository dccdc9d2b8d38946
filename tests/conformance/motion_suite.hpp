/// \file
/// What any prescribed motion must satisfy, built in or foreign.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {

/// Coordinate and rate do not jump between two times, also where accelerations do: in the half where they change most,
/// thirty times, they change by 1e-9 of what a bounded slope changes them by in the whole time.
inline void expect_no_jump(const Motion& motion, double from, double to) {
  for (double MotionPoint::*value : {&MotionPoint::position, &MotionPoint::rate}) {
    double a = from, b = to;
    double at_a = motion.at(a).*value, at_b = motion.at(b).*value;
    for (int i = 0; i < 30; ++i) {
      const double middle = (a + b) / 2, at = motion.at(middle).*value;
      const bool first = std::abs(at - at_a) > std::abs(at_b - at);
      (first ? b : a) = middle;
      (first ? at_b : at_a) = at;
    }
    EXPECT_LE(std::abs(at_b - at_a), 1e-6) << "a jump at t = " << a;
  }
}

/// Points are finite and cost no allocation; rate and acceleration are the derivatives of the position between the
/// discontinuities, and neither position nor rate jumps; these times are finite and increase, and none comes after the
/// end where there is one.
inline void expect_motion_conforms(const Motion& motion) {
  EXPECT_EQ(find_fault(motion), "");
  const std::vector<double> jumps = motion.discontinuities();
  EXPECT_TRUE(std::all_of(jumps.begin(), jumps.end(), [](double t) { return std::isfinite(t); }));
  EXPECT_TRUE(std::is_sorted(jumps.begin(), jumps.end()));
  EXPECT_TRUE(std::isfinite(motion.end()) && motion.end() >= 0);
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
    expect_no_jump(motion, t, t + 0.05 * span);
    const bool near_jump = std::any_of(jumps.begin(), jumps.end(), [&](double at) { return std::abs(at - t) < 2 * h; });
    if (near_jump) continue;
    // Differences over 2e-4 s leave 2e-9 of the third derivative, here below 1e3.
    EXPECT_NEAR((later.position - earlier.position) / (2 * h), p.rate, 1e-5);
    EXPECT_NEAR((later.rate - earlier.rate) / (2 * h), p.acceleration, 1e-3);
  }
}

}  // namespace withy::test
