#include <gmock/gmock.h>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/tests/simulation/oscillator.hpp"

namespace withy {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double restoring(double, double q, double) { return -q; }

/// Outputs increase in time, all of it is finite, and the last is the final state.
void expect_results_kept(const Runner& run, const RunSummary& summary) {
  ASSERT_FALSE(run.outputs.empty());
  for (std::size_t i = 1; i < run.outputs.size(); ++i) EXPECT_GT(run.outputs[i].time, run.outputs[i - 1].time);
  for (const double y : summary.final.y) EXPECT_TRUE(std::isfinite(y));
  EXPECT_EQ(run.outputs.back().time, summary.reached);
  EXPECT_LE(summary.final.time, summary.reached);
  if (summary.final.time == summary.reached) {
    EXPECT_EQ(run.outputs.back().y, summary.final.y);
  }
}

// q = 0.1 cosh t passes the length, 2 m, at t = arcosh 20 = 3.688.
TEST(BadEnd, a_deflection_past_the_bodys_length_is_divergence) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, [](double, double q, double) { return q; });
  Runner run(until(10, 0.1));
  const RunSummary summary = run(model, equations, boom_state(0, 0.1));
  EXPECT_EQ(summary.status, RunStatus::diverged);
  EXPECT_NEAR(summary.reached, std::acosh(20), 0.2);
  EXPECT_GE(summary.peak_deflection.at("boom")[1], 2);
  EXPECT_THAT(summary.message,
              AllOf(HasSubstr("the tip of 'boom' is deflected by"), HasSubstr("times its length"),
                    HasSubstr("positive definite as it was at the start"), HasSubstr("Condition of M 1 ")));
  expect_results_kept(run, summary);
}

TEST(BadEnd, the_deflection_limit_can_be_set) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, [](double, double q, double) { return q; });
  Runner run(until(3, 0.1));
  run.options.deflection_limit = 0.1;
  const RunSummary summary = run(model, equations, boom_state(0, 0.1));
  EXPECT_EQ(summary.status, RunStatus::diverged);
  EXPECT_NEAR(summary.reached, std::acosh(2), 0.2);
  run.options.deflection_limit = 1;
  EXPECT_EQ(run(model, equations, boom_state(0, 0.1)).status, RunStatus::completed);
}

TEST(BadEnd, a_load_that_is_not_finite_is_named_and_the_last_state_kept) {
  for (const double from : {0.5, 0.0}) {
    Model model = boom();
    model.add_load("sound", TestLoad([](double) { return 1.0; }));
    model.add_load("broken", TestLoad([from](double t) { return t < from ? 0.0 : nan; }));
    const FunctionEquations equations = boom_equations(model, restoring);
    for (const char* id : {"dopri5", "rk4-adaptive"}) {
      Runner run(until(1, 0.1), make_integrator(id, {}));
      const RunSummary summary = run(model, equations, boom_state(0, 0.1));
      EXPECT_EQ(summary.status, RunStatus::diverged);
      EXPECT_NEAR(summary.reached, from, 1e-6);
      EXPECT_THAT(summary.message, AllOf(HasSubstr("not finite"), HasSubstr("load 'broken' gives nan on axle.0"),
                                         Not(HasSubstr("sound"))));
      expect_results_kept(run, summary);
    }
  }
}

/// A load with a state of its own, whose rate is no number from a time on.
class BoundIntegral final : public BoundLoad, private ContinuousPart {
 public:
  std::size_t scratch() const override { return 0; }
  void add(double, std::span<const double>, std::span<const double>, std::span<double>,
           std::span<double>) const noexcept override {}
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  void begin(State&) const override {}
  const ContinuousPart* continuous() const override { return this; }

 private:
  std::size_t states() const override { return 1; }
  std::string name(std::size_t) const override { return "integral"; }
  void begin(const LoadView&, std::span<double> z) const noexcept override { z[0] = 0; }
  void rates(const LoadView& view, std::span<double> rates) const noexcept override {
    rates[0] = view.t > 0.5 ? nan : 1;
  }
  void add(const LoadView&, std::span<double>) const noexcept override {}
};

class IntegralLoad final : public Load {
 public:
  std::unique_ptr<BoundLoad> bind(const Model&) const override { return std::make_unique<BoundIntegral>(); }
};

// The last state is before: the rate fails in a step from there.
TEST(BadEnd, a_state_of_a_load_whose_rate_ceases_to_be_finite_is_named) {
  Model model = boom();
  model.add_load("memory", IntegralLoad());
  const FunctionEquations equations = boom_equations(model, restoring);
  State last = model.reference_state();
  last.time = 0.49;
  EXPECT_TRUE(nonfinite_rates(model, last, 0.001).states.empty());
  const NonfiniteRates found = nonfinite_rates(model, last, 0.1);
  EXPECT_EQ(found.states, std::vector<std::size_t>{0});
  EXPECT_GT(found.time, 0.5);
  EXPECT_THAT(describe_nonfinite(model, equations, last, 0.1),
              HasSubstr("the rate of 'memory.integral' is not finite at t = 0.5"));
}

/// A load that holds a number, and renews it to none.
class BoundForgetting final : public BoundLoad, private DiscretePart {
 public:
  std::size_t scratch() const override { return 0; }
  void add(double, std::span<const double>, std::span<const double>, std::span<double>,
           std::span<double>) const noexcept override {}
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  void begin(State&) const override {}
  const DiscretePart* discrete() const override { return this; }

 private:
  std::size_t states() const override { return 1; }
  void renew(double, std::span<const double>, std::span<const double>, const Crossing&, std::span<double> d,
             std::span<double>) const noexcept override {
    d[0] = nan;
  }
  void add(double, std::span<const double>, std::span<double>) const noexcept override {}
};

class ForgettingLoad final : public Load {
 public:
  std::unique_ptr<BoundLoad> bind(const Model&) const override { return std::make_unique<BoundForgetting>(); }
};

TEST(BadEnd, a_load_that_holds_no_number_is_named) {
  Model model = boom();
  model.add_load("sound", TestLoad([](double) { return 1.0; }));
  model.add_load("memory", ForgettingLoad());
  const FunctionEquations equations = boom_equations(model, restoring);
  State state = model.reference_state();
  EXPECT_EQ(describe_nonfinite(model, equations, state, 0.1), "");
  state.y[model.loads()[1].slot.first] = nan;
  EXPECT_EQ(describe_nonfinite(model, equations, state, 0.1), "load 'memory' holds no number in its discrete states");
}

// Two coordinates, their two rates and the work.
TEST(BadEnd, the_number_that_is_none_is_named_and_no_other) {
  const Layout layout = boom().layout();
  const auto told = [&](std::size_t at, double number) {
    State state = boom_state(0.1, 0.2, 0.3, 0.4);
    state.y[at] = number;
    return nonfinite_number(layout, state);
  };
  EXPECT_EQ(told(0, 1), "");
  EXPECT_EQ(told(0, nan), "the coordinate 'axle.0' is nan");
  EXPECT_THAT(told(1, nan), HasSubstr("the coordinate 'boom."));
  EXPECT_EQ(told(2, std::numeric_limits<double>::infinity()), "the speed 'axle.0' is inf");
  EXPECT_EQ(told(4, nan), "the work is nan");
}

TEST(BadEnd, accelerations_that_are_not_finite_are_named) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, [](double, double, double) { return nan; });
  Runner run(until(1));
  const RunSummary summary = run(model, equations, boom_state(0, 0.1));
  EXPECT_EQ(summary.status, RunStatus::diverged);
  EXPECT_EQ(summary.reached, 0);
  EXPECT_THAT(summary.message, HasSubstr("the accelerations of boom.bending_y[1] are not finite"));
}

// q = t; an evaluation that cannot solve for the body's block from q = 0.5 on.
TEST(BadEnd, a_mass_matrix_that_cannot_be_solved_is_singular_and_names_the_body) {
  const Model model = boom();
  const FunctionEquations equations(model.layout(), [](double, std::span<const double> y, std::span<double> f) {
    f[0] = y[2];
    f[1] = 1;
    f[2] = f[3] = f[4] = 0;
    return y[1] < 0.5 ? Evaluation{} : Evaluation{Evaluation::Outcome::singular, 0};
  });
  for (const char* id : {"dopri5", "rk4-adaptive"}) {
    Runner run(until(1, 0.1), make_integrator(id, {}));
    const RunSummary summary = run(model, equations, boom_state(0, 0));
    EXPECT_EQ(summary.status, RunStatus::singular);
    EXPECT_NEAR(summary.reached, 0.5, 1e-6);
    EXPECT_THAT(summary.message, AllOf(HasSubstr("t = 0.5 s"), HasSubstr("cannot be solved"),
                                       HasSubstr("at body 'boom'"), HasSubstr("det M is positive")));
    expect_results_kept(run, summary);
  }
}

TEST(BadEnd, steps_below_the_resolution_of_time_are_step_underflow) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, [](double t, double, double) { return 1 / (t - 1); });
  Runner run(until(2, 0.1));
  run.options.deflection_limit = 1e9;
  const RunSummary summary = run(model, equations, boom_state(0, 0));
  EXPECT_EQ(summary.status, RunStatus::step_underflow);
  EXPECT_NEAR(summary.reached, 1, 1e-9);
  EXPECT_THAT(summary.message, HasSubstr("below the resolution of time"));
  EXPECT_TRUE(summary.suspected_jumps.empty());
  expect_results_kept(run, summary);
}

TEST(BadEnd, an_interruption_stops_between_two_steps) {
  const Model model = boom();
  int asked = 0;
  Runner run(until(100, 1));
  run.options.interrupted = [&] { return ++asked > 20; };
  const RunSummary summary = run(model, boom_equations(model, restoring), boom_state(0, 0.1));
  EXPECT_EQ(summary.status, RunStatus::interrupted);
  EXPECT_EQ(summary.steps.accepted, 20u);
  EXPECT_THAT(summary.message, HasSubstr("interrupted"));
  expect_results_kept(run, summary);
}

TEST(BadEnd, steps_and_wall_time_are_capped) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, restoring);
  Runner by_steps(until(1e9, 1e9));
  by_steps.options.most_steps = 30;
  RunSummary summary = by_steps(model, equations, boom_state(0, 0.1));
  EXPECT_EQ(summary.status, RunStatus::interrupted);
  EXPECT_EQ(summary.steps.accepted, 30u);
  EXPECT_THAT(summary.message, HasSubstr("30 steps allowed"));
  Runner by_time(until(1e9, 1e9));
  by_time.options.most_seconds = 0.02;
  summary = by_time(model, equations, boom_state(0, 0.1));
  EXPECT_EQ(summary.status, RunStatus::interrupted);
  EXPECT_THAT(summary.message, HasSubstr("0.02 s allowed"));
  expect_results_kept(by_time, summary);
}

// An unstable fixed step lets q grow until it overflows; deflections are not limited here.
TEST(BadEnd, an_unstable_fixed_step_is_divergence) {
  const Model model = boom();
  Runner run(until(1e5, 1e3), make_integrator("rk4", {{"step", Value(3.0)}}));
  run.options.deflection_limit = std::numeric_limits<double>::infinity();
  const RunSummary summary = run(model, boom_equations(model, restoring), boom_state(0, 0.1));
  EXPECT_EQ(summary.status, RunStatus::diverged);
  expect_results_kept(run, summary);
}

}  // namespace
}  // namespace withy
