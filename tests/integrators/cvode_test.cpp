/// \file
/// CVODE as an integrator: what of the conformance suites a multistep method of variable order can be asked for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stiff_problems.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"
#include "withy/tests/integrators/integrator_plugins.hpp"

extern "C" {
extern const withy::PluginDescriptor withy_plugin_cvode;
}

namespace withy {
namespace {

std::unique_ptr<Integrator> cvode(std::vector<Value::Member> options) {
  Registry registry = registry_of({&withy_plugin_cvode});
  return make_plugin<Integrator>(registry, "cvode", std::move(options));
}

class Cvode : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state, double tolerance) {
    integrator_ = cvode({{"method", Value(GetParam())}, {"rtol", Value(tolerance)}, {"atol", Value(tolerance)}});
    return integrator_->start(equations, state);
  }
  std::unique_ptr<Integrator> integrator_;
};

// CVODE's own error is in proportion to tolerance^0.8 (bdf) and far greater; its tolerance is calibrated.
TEST_P(Cvode, error_is_proportional_to_the_tolerance) {
  const FunctionEquations equations = Duffing::equations();
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (int digits = 3; digits <= 11; ++digits) {
    const double tolerance = std::pow(10.0, -digits);
    const auto stepper = start(equations, Duffing::start(), tolerance);
    ASSERT_EQ(drive(*stepper, 5).outcome, StepResult::Outcome::ok);
    EXPECT_THAT(stepper->remarks(), testing::IsEmpty());
    const double error = Duffing::error(5, stepper->state().y);
    RecordProperty("ratio_1e-" + std::to_string(digits), std::to_string(error / tolerance));
    EXPECT_LE(error, 10 * tolerance) << "tolerance " << tolerance;
    const double u = -digits, v = std::log10(error);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  const double slope = (n * xy - x * y) / (n * xx - x * x);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_NEAR(slope, 1, 0.2);
}

// CVODE's norm is a mean over all elements of y: an error must not hide behind a thousand of them at rest.
TEST_P(Cvode, error_does_not_hide_behind_what_rests) {
  const auto error = [this](std::size_t at_rest) {
    const FunctionEquations equations(1, 1 + at_rest, [](double, std::span<const double> v, std::span<double> f) {
      std::fill(f.begin(), f.end(), 0.0);
      f[0] = v[1];
      f[1] = -v[0];
      return Evaluation{};
    });
    State state{0, std::vector<double>(3 + at_rest)};
    state.y[0] = 1;
    const auto stepper = start(equations, state, 1e-6);
    EXPECT_EQ(drive(*stepper, 6).outcome, StepResult::Outcome::ok);
    return std::abs(stepper->state().y[0] - std::cos(6.0));
  };
  EXPECT_LT(error(0), 1e-5);
  EXPECT_LT(error(300), 1e-5);
}

// Below what steps can be rounded to it does what can be done, and says so.
TEST_P(Cvode, says_which_tolerance_is_less_than_rounding) {
  const FunctionEquations equations = Duffing::equations();
  const auto stepper = start(equations, Duffing::start(), 1e-14);
  ASSERT_EQ(drive(*stepper, 5).outcome, StepResult::Outcome::ok);
  EXPECT_LT(Duffing::error(5, stepper->state().y), 1e-10);
  EXPECT_THAT(stepper->remarks(), testing::ElementsAre(testing::HasSubstr("less than rounding leaves")));
}

// Two instants that are meant to be one may be a rounding apart, as 0.9 and 30 · 0.03: an interval that CVODE refuses.
TEST_P(Cvode, steps_over_intervals_of_rounding_with_their_slope) {
  const FunctionEquations equations = Duffing::equations();
  const auto stepper = start(equations, Duffing::start(), 1e-8);
  ASSERT_EQ(drive(*stepper, 30 * 0.03).outcome, StepResult::Outcome::ok);
  for (double limit = 30 * 0.03; limit < 0.9 + 1e-14; limit = std::nextafter(limit, 1.0)) {
    stepper->restart();
    ASSERT_EQ(stepper->step(limit).outcome, StepResult::Outcome::ok);
    ASSERT_EQ(stepper->state().time, limit);
  }
  ASSERT_EQ(drive(*stepper, 2).outcome, StepResult::Outcome::ok);
  EXPECT_LT(Duffing::error(2, stepper->state().y), 3e-6);
}

TEST_P(Cvode, interpolates_and_lands) {
  const FunctionEquations equations = Duffing::equations();
  const auto stepper = start(equations, Duffing::start(), 1e-8);
  std::vector<double> y(3);
  for (const double limit : {0.001, 0.5, std::nextafter(0.5, 1.0), 2.7, 4.0}) {
    while (stepper->state().time < limit) {
      const double before = stepper->state().time;
      ASSERT_EQ(stepper->step(limit).outcome, StepResult::Outcome::ok);
      ASSERT_LE(stepper->state().time, limit);
      const double t = (before + stepper->state().time) / 2;
      stepper->interpolate(t, y);
      EXPECT_LT(Duffing::error(t, y), 3e-6);
    }
    EXPECT_EQ(stepper->state().time, limit);
  }
}

TEST_P(Cvode, leaves_discrete_states_alone_wherever_it_interpolates) {
  expect_discrete_states_kept([&](const EquationsOfMotion& e, const State& s) { return start(e, s, 1e-6); });
}

TEST_P(Cvode, sees_declared_jumps_on_their_own_side) {
  const FunctionEquations equations = SwitchedOscillator::equations();
  const auto stepper = start(equations, SwitchedOscillator::start(), 1e-9);
  for (const double limit : {SwitchedOscillator::first, SwitchedOscillator::second, SwitchedOscillator::end}) {
    ASSERT_EQ(drive(*stepper, limit).outcome, StepResult::Outcome::ok);
    stepper->restart();
  }
  EXPECT_LT(SwitchedOscillator::error(stepper->state().y), 1e-6);
}

TEST_P(Cvode, keeps_quaternions_at_unit_length) {
  const FunctionEquations equations = Rotation::equations();
  const auto stepper = start(equations, Rotation::start(), 1e-8);
  while (stepper->state().time < 20) {
    ASSERT_EQ(stepper->step(20).outcome, StepResult::Outcome::ok);
    ASSERT_NEAR(Rotation::norm(stepper->state().y), 1, 4 * std::numeric_limits<double>::epsilon());
  }
  EXPECT_LT(Rotation::error(20, stepper->state().y), 1e-4);
}

TEST_P(Cvode, ends_with_an_outcome_where_evaluations_fail) {
  using Outcome = StepResult::Outcome;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<Failing, Outcome>> failures = {
      {{.rate = nan}, Outcome::nonfinite},
      {{.evaluation = {Evaluation::Outcome::nonfinite, 3}}, Outcome::nonfinite},
      {{.evaluation = {Evaluation::Outcome::singular, 2}}, Outcome::singular},
      {{.rate = nan, .from = 0}, Outcome::nonfinite},
  };
  for (const auto& [failing, outcome] : failures) {
    const FunctionEquations equations = failing.equations();
    const auto stepper = start(equations, {0, {1, 0, 0}}, 1e-6);
    const StepResult result = drive(*stepper, 1, 100'000);
    EXPECT_EQ(result.outcome, outcome);
    EXPECT_EQ(result.body, failing.evaluation.body);
    EXPECT_LE(stepper->state().time, failing.from);
  }
}

// A checkpoint changes nothing, and a stepper restored from it goes on alike: within a history, where CVODE begins anew
// of itself after 5,000 steps, at an instant and behind it.
TEST_P(Cvode, goes_on_bit_by_bit_with_or_without_checkpoints_and_restored_from_them) {
  const FunctionEquations equations = Duffing::equations();
  const auto integrator = cvode({{"method", Value(GetParam())}, {"rtol", Value(1e-9)}, {"atol", Value(1e-9)}});
  const auto whole = start(equations, Duffing::start(), 1e-9);
  const auto asked = start(equations, Duffing::start(), 1e-9);
  std::unique_ptr<Stepper> restored = start(equations, Duffing::start(), 1e-9);
  std::size_t step = 0;
  for (const double limit : {3.0, 3.5, 400.0}) {
    while (whole->state().time < limit && step < 11'000) {
      const std::vector<double> memory = asked->memory();
      if (step % 397 == 0 || step == 5'000 || step == 10'000) {
        const auto next = integrator->start(equations, Duffing::start());
        next->resume(restored->state(), memory);
        ASSERT_EQ(next->memory(), memory);
        restored = integrator->start(equations, Duffing::start());
        restored->resume(next->state(), next->memory());
      }
      for (Stepper* stepper : {whole.get(), asked.get(), restored.get()})
        ASSERT_EQ(stepper->step(limit).outcome, StepResult::Outcome::ok);
      for (const Stepper* stepper : {asked.get(), restored.get()}) {
        ASSERT_EQ(stepper->state().time, whole->state().time) << "step " << step;
        ASSERT_EQ(stepper->state().y, whole->state().y) << "step " << step;
      }
      ++step;
    }
    for (Stepper* stepper : {whole.get(), asked.get(), restored.get()}) stepper->restart();
  }
  EXPECT_GT(step, 10'000U);
  EXPECT_EQ(restored->statistics().evaluations, whole->statistics().evaluations);
  EXPECT_EQ(restored->statistics().rejected, whole->statistics().rejected);
}

TEST_P(Cvode, refuses_what_its_steps_do_not_lead_to) {
  const FunctionEquations equations = Duffing::equations();
  const auto whole = start(equations, Duffing::start(), 1e-6);
  ASSERT_EQ(drive(*whole, 1).outcome, StepResult::Outcome::ok);
  State other = whole->state();
  other.y[0] = std::nextafter(other.y[0], 2.0);
  const auto next = start(equations, Duffing::start(), 1e-6);
  EXPECT_THROW(next->resume(other, whole->memory()), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Withy, Cvode, testing::Values("bdf", "adams"), [](const auto& test) { return test.param; });

TEST(CvodeBdf, is_not_limited_by_stiffness) {
  const StiffEquations equations = Kpr::equations(-1e6);
  const auto integrator = cvode({{"rtol", Value(1e-6)}, {"atol", Value(1e-6)}});
  const auto stepper = integrator->start(equations, Kpr::start());
  ASSERT_EQ(drive(*stepper, 10).outcome, StepResult::Outcome::ok);
  EXPECT_LT(Kpr::error(10, stepper->state().y), 1e-3);
  EXPECT_LT(stepper->statistics().accepted, 3000u);
}

}  // namespace
}  // namespace withy
