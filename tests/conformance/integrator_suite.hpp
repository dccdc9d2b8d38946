/// \file
/// What every integrator must do, whoever wrote it. Instantiate with
///   INSTANTIATE_TEST_SUITE_P(Mine, IntegratorSuite, testing::Values(IntegratorCase{…}), integrator_case_name);
/// and link tests/conformance/allocations.cpp. Integrators with error control also pass AdaptiveIntegratorSuite.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "withy/tests/conformance/allocations.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"

namespace withy {

struct IntegratorCase {
  std::string name;
  /// The method with steps of this size and no regard to errors.
  std::function<std::unique_ptr<Integrator>(double step)> equal_steps;
  int interpolation_order = 0;  ///< k, where the interpolant's error over an interval is O(hᵏ)
  double imaginary_limit = 0;  ///< greatest stable hω of an undamped oscillation; published or derived; may be infinite
  double stretch = 1;          ///< of the steps that measure orders: high orders reach rounding with short ones
};

inline void PrintTo(const IntegratorCase& c, std::ostream* out) { *out << c.name; }
inline std::string integrator_case_name(const testing::TestParamInfo<IntegratorCase>& info) { return info.param.name; }

class IntegratorSuite : public testing::TestWithParam<IntegratorCase> {
 protected:
  std::unique_ptr<Integrator> with_step(double h) const { return GetParam().equal_steps(h); }
  /// An error no method of its order has in these tests.
  double rough() const { return with_step(0.1)->order() > 2 ? 1e-3 : 5e-3; }

  /// Error of Duffing's oscillator at t = 4, and within the steps until then.
  struct Errors {
    double end = 0, inside = 0;
  };
  Errors duffing(double h) const {
    const FunctionEquations equations = Duffing::equations();
    const auto integrator = with_step(h);
    const auto stepper = integrator->start(equations, Duffing::start());
    Errors e;
    std::vector<double> y(3);
    while (stepper->state().time < 4) {
      const double before = stepper->state().time;
      if (stepper->step(4).outcome != StepResult::Outcome::ok) throw std::runtime_error("a step failed");
      for (int i = 1; i < 8; ++i) {
        const double t = before + i / 8.0 * (stepper->state().time - before);
        stepper->interpolate(t, y);
        e.inside = std::max(e.inside, Duffing::error(t, y));
      }
    }
    e.end = Duffing::error(4, stepper->state().y);
    return e;
  }
};

TEST_P(IntegratorSuite, is_stable_to_a_positive_step_or_does_not_say_and_begins_where_it_is_told) {
  const auto integrator = with_step(0.1);
  if (const auto limit = integrator->stability_limit()) {
    EXPECT_GT(*limit, 0);
  }
  EXPECT_GE(integrator->order(), 1);
  const FunctionEquations equations = Duffing::equations();
  State start = Duffing::start();
  start.time = 0.25;
  const auto stepper = integrator->start(equations, start);
  ASSERT_NE(stepper, nullptr);
  EXPECT_EQ(stepper->state().time, start.time);
  EXPECT_EQ(stepper->state().y, start.y);
  ASSERT_EQ(stepper->step(0.25 + 1e-3).outcome, StepResult::Outcome::ok);
  EXPECT_EQ(stepper->state().y.size(), start.y.size());
  EXPECT_GT(stepper->state().time, start.time);
  EXPECT_LE(stepper->state().time, 0.25 + 1e-3);
  std::vector<double> inside(start.y.size(), std::nan(""));
  stepper->interpolate(0.5 * (start.time + stepper->state().time), inside);
  for (const double y : inside) EXPECT_TRUE(std::isfinite(y));
}

// Halving the step divides the error by 2^order. The steps are short enough for the next order to matter by less than
// 0.1 and long enough for rounding not to; a method may be better than it says by a fortunate 0.6.
TEST_P(IntegratorSuite, has_the_order_it_states_on_a_nonlinear_oscillator) {
  const double measured = std::log2(duffing(0.025 * GetParam().stretch).end / duffing(0.0125 * GetParam().stretch).end);
  RecordProperty("order", std::to_string(measured));
  EXPECT_GE(measured, with_step(0.1)->order() - 0.1);
  EXPECT_LE(measured, with_step(0.1)->order() + 0.6);
}

TEST_P(IntegratorSuite, interpolates_to_the_order_stated) {
  const double measured =
      std::log2(duffing(0.05 * GetParam().stretch).inside / duffing(0.025 * GetParam().stretch).inside);
  RecordProperty("order", std::to_string(measured));
  EXPECT_GE(measured, GetParam().interpolation_order - 0.2);
}

TEST_P(IntegratorSuite, interpolates_to_the_states_at_the_ends_of_a_step) {
  const FunctionEquations equations = Duffing::equations();
  const auto stepper = with_step(0.1)->start(equations, Duffing::start());
  ASSERT_EQ(stepper->step(1).outcome, StepResult::Outcome::ok);
  const State before = stepper->state();
  ASSERT_EQ(stepper->step(1).outcome, StepResult::Outcome::ok);
  std::vector<double> y(3);
  stepper->interpolate(before.time, y);
  EXPECT_EQ(y, before.y);
  stepper->interpolate(stepper->state().time, y);
  EXPECT_EQ(y, stepper->state().y);
}

TEST_P(IntegratorSuite, lands_on_limits_to_the_bit_and_never_passes_them) {
  const FunctionEquations equations = Duffing::equations();
  const auto stepper = with_step(0.07)->start(equations, Duffing::start());
  // Among them limits closer than a step, one unit in the last place apart, and far from multiples of the step.
  const double third = 1.0 / 3;
  for (const double limit : {0.001, third, std::nextafter(third, 1.0), 0.1 + 0.7, std::numbers::e, 3.0}) {
    while (stepper->state().time < limit) {
      const double before = stepper->state().time;
      ASSERT_EQ(stepper->step(limit).outcome, StepResult::Outcome::ok);
      ASSERT_GT(stepper->state().time, before);
      ASSERT_LE(stepper->state().time, limit);
    }
    EXPECT_EQ(stepper->state().time, limit);
    const std::size_t steps = stepper->statistics().accepted;
    EXPECT_EQ(stepper->step(limit).outcome, StepResult::Outcome::ok);
    EXPECT_EQ(stepper->statistics().accepted, steps) << "a limit that is reached asks for no step";
  }
  EXPECT_LT(Duffing::error(3, stepper->state().y), rough());
}

// A force that jumps at times the caller knows costs no order, as long as the step that ends there sees the force
// before the jump and the next the force after it.
TEST_P(IntegratorSuite, keeps_its_order_over_declared_jumps) {
  const auto error = [this](double h) {
    const FunctionEquations equations = SwitchedOscillator::equations();
    const auto stepper = with_step(h)->start(equations, SwitchedOscillator::start());
    for (const double limit : {SwitchedOscillator::first, SwitchedOscillator::second, SwitchedOscillator::end}) {
      if (drive(*stepper, limit).outcome != StepResult::Outcome::ok) throw std::runtime_error("a step failed");
      stepper->restart();
    }
    return SwitchedOscillator::error(stepper->state().y);
  };
  const double measured = std::log2(error(0.05 * GetParam().stretch) / error(0.025 * GetParam().stretch));
  RecordProperty("order", std::to_string(measured));
  EXPECT_GE(measured, with_step(0.1)->order() - 0.1);
}

// x = cos ωt is damped or kept below the limit and grows above it, each by 1 %.
TEST_P(IntegratorSuite, is_stable_up_to_its_limit_on_the_imaginary_axis) {
  FunctionEquations oscillator(1, 1, [](double, std::span<const double> y, std::span<double> f) {
    f[0] = y[1];
    f[1] = -y[0];
    f[2] = 0;
    return Evaluation{};
  });
  oscillator.stiffness_ = {1};
  const auto amplitude = [&](double h) {
    const auto stepper = with_step(h)->start(oscillator, {0, {1, 0, 0}});
    drive(*stepper, 20'000 * h);
    return std::hypot(stepper->state().y[0], stepper->state().y[1]);
  };
  if (std::isinf(GetParam().imaginary_limit)) {
    // But for rounding of 20,000 increments h ẏ.
    for (const double h : {0.1, 1.0, 10.0, 1e3, 1e6})
      EXPECT_LE(amplitude(h), 1 + 20'000 * 1e-15 * std::max(1.0, h)) << h;
    return;
  }
  EXPECT_LE(amplitude(0.99 * GetParam().imaginary_limit), 1.0);
  EXPECT_GT(amplitude(1.01 * GetParam().imaginary_limit), 1.0 + 1e-6);
}

TEST_P(IntegratorSuite, ends_where_evaluations_fail_and_keeps_the_last_state) {
  using Outcome = StepResult::Outcome;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<Failing, Outcome>> failures = {
      {{.rate = nan}, Outcome::nonfinite},
      {{.rate = infinity}, Outcome::nonfinite},
      {{.evaluation = {Evaluation::Outcome::nonfinite, 3}}, Outcome::nonfinite},
      {{.evaluation = {Evaluation::Outcome::singular, 2}}, Outcome::singular},
      {{.rate = nan, .from = 0}, Outcome::nonfinite},
  };
  for (const auto& [failing, outcome] : failures) {
    const FunctionEquations equations = failing.equations();
    const auto stepper = with_step(0.03)->start(equations, {0, {1, 0, 0}});
    State last = stepper->state();
    StepStatistics before;
    StepResult result;
    for (std::size_t i = 0; i < 10'000 && result.outcome == Outcome::ok; ++i) {
      last = stepper->state();
      before = stepper->statistics();
      result = stepper->step(1);
    }
    EXPECT_EQ(result.outcome, outcome);
    EXPECT_EQ(result.body, failing.evaluation.body);
    EXPECT_LE(stepper->statistics().rejected - before.rejected, 20u);
    EXPECT_EQ(stepper->state().time, last.time);
    EXPECT_EQ(stepper->state().y, last.y);
    EXPECT_LE(last.time, failing.from);
    EXPECT_GE(last.time, failing.from - 0.031) << "it stops no earlier than it must";
    std::vector<double> y(3);
    stepper->interpolate(last.time - 0.01, y);  // inside the last step, or at its start
    EXPECT_NEAR(y[0], std::cos(last.time), 0.02);
  }
}

// At rest at the origin, and nothing moves it yet: nothing has a size that errors could be relative to.
TEST_P(IntegratorSuite, starts_from_rest_under_a_force_that_begins_at_zero) {
  FunctionEquations equations(1, 1, [](double t, std::span<const double> y, std::span<double> f) {
    f[0] = y[1];
    f[1] = -y[0] + std::sin(2 * t);
    f[2] = 0;
    return Evaluation{};
  });
  equations.stiffness_ = {1};
  const auto stepper = with_step(0.01)->start(equations, {0, {0, 0, 0}});
  ASSERT_EQ(drive(*stepper, 1).outcome, StepResult::Outcome::ok);
  EXPECT_NEAR(stepper->state().y[0], (2 * std::sin(1.0) - std::sin(2.0)) / 3, 1e-4);
}

TEST_P(IntegratorSuite, steps_without_allocating) {
  const FunctionEquations equations = Rotation::equations();
  const auto stepper = with_step(0.01)->start(equations, Rotation::start());
  std::vector<double> y(8);
  const std::size_t before = allocations();
  for (int i = 1; i <= 100; ++i) {
    drive(*stepper, 0.025 * i);
    stepper->interpolate(stepper->state().time - 0.004, y);
    stepper->restart();
  }
  EXPECT_EQ(allocations(), before);
}

TEST_P(IntegratorSuite, gives_the_same_bits_twice) {
  const auto bits = [this] {
    const FunctionEquations equations = Duffing::equations();
    const auto stepper = with_step(0.013)->start(equations, Duffing::start());
    drive(*stepper, 2.3);
    return stepper->state().y;
  };
  const std::vector<double> a = bits(), b = bits();
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
}

TEST_P(IntegratorSuite, continues_bit_by_bit_from_a_checkpoint) {
  const auto integrator = with_step(0.013);
  const auto start = [&](const EquationsOfMotion& e, const State& s) { return integrator->start(e, s); };
  expect_the_same_when_resumed(start, Duffing::equations(), Duffing::start());
  expect_the_same_when_resumed(start, Rotation::equations(), Rotation::start());
}

// Back to a state within the last step: from there as if started there.
TEST_P(IntegratorSuite, jumps_to_another_state) {
  const FunctionEquations equations = Duffing::equations();
  const auto integrator = with_step(0.05 * GetParam().stretch);
  const auto stepper = integrator->start(equations, Duffing::start());
  ASSERT_EQ(drive(*stepper, 1).outcome, StepResult::Outcome::ok);
  const State other{0.99, {-0.3, 0.2, 0.1}};
  stepper->jump(other);
  EXPECT_EQ(stepper->state().time, other.time);
  EXPECT_EQ(stepper->state().y, other.y);
  const auto fresh = integrator->start(equations, other);
  ASSERT_EQ(drive(*stepper, 2).outcome, StepResult::Outcome::ok);
  ASSERT_EQ(drive(*fresh, 2).outcome, StepResult::Outcome::ok);
  EXPECT_EQ(stepper->state().y, fresh->state().y);
}

// Continuous states of loads stand behind the speeds and follow first-order equations of their own, here one that the
// motion would not leave alone: ẍ = −x + z, ż = −z + 0.7 (x − X(t)), X = (e⁻ᵗ + cos t + sin t)/2 what it does from 1 at
// rest with z = 1.
TEST_P(IntegratorSuite, has_the_order_it_states_with_continuous_states_of_loads) {
  Layout layout = Duffing::equations().layout();
  layout.continuous = 1;
  const auto X = [](double t) { return 0.5 * (std::exp(-t) + std::cos(t) + std::sin(t)); };
  FunctionEquations equations(layout, [&](double t, std::span<const double> y, std::span<double> f) {
    f[0] = y[1];
    f[1] = -y[0] + y[2];
    f[2] = -y[2] + 0.7 * (y[0] - X(t));
    f[3] = 0;
    return Evaluation{};
  });
  equations.stiffness_ = {1};
  const auto error = [&](double h) {
    const auto stepper = with_step(h)->start(equations, {0, {1, 0, 1, 0}});
    EXPECT_EQ(drive(*stepper, 3).outcome, StepResult::Outcome::ok);
    return std::max(std::abs(stepper->state().y[0] - X(3)), std::abs(stepper->state().y[2] - std::exp(-3)));
  };
  const double measured = std::log2(error(0.05 * GetParam().stretch) / error(0.025 * GetParam().stretch));
  RecordProperty("order", std::to_string(measured));
  EXPECT_GE(measured, with_step(0.1)->order() - 0.25);
}

// Between positions with speeds and the work stand the loads' discrete states, which are constant between instants.
TEST_P(IntegratorSuite, leaves_discrete_states_alone_and_integrates_the_work_behind_them) {
  Layout layout = Duffing::equations().layout();
  layout.discrete = 3;
  const std::vector<double> discrete = {1, 0.1, -3};
  FunctionEquations with(layout, [](double, std::span<const double> y, std::span<double> f) {
    f[0] = y[1];
    f[1] = -y[0] - y[0] * y[0] * y[0] + 0.1 * (y[2] + 20 * y[3] + y[4]);
    f[2] = f[3] = f[4] = 0;
    f[5] = y[0] * y[0];
    return Evaluation{};
  });
  const FunctionEquations without = Duffing::equations();
  with.stiffness_ = without.stiffness_;
  const auto integrator = with_step(0.05);
  const auto a = integrator->start(with, {0, {1, 0, 1, 0.1, -3, 0}}), b = integrator->start(without, Duffing::start());
  ASSERT_EQ(drive(*a, 2).outcome, StepResult::Outcome::ok);
  ASSERT_EQ(drive(*b, 2).outcome, StepResult::Outcome::ok);
  const std::vector<double>&y = a->state().y, &x = b->state().y;
  EXPECT_EQ(std::vector<double>(y.begin() + 2, y.begin() + 5), discrete);
  // The same steps but for what an iteration leaves.
  EXPECT_NEAR(y[0], x[0], 1e-11);
  EXPECT_NEAR(y[1], x[1], 1e-11);
  EXPECT_NEAR(y[5], x[2], 1e-11);
}

TEST_P(IntegratorSuite, leaves_discrete_states_alone_wherever_it_interpolates) {
  expect_discrete_states_kept([&](const EquationsOfMotion& e, const State& s) { return with_step(0.05)->start(e, s); });
}

// The equations' normalize is applied after each step; dividing by a norm leaves at most 4 ε.
TEST_P(IntegratorSuite, keeps_quaternions_at_unit_length) {
  const FunctionEquations equations = Rotation::equations();
  const auto stepper = with_step(0.02)->start(equations, Rotation::start());
  std::vector<double> y(8);
  double worst = 0;
  for (int i = 1; i <= 10'000; ++i) {
    ASSERT_EQ(stepper->step(1000).outcome, StepResult::Outcome::ok);
    stepper->interpolate(stepper->state().time - 0.01, y);
    worst = std::max({worst, std::abs(Rotation::norm(stepper->state().y) - 1), std::abs(Rotation::norm(y) - 1)});
  }
  EXPECT_LE(worst, 4 * std::numeric_limits<double>::epsilon());
  EXPECT_LT(Rotation::error(stepper->state().time, stepper->state().y),
            with_step(0.1)->order() > 2 ? rough() : 20 * rough());
}

TEST_P(IntegratorSuite, refuses_a_state_of_another_size) {
  const FunctionEquations equations = Duffing::equations();
  EXPECT_THROW((void)with_step(0.1)->start(equations, {0, {1, 0}}), std::invalid_argument);
}

}  // namespace withy
