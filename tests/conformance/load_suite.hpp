/// \file
/// What any load must satisfy, built in or foreign.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/central_difference.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {

/// Where a load differentiates itself, against central differences of eighth order at random states about its
/// beginning: the step 1e-3 leaves 2e-13 of rounding, and of truncation less than 1e-8 where efforts vary over a
/// hundredth.
inline void expect_load_derivatives(const Load& load, const Model& model) {
  const auto bound = load.bind(model);
  const Layout& layout = model.layout();
  State state = model.reference_state();
  bound->begin(state);
  std::vector<double> y(state.y.begin(), state.y.end() - 1);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += 0.3 * std::sin(1.0 + 2.7 * static_cast<double>(i));
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    model.hinges()[h].hinge->normalize(std::span(y).subspan(slot.position, slot.positions));
  }
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  const double t = 0.37 * (bound->end() > 0 ? bound->end() : 1.0);
  const auto efforts = [&](const std::vector<double>& at) {
    Eigen::VectorXd e = Eigen::VectorXd::Zero(n);
    std::vector<double> scratch(bound->scratch());
    bound->add(t, std::span(at).first(layout.positions), std::span(at).subspan(layout.positions),
               {e.data(), layout.speeds}, scratch);
    return e;
  };
  Eigen::MatrixXd by_position = Eigen::MatrixXd::Zero(n, n), by_speed = by_position;
  if (!bound->add_derivatives(t, std::span(y).first(layout.positions), std::span(y).subspan(layout.positions),
                              by_position, by_speed)) {
    EXPECT_TRUE(by_position.isZero(0) && by_speed.isZero(0));
    return;
  }
  const double size = 1 + by_position.cwiseAbs().maxCoeff() + by_speed.cwiseAbs().maxCoeff();
  const auto compare = [&](std::size_t element, const Eigen::VectorXd& derivative) {
    const Eigen::VectorXd numeric = central_difference(
        [&](double h) {
          std::vector<double> moved = y;
          moved[element] += h;
          return efforts(moved);
        },
        1e-3);
    EXPECT_LT((numeric - derivative).cwiseAbs().maxCoeff(), 1e-8 * size) << "element " << element << " of y";
  };
  for (const Slot& slot : layout.hinges) {
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      compare(layout.positions + slot.speed + i, by_speed.col(static_cast<Eigen::Index>(slot.speed + i)));
      // Quaternions are moved by no single coordinate.
      if (slot.positions == slot.speeds)
        compare(slot.position + i, by_position.col(static_cast<Eigen::Index>(slot.speed + i)));
    }
  }
}

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
  expect_load_derivatives(load, model);
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
