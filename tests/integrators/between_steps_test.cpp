// What methods know within their steps, and what they carry from step to step.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "withy/tests/conformance/function_equations.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"
#include "withy/tests/integrators/integrator_plugins.hpp"

namespace withy {
namespace {

const std::array<const char*, 5> adaptive_methods = {"rk4-adaptive", "dopri5", "dop853", "imex", "radau"};

// With s = 24 sin 5t the motion from rest at 0 is 5 sin t − sin 5t: an interpolant that makes
// stages of its own makes them at their times.
TEST(BetweenSteps, interpolants_see_forces_of_time_at_the_times_of_their_stages) {
  const FunctionEquations equations = pushed_oscillator([](double t) { return 24 * std::sin(5 * t); });
  for (const char* method : adaptive_methods) {
    const auto greatest = [&](double h) {
      const auto stepper = make_uncontrolled(method, h)->start(equations, {0, {0, 0, 0}});
      double most = 0;
      std::vector<double> y(3);
      while (stepper->state().time < 2) {
        const double before = stepper->state().time;
        EXPECT_EQ(stepper->step(2).outcome, StepResult::Outcome::ok);
        for (int i = 1; i < 8; ++i) {
          const double t = before + i / 8.0 * (stepper->state().time - before);
          stepper->interpolate(t, y);
          most = std::max(most, std::abs(y[0] - 5 * std::sin(t) + std::sin(5 * t)));
        }
      }
      return most;
    };
    EXPECT_GE(std::log2(greatest(0.1) / greatest(0.05)), std::string(method) == "dop853" ? 6.8 : 3.8) << method;
  }
}

// A force that jumps where a step ends is no part of an interpolant behind it: from (1, 0) to s = 1 at t = 1.
TEST(BetweenSteps, interpolants_do_not_reach_back_over_a_restart) {
  const FunctionEquations equations = pushed_oscillator([](double t) { return t < 1 ? 0.0 : 1.0; });
  for (const char* method : adaptive_methods) {
    const auto stepper = make_uncontrolled(method, 0.1)->start(equations, {0, {1, 0, 0}});
    ASSERT_EQ(drive(*stepper, 1).outcome, StepResult::Outcome::ok);
    stepper->restart();
    std::vector<double> y(3);
    for (int step = 0; step < 3; ++step) {
      const double before = stepper->state().time;
      ASSERT_EQ(stepper->step(2).outcome, StepResult::Outcome::ok);
      const double t = 0.5 * (before + stepper->state().time), after = t - 1;
      stepper->interpolate(t, y);
      EXPECT_NEAR(y[0], 1 + (std::cos(1) - 1) * std::cos(after) - std::sin(1) * std::sin(after), 4e-6) << method;
    }
  }
}

// The step doubled is extrapolated in its middle as at its end: halving it divides the error there by 2⁶.
TEST(BetweenSteps, the_middle_of_a_step_doubled_is_as_good_as_its_end) {
  const FunctionEquations equations = Duffing::equations();
  const auto error = [&](double h) {
    const auto stepper = make_uncontrolled("rk4-adaptive", h)->start(equations, Duffing::start());
    EXPECT_EQ(stepper->step(h).outcome, StepResult::Outcome::ok);
    std::vector<double> y(3);
    stepper->interpolate(h / 2, y);
    return Duffing::error(h / 2, y);
  };
  EXPECT_GT(std::log2(error(0.1) / error(0.05)), 5.6);
}

// At a constant speed: a hundred thousand sums of equal increments, each to half a digit of the last place.
TEST(BetweenSteps, what_sums_of_equal_steps_lose_is_not_lost) {
  const FunctionEquations equations(1, 1, [](double, std::span<const double> y, std::span<double> f) {
    f[0] = y[1];
    f[1] = f[2] = 0;
    return Evaluation{};
  });
  for (const char* method : {"gauss", "generalized-alpha"}) {
    const auto stepper = make_integrator(method, {{"step", Value(0.1)}})->start(equations, {0, {0.7, 0.3, 0}});
    ASSERT_EQ(drive(*stepper, 1e4).outcome, StepResult::Outcome::ok);
    EXPECT_NEAR(stepper->state().y[0], 3000.7, 2e-12) << method;
  }
}

}  // namespace
}  // namespace withy
