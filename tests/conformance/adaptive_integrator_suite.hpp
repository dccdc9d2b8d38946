/// \file
/// What every integrator with error control must do beside IntegratorSuite.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "withy/tests/conformance/integrator_problems.hpp"

namespace withy {

struct AdaptiveIntegratorCase {
  std::string name;
  /// The method with this relative and absolute tolerance; `first_step` is its first step, 0: its own choice.
  std::function<std::unique_ptr<Integrator>(double tolerance, double first_step)> controlled;
  double worst_ratio = 10;  ///< error after 5 s, a period, of Duffing's oscillator over tolerance
};

inline void PrintTo(const AdaptiveIntegratorCase& c, std::ostream* out) { *out << c.name; }
inline std::string adaptive_case_name(const testing::TestParamInfo<AdaptiveIntegratorCase>& info) {
  return info.param.name;
}

class AdaptiveIntegratorSuite : public testing::TestWithParam<AdaptiveIntegratorCase> {
 protected:
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state, double tolerance,
                                 double first_step = 0) const {
    integrator_ = GetParam().controlled(tolerance, first_step);
    return integrator_->start(equations, state);
  }

 private:
  mutable std::unique_ptr<Integrator> integrator_;
};

// The slope of log error over log tolerance is fitted over all of 1e-3 … 1e-11; 1 is exact proportionality.
TEST_P(AdaptiveIntegratorSuite, error_is_proportional_to_the_tolerance) {
  const FunctionEquations equations = Duffing::equations();
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  double previous = 1;
  for (int digits = 3; digits <= 11; ++digits) {
    const double tolerance = std::pow(10.0, -digits);
    const auto stepper = start(equations, Duffing::start(), tolerance);
    ASSERT_EQ(drive(*stepper, 5).outcome, StepResult::Outcome::ok);
    const double error = Duffing::error(5, stepper->state().y);
    RecordProperty("ratio_1e-" + std::to_string(digits), std::to_string(error / tolerance));
    RecordProperty("evaluations_1e-" + std::to_string(digits), std::to_string(stepper->statistics().evaluations));
    EXPECT_LE(error, GetParam().worst_ratio * tolerance) << "tolerance " << tolerance;
    EXPECT_LT(error, previous) << "a tighter tolerance gives a smaller error; tolerance " << tolerance;
    previous = error;
    const double u = -digits, v = std::log10(error);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  const double slope = (n * xy - x * y) / (n * xx - x * x);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_NEAR(slope, 1, 0.2);
}

TEST_P(AdaptiveIntegratorSuite, continues_bit_by_bit_from_a_checkpoint) {
  for (const double tolerance : {1e-4, 1e-8}) {
    const auto begin = [&](const EquationsOfMotion& e, const State& s) { return start(e, s, tolerance); };
    expect_the_same_when_resumed(begin, Duffing::equations(), Duffing::start());
    expect_the_same_when_resumed(begin, Rotation::equations(), Rotation::start());
  }
}

// The solution of y′ = 1/(t − 1), ln|1 − t|, ends at t = 1.
TEST_P(AdaptiveIntegratorSuite, reports_step_underflow_at_a_singularity) {
  const FunctionEquations equations(1, 1, [](double t, std::span<const double>, std::span<double> f) {
    f[0] = 1 / (t - 1);
    f[1] = f[2] = 0;
    return Evaluation{};
  });
  for (const double tolerance : {1e-4, 1e-6, 1e-9}) {
    const auto stepper = start(equations, {0, {0, 0, 0}}, tolerance);
    EXPECT_EQ(drive(*stepper, 2, 100'000).outcome, StepResult::Outcome::step_underflow);
    EXPECT_NEAR(stepper->state().time, 1, 1e-9);
    EXPECT_LT(stepper->state().time, 1);
    EXPECT_NEAR(stepper->state().y[0], std::log1p(-stepper->state().time), 20 * tolerance * 37 + 1e-3)
        << "the last state is a good one";  // 37 = -ln ε, 20 steps; 1e-3: rounding of 1 - t in the last of them
  }
}

// y′ = y², y = 1/(1 − t): no step is too short for the accuracy until the numbers overflow or time has no room.
TEST_P(AdaptiveIntegratorSuite, ends_at_a_pole_of_the_solution) {
  const FunctionEquations equations(1, 1, [](double, std::span<const double> y, std::span<double> f) {
    f[0] = y[0] * y[0];
    f[1] = f[2] = 0;
    return Evaluation{};
  });
  const auto stepper = start(equations, {0, {1, 0, 0}}, 1e-6);
  EXPECT_NE(drive(*stepper, 2, 100'000).outcome, StepResult::Outcome::ok);
  EXPECT_NEAR(stepper->state().time, 1, 1e-4);
  EXPECT_TRUE(std::isfinite(stepper->state().y[0]));
}

// The right-hand side exists for |x| < 2 only; x = cos 100t stays there, stages of long steps do not.
TEST_P(AdaptiveIntegratorSuite, recovers_from_stages_that_fail_where_shorter_steps_do_not) {
  const FunctionEquations equations(1, 1, [](double, std::span<const double> y, std::span<double> f) {
    const bool outside = std::abs(y[0]) >= 2;
    f[0] = y[1];
    f[1] = outside ? std::numeric_limits<double>::quiet_NaN() : -1e4 * y[0];
    f[2] = 0;
    return outside ? Evaluation{Evaluation::Outcome::nonfinite, 0} : Evaluation{};
  });
  const auto stepper = start(equations, {0, {1, 0, 0}}, 1e-8, 1.0);
  ASSERT_EQ(drive(*stepper, 1).outcome, StepResult::Outcome::ok);
  EXPECT_GT(stepper->statistics().rejected, 0u);
  EXPECT_NEAR(stepper->state().y[0], std::cos(100.0), 1e-5);
}

// The work element varies a million times as strongly as the motion; neither steps nor motion change by a bit.
TEST_P(AdaptiveIntegratorSuite, the_work_element_has_no_part_in_the_error) {
  const auto run = [this](double work) {
    const FunctionEquations equations(1, 1, [work](double t, std::span<const double> y, std::span<double> f) {
      f[0] = y[1];
      f[1] = -std::sin(y[0]);
      f[2] = work * std::sin(1e3 * t);
      return Evaluation{};
    });
    const auto stepper = start(equations, {0, {1, 0, 0}}, 1e-7);
    drive(*stepper, 5);
    return std::pair(std::vector<double>{stepper->state().y[0], stepper->state().y[1]}, stepper->statistics().accepted);
  };
  EXPECT_EQ(run(0), run(1e6));
}

// Times in other units: with every rate a power of two as large the steps are that much shorter, bit by bit.
TEST_P(AdaptiveIntegratorSuite, steps_do_not_depend_on_the_unit_of_time) {
  const auto run = [this](double unit) {
    const FunctionEquations equations(2, 0, [unit](double, std::span<const double> y, std::span<double> f) {
      f[0] = unit * y[1];
      f[1] = -unit * std::sin(y[0]);
      f[2] = 0;
      return Evaluation{};
    });
    const auto stepper = start(equations, {0, {1, 0, 0}}, 1e-7);
    drive(*stepper, 8 / unit);
    return std::pair(stepper->state().y, stepper->statistics().accepted);
  };
  EXPECT_EQ(run(1), run(0x1p10));
  EXPECT_EQ(run(1), run(0x1p-10));
}

// Limits a little after a natural step must not leave a tiny last step: the shortest step before a limit is at least
// about half of the one wanted.
TEST_P(AdaptiveIntegratorSuite, the_last_step_before_a_limit_is_not_tiny) {
  const FunctionEquations equations = Duffing::equations();
  for (int i = 0; i < 50; ++i) {
    const auto stepper = start(equations, Duffing::start(), 1e-6, 0.05);
    const double limit = 2 + 0.004 * i;
    double before_last = 0, last = 0;
    while (stepper->state().time < limit) {
      const double t = stepper->state().time;
      ASSERT_EQ(stepper->step(limit).outcome, StepResult::Outcome::ok);
      before_last = last;
      last = stepper->state().time - t;
    }
    EXPECT_GT(last, before_last / 3);
  }
}

TEST_P(AdaptiveIntegratorSuite, zero_rates_are_stepped_over_at_once) {
  const FunctionEquations equations(1, 1, [](double, std::span<const double>, std::span<double> f) {
    std::fill(f.begin(), f.end(), 0.0);
    return Evaluation{};
  });
  const auto stepper = start(equations, {0, {1, 0, 0}}, 1e-6);
  ASSERT_EQ(drive(*stepper, 1e3).outcome, StepResult::Outcome::ok);
  EXPECT_LT(stepper->statistics().accepted, 20u);
  EXPECT_EQ(stepper->state().y, (std::vector<double>{1, 0, 0}));
}

}  // namespace withy
