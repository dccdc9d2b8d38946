#include <gmock/gmock.h>

#include "withy/tests/simulation/oscillator.hpp"

namespace withy {
namespace {

using testing::HasSubstr;

double spring(double, double q, double) { return -q; }

TEST(Simulate, outputs_are_multiples_of_the_interval_and_the_end_to_the_bit) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, spring);
  // (0.3, 0.1): 3 · 0.1 is greater than 0.3 by rounding, and no output of its own. (1, 0.3): the end is no multiple.
  for (const auto& [end, interval, count] :
       {std::tuple(0.3, 0.1, 4u), std::tuple(1.0, 0.3, 5u), std::tuple(2.0, 0.01, 201u), std::tuple(0.5, 7.0, 2u)}) {
    Runner run(until(end, interval));
    const RunSummary summary = run(model, equations, boom_state(0, 0.1));
    EXPECT_EQ(summary.status, RunStatus::completed);
    EXPECT_EQ(summary.message, "");
    ASSERT_EQ(run.outputs.size(), count) << end << " " << interval;
    for (std::size_t i = 0; i + 1 < count; ++i) EXPECT_EQ(run.outputs[i].time, static_cast<double>(i) * interval);
    EXPECT_EQ(run.outputs.back().time, end);
    EXPECT_EQ(summary.final.time, end);
    EXPECT_EQ(run.outputs.back().y, summary.final.y);
    for (const State& s : run.outputs) EXPECT_NEAR(s.y[1], 0.1 * std::cos(s.time), 1e-8);
  }
}

TEST(Simulate, outputs_of_a_resumed_run_are_the_multiples_after_its_start) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, spring);
  State start = boom_state(0, 0.1);
  start.time = 0.25;
  Runner run(until(0.5, 0.1));
  EXPECT_EQ(run(model, equations, start).status, RunStatus::completed);
  std::vector<double> times;
  for (const State& s : run.outputs) times.push_back(s.time);
  EXPECT_EQ(times, (std::vector<double>{0.25, 3 * 0.1, 0.4, 0.5}));
}

TEST(Simulate, outputs_do_not_change_the_result) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, spring);
  for (const char* id : {"dopri5", "rk4-adaptive"}) {
    Runner coarse(until(3, 3), make_integrator(id, {}));
    Runner fine(until(3, 0.001), make_integrator(id, {}));
    const RunSummary a = coarse(model, equations, boom_state(0, 0.1)), b = fine(model, equations, boom_state(0, 0.1));
    EXPECT_EQ(a.final.y, b.final.y);
    EXPECT_EQ(a.steps.accepted, b.steps.accepted);
    EXPECT_EQ(fine.outputs.size(), 3001u);
  }
}

// q = 0.1 cos t and, driven by sin 3t, ẋ = (1 − cos 3t)/3.
TEST(Simulate, peaks_are_those_of_the_motion) {
  Model model = boom();
  model.add_load("motor", TestLoad([](double t) { return -4 * std::sin(3 * t); }));
  const FunctionEquations equations = boom_equations(model, spring);
  Runner run(until(4, 0.001));
  const RunSummary summary = run(model, equations, boom_state(0, -0.1));
  ASSERT_EQ(summary.peak_deflection.count("boom"), 1u);
  const auto& peak = summary.peak_deflection.at("boom");
  EXPECT_EQ(peak[0], 0);
  EXPECT_NEAR(peak[1], 0.1, 1e-9);
  // Sampled at steps and, where the peak lies between two of them, at their quarters: no further from it than an eighth
  // of the longest.
  const double off = 3 * summary.steps.largest_step / 8;
  EXPECT_LE(summary.peak_effort[0], 4);
  EXPECT_GT(summary.peak_effort[0], 4 * (1 - 0.5 * off * off));
  EXPECT_LT(off, 0.2);
  EXPECT_EQ(summary.peak_effort[1], 0);
  EXPECT_GT(summary.steps.accepted, 10u);
  EXPECT_GT(summary.steps.evaluations, 6 * summary.steps.accepted);
  EXPECT_GT(summary.cpu_seconds, 0);
  EXPECT_NEAR(summary.conditioning.condition, 1, 1e-15);
  EXPECT_EQ(summary.conditioning.determinant_sign, 1);
}

// E = ½ẋ² + ½q̇² + ½q²; the motor's work is the fifth element. Against the true energy the drift is that of the
// integrator; an energy that is wrong by 1 % of the kinetic part shows as such.
TEST(Simulate, energy_drift_compares_the_energy_with_the_work_of_the_loads) {
  Model model = boom();
  model.add_load("motor", TestLoad([](double t) { return std::cos(t); }));
  FunctionEquations equations = boom_equations(model, spring);
  double factor = 1;
  equations.energies_ = [&](std::span<const double> y) {
    return Energies{.kinetic = factor * 0.5 * (y[2] * y[2] + y[3] * y[3]), .potential = 0.5 * y[1] * y[1]};
  };
  Runner run(until(10, 0.1));
  EXPECT_LT(run(model, equations, boom_state(0, 1)).energy_drift, 1e-8);
  factor = 1.01;
  const double drift = run(model, equations, boom_state(0, 1)).energy_drift;
  EXPECT_GT(drift, 0.004);
  EXPECT_LT(drift, 0.011);
}

TEST(Simulate, declared_jumps_are_landed_on_and_undeclared_ones_reported) {
  const auto force = [](double t) { return t < 0.7 ? 1.0 : (t < 1.9 ? -1.0 : 1.0); };
  // x = t²/2 until 0.7; then the rate falls until 1.9 and rises to 3: x(3) from three parabolas.
  const double v1 = 0.7, x1 = 0.245, v2 = v1 - 1.2, x2 = x1 + v1 * 1.2 - 0.72;
  const double x3 = x2 + v2 * 1.1 + 0.605;
  Model declared = boom(), undeclared = boom();
  declared.add_load("motor", TestLoad(force, {0, 0.7, 1.9, 7}));
  undeclared.add_load("motor", TestLoad(force));
  Runner run(until(3, 0.5));
  const RunSummary good = run(declared, boom_equations(declared, spring), boom_state(0, 0.1));
  EXPECT_NEAR(good.final.y[0], x3, 1e-13) << "parabolas are exact where no step spans a jump";
  EXPECT_TRUE(good.suspected_jumps.empty());
  EXPECT_EQ(good.message, "");
  const RunSummary bad = run(undeclared, boom_equations(undeclared, spring), boom_state(0, 0.1));
  EXPECT_EQ(bad.status, RunStatus::completed);
  ASSERT_EQ(bad.suspected_jumps.size(), 2u);
  EXPECT_NEAR(bad.suspected_jumps[0], 0.7, 0.01);
  EXPECT_NEAR(bad.suspected_jumps[1], 1.9, 0.01);
  EXPECT_THAT(bad.message, HasSubstr("a load jumps without declaring it"));
}

TEST(Simulate, stiff_but_smooth_equations_raise_no_suspicion_of_jumps) {
  const Model model = boom();
  const FunctionEquations equations =
      boom_equations(model, [](double t, double q, double rate) { return -1e6 * (q - std::sin(t)) - 2e3 * rate; });
  for (const char* id : {"dopri5", "rk4-adaptive"}) {
    Runner run(until(2, 0.1), make_integrator(id, {{"rtol", Value(1e-6)}}));
    const RunSummary summary = run(model, equations, boom_state(0, 0));
    EXPECT_EQ(summary.status, RunStatus::completed);
    EXPECT_TRUE(summary.suspected_jumps.empty()) << id << ": " << summary.message;
  }
}

TEST(Simulate, a_run_of_no_length_has_one_output) {
  const Model model = boom();
  Runner run(until(0));
  EXPECT_EQ(run(model, boom_equations(model, spring), boom_state(0, 0.1)).status, RunStatus::completed);
  EXPECT_EQ(run.outputs.size(), 1u);
}

TEST(Simulate, refuses_an_end_before_the_start_and_an_interval_that_is_not_positive) {
  const Model model = boom();
  const FunctionEquations equations = boom_equations(model, spring);
  Runner backward(until(-1));
  EXPECT_THROW(backward(model, equations, boom_state(0, 0)), std::invalid_argument);
  Runner still(until(1, 0));
  EXPECT_THROW(still(model, equations, boom_state(0, 0)), std::invalid_argument);
}

TEST(Simulate, states_have_the_names_that_results_use) {
  EXPECT_EQ(name(RunStatus::completed), "completed");
  EXPECT_EQ(name(RunStatus::diverged), "diverged");
  EXPECT_EQ(name(RunStatus::singular), "singular");
  EXPECT_EQ(name(RunStatus::step_underflow), "step-underflow");
  EXPECT_EQ(name(RunStatus::interrupted), "interrupted");
  EXPECT_EQ(name(RunStatus::load_failed), "load-failed");
  EXPECT_EQ(name(RunStatus::too_stiff), "too-stiff");
}

}  // namespace
}  // namespace withy
