/// \file
/// What any load must satisfy, built in or foreign.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "withy/core/model/addition_fault.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/tangents/load_derivatives.hpp"
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

/// The model with the load, and its state as a run begins: the load's own states as they begin.
struct BegunLoad {
  BegunLoad(const Load& load, const Model& bare) : model(bare) {
    model.add_load("the load", load);
    node = &model.loads().back();
    state = model.reference_state();
    node->load->begin(state);
    model.begin_continuous(state);
  }
  BegunLoad(const BegunLoad&) = delete;
  BegunLoad& operator=(const BegunLoad&) = delete;
  [[nodiscard]] std::span<const double> positions() const { return std::span(state.y).first(model.layout().positions); }
  [[nodiscard]] std::span<const double> speeds() const {
    return std::span(state.y).subspan(model.layout().positions, model.layout().speeds);
  }

  Model model;
  const LoadNode* node = nullptr;
  State state;
};

/// A discrete part has a clock that can be kept or none, and numbers: once it is renewed its states, its switching
/// functions and what it adds to the efforts there are. None of that allocates.
inline void expect_discrete_part_conforms(const Load& load, const Model& bare) {
  BegunLoad begun(load, bare);
  const DiscretePart* part = begun.node->load->discrete();
  if (part == nullptr) return;
  EXPECT_TRUE(std::isfinite(part->period()));
  EXPECT_GE(part->period(), 0);
  std::vector<double> scratch(begun.node->load->scratch()), values(part->switches(), std::nan(""));
  std::vector<double> alone(begun.model.layout().speeds, 0.0), added(alone.size(), 1.0);
  const std::span<double> held = std::span(begun.state.y).subspan(begun.node->slot.first, begun.node->slot.count);
  const double t = begun.state.time;
  const std::size_t before = allocations();
  part->renew(t, begun.positions(), begun.speeds(), {.begins = true}, held, scratch);
  part->switching(t, begun.positions(), begun.speeds(), held, values);
  part->add(t, held, alone);
  part->add(t, held, added);
  EXPECT_EQ(allocations(), before);
  for (const double d : held) EXPECT_FALSE(std::isnan(d)) << "a discrete state";
  for (const double v : values) EXPECT_FALSE(std::isnan(v)) << "a switching function";
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_TRUE(std::isfinite(alone[i]));
    EXPECT_NEAR(added[i], 1 + alone[i], 4 * std::numeric_limits<double>::epsilon() * (1 + std::abs(alone[i])));
  }
}

/// A continuous part has states of different names that begin with numbers, rates and efforts that are numbers there,
/// the same whatever stood in their place, and allocates nothing for them.
inline void expect_continuous_part_conforms(const Load& load, const Model& bare) {
  const BegunLoad begun(load, bare);
  const ContinuousPart* part = begun.node->continuous;
  if (part == nullptr) return;
  std::set<std::string> names;
  for (std::size_t i = 0; i < part->states(); ++i) names.insert(part->name(i));
  EXPECT_EQ(names.size(), part->states()) << "two have one name";
  EXPECT_FALSE(names.contains(""));
  const Layout& layout = begun.model.layout();
  const std::vector<double> still(layout.speeds, 0.0);
  const auto told = [&](double memory) {
    std::vector<double> scratch(begun.model.load_scratch(), memory), rates(part->states(), memory);
    std::vector<double> efforts(layout.speeds, 0.0);
    LoadView view = begun.node->view(begun.state.time, begun.state.y, layout, scratch);
    const std::size_t before = allocations();
    part->add(view, efforts);
    view.accelerations = still;
    part->rates(view, rates);
    EXPECT_EQ(allocations(), before);
    rates.insert(rates.end(), efforts.begin(), efforts.end());
    return rates;
  };
  const std::vector<double> first = told(0);
  EXPECT_EQ(told(7), first);
  for (const double number : first) EXPECT_TRUE(std::isfinite(number));
  for (std::size_t i = 0; i < begun.node->continuous_slot.count; ++i)
    EXPECT_TRUE(std::isfinite(begun.state.y[begun.node->continuous_slot.first + i]));
}

/// Efforts are added to those of other loads, those of its parts with states too.
inline void expect_efforts_are_added(const Load& load, const Model& bare) {
  const BegunLoad begun(load, bare);
  EXPECT_EQ(addition_fault(begun.model, begun.model.loads().size() - 1, begun.state), "");
}

/// What a load says of its derivatives and of those of its continuous part is what differences of it give.
inline void expect_no_false_derivative(const Load& load, const Model& bare) {
  const BegunLoad begun(load, bare);
  State state = begun.state;
  state.time = 0.37 * (begun.node->load->end() > 0 ? begun.node->load->end() : 1.0);
  const auto wrong = false_derivative(begun.model, state);
  EXPECT_FALSE(wrong) << wrong->what;
}

/// Efforts are finite, added to what is there, the same whatever is in the scratch memory, and cost no allocation;
/// discontinuities are finite, increase, and none comes after the end where there is one. So are the parts of the load
/// with states of their own, as far as their own suites ask.
inline void expect_load_conforms(const Load& load, const Model& model) {
  expect_load_derivatives(load, model);
  expect_no_false_derivative(load, model);
  expect_efforts_are_added(load, model);
  expect_discrete_part_conforms(load, model);
  expect_continuous_part_conforms(load, model);
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
  for (const double t : jumps) EXPECT_TRUE(std::isfinite(t));
  EXPECT_TRUE(std::is_sorted(jumps.begin(), jumps.end()));
  EXPECT_TRUE(std::isfinite(bound->end()));
  if (bound->end() > 0 && !jumps.empty()) {
    EXPECT_LE(jumps.back(), bound->end());
  }
}

}  // namespace withy::test
