/// \file
/// What any load must satisfy, built in or foreign.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/model/model.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {

/// Efforts are finite, added to what is there, the same whatever is in the scratch memory, and cost no allocation;
/// discontinuities increase and none comes after the end where there is one.
inline void expect_load_conforms(const Load& load, const Model& model) {
  const auto bound = load.bind(model);
  ASSERT_NE(bound, nullptr);
  State state = model.reference_state();
  bound->begin(state);
  for (const double y : state.y) EXPECT_TRUE(std::isfinite(y));
  const Layout& layout = model.layout();
  const std::span<const double> positions(state.y.data(), layout.positions);
  const std::span<const double> speeds(state.y.data() + layout.positions, layout.speeds);
  const auto efforts = [&](double t, double start, double memory) {
    std::vector<double> e(layout.speeds, start), scratch(bound->scratch(), memory);
    const std::size_t before = allocations();
    bound->add(t, positions, speeds, e, scratch);
    EXPECT_EQ(allocations(), before);
    return e;
  };
  const double end = bound->end() > 0 ? bound->end() : 1.0;
  for (const double t : {0.0, 0.3 * end, end, 2 * end}) {
    const auto alone = efforts(t, 0.0, 0.0);
    const auto added = efforts(t, 1.0, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_TRUE(std::isfinite(alone[i]));
      EXPECT_NEAR(added[i], 1.0 + alone[i], 4 * std::numeric_limits<double>::epsilon() * (1 + std::abs(alone[i])));
    }
  }
  const std::vector<double> jumps = bound->discontinuities();
  EXPECT_TRUE(std::is_sorted(jumps.begin(), jumps.end()));
  if (bound->end() > 0 && !jumps.empty()) {
    EXPECT_LE(jumps.back(), bound->end());
  }
}

}  // namespace withy::test
