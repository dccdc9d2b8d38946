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

/// Wrenches, for motions as at rest and in motion, are finite, overwrite what is there, and cost no allocation.
inline void expect_wrenches_conform(const BoundLoad& load, double t) {
  const std::size_t count = load.frames().size();
  FrameMotion moving;
  moving.position = {0.3, -0.2, 0.5};
  moving.velocity = {-1, 2, 0.4};
  moving.angular_velocity = {0.1, 0.2, -0.3};
  for (const FrameMotion& motion : {FrameMotion{}, moving}) {
    std::vector<FrameMotion> motions(count, motion);
    std::vector<Wrench> first(count), second(count, {Vector3::Constant(7), Vector3::Constant(8)});
    const std::size_t before = allocations();
    load.wrenches(t, motions, first);
    load.wrenches(t, motions, second);
    EXPECT_EQ(allocations(), before);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_TRUE(first[i].force.allFinite() && first[i].moment.allFinite());
      EXPECT_EQ(first[i].force, second[i].force);
      EXPECT_EQ(first[i].moment, second[i].moment);
    }
  }
}

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
    expect_wrenches_conform(*bound, t);
    const auto alone = efforts(t, 0.0, 0.0);
    const auto added = efforts(t, 1.0, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_TRUE(std::isfinite(alone[i]));
      EXPECT_NEAR(added[i], 1.0 + alone[i], 4 * std::numeric_limits<double>::epsilon() * (1 + std::abs(alone[i])));
    }
  }
  for (const FrameIndex& at : bound->frames()) {
    ASSERT_GE(at.body, 0);
    ASSERT_LT(static_cast<std::size_t>(at.body), model.bodies().size());
    ASSERT_LT(static_cast<std::size_t>(at.frame), model.bodies()[static_cast<std::size_t>(at.body)].frames.size());
  }
  const std::vector<double> jumps = bound->discontinuities();
  EXPECT_TRUE(std::is_sorted(jumps.begin(), jumps.end()));
  if (bound->end() > 0 && !jumps.empty()) {
    EXPECT_LE(jumps.back(), bound->end());
  }
}

}  // namespace withy::test
