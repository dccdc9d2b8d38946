#include <gtest/gtest.h>

#include "withy/tests/conformance/integrator_problems.hpp"
#include "withy/tests/integrators/integrator_plugins.hpp"

namespace withy {
namespace {

TEST(Rk4, divides_an_interval_equally_into_steps_no_longer_than_asked_for) {
  const FunctionEquations equations = Duffing::equations();
  const auto stepper = make_integrator("rk4", {{"step", Value(0.03)}})->start(equations, Duffing::start());
  ASSERT_EQ(drive(*stepper, 1).outcome, StepResult::Outcome::ok);
  const StepStatistics& s = stepper->statistics();
  EXPECT_EQ(s.accepted, 34u);             // 1 / 0.03 = 33.3
  EXPECT_EQ(s.evaluations, 4 * 34u + 1);  // the slope at the end of a step is the first stage of the next
  EXPECT_NEAR(s.smallest_step, 1.0 / 34, 1e-15);
  EXPECT_NEAR(s.largest_step, 1.0 / 34, 1e-15);
}

TEST(Rk4, rounding_adds_no_step) {
  const FunctionEquations equations = Duffing::equations();
  const auto stepper = make_integrator("rk4", {{"step", Value(0.001)}})->start(equations, Duffing::start());
  ASSERT_EQ(drive(*stepper, 10).outcome, StepResult::Outcome::ok);
  EXPECT_EQ(stepper->statistics().accepted, 10'000u);
}

class Adaptive : public testing::TestWithParam<std::string> {};

TEST_P(Adaptive, max_step_is_exceeded_by_at_most_one_percent) {
  const FunctionEquations equations = Duffing::equations();
  const auto integrator = make_integrator(GetParam(), {{"rtol", Value(1e-2)}, {"max_step", Value(0.01)}});
  const auto stepper = integrator->start(equations, Duffing::start());
  ASSERT_EQ(drive(*stepper, 1.0037).outcome, StepResult::Outcome::ok);
  EXPECT_LE(stepper->statistics().largest_step, 0.0101);
}

TEST_P(Adaptive, a_step_below_min_step_is_step_underflow) {
  const FunctionEquations equations = Duffing::equations();
  const auto integrator =
      make_integrator(GetParam(), {{"rtol", Value(1e-12)}, {"atol", Value(1e-12)}, {"min_step", Value(0.05)}});
  const auto stepper = integrator->start(equations, Duffing::start());
  EXPECT_EQ(drive(*stepper, 1).outcome, StepResult::Outcome::step_underflow);
}

TEST_P(Adaptive, initial_step_is_the_first_step_and_the_first_after_a_restart) {
  const FunctionEquations equations = Duffing::equations();
  const auto integrator = make_integrator(GetParam(), {{"initial_step", Value(1e-4)}});
  const auto stepper = integrator->start(equations, Duffing::start());
  for (const double limit : {1.0, 2.0}) {
    const double before = stepper->state().time;
    ASSERT_EQ(stepper->step(limit).outcome, StepResult::Outcome::ok);
    EXPECT_NEAR(stepper->state().time - before, 1e-4, 1e-15);
    ASSERT_EQ(drive(*stepper, limit).outcome, StepResult::Outcome::ok);
    stepper->restart();
  }
}

TEST_P(Adaptive, min_step_above_max_step_is_an_error_at_its_place) {
  Registry registry = integrator_registry();
  Diagnostics diagnostics;
  EXPECT_EQ(make_plugin<Integrator>(
                registry, GetParam(),
                {{"max_step", Value(0.1)}, {"min_step", Value(0.2, {7, 3, "/integrator/min_step"})}}, diagnostics),
            nullptr);
  ASSERT_EQ(diagnostics.errors().size(), 1u);
  EXPECT_EQ(diagnostics.errors()[0].place.line, 7);
}

INSTANTIATE_TEST_SUITE_P(Withy, Adaptive, testing::Values("rk4-adaptive", "dopri5"), [](const auto& test) {
  return test.param == "dopri5" ? std::string("dopri5") : std::string("rk4_adaptive");
});

// Evaluations a step: whole and two halves share their first stage and the last slope is the next step's first.
TEST(Cost, is_eleven_evaluations_a_step_doubled_and_six_with_dormand_prince) {
  const FunctionEquations equations = Duffing::equations();
  for (const auto& [id, stages] : {std::pair("rk4-adaptive", 11u), std::pair("dopri5", 6u)}) {
    const auto integrator = make_uncontrolled(id, 0.01);
    const auto stepper = integrator->start(equations, Duffing::start());
    ASSERT_EQ(drive(*stepper, 1).outcome, StepResult::Outcome::ok);
    EXPECT_EQ(stepper->statistics().accepted, 100u);
    EXPECT_EQ(stepper->statistics().evaluations, 100 * stages + 1);
  }
}

}  // namespace
}  // namespace withy
