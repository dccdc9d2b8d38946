/// \file
/// What each kind of controller commands: against closed forms and recursions by hand, at samples, and where a scene
/// has it wrong.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "withy/core/plugin/sensor.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/tests/loads/control_scenes.hpp"
#include "withy/tests/loads/shown_outputs.hpp"

namespace withy {
namespace {

using test::felt;
using test::g_felt;
using test::k_felt;
using test::LoadedScene;
using test::m_felt;
using testing::HasSubstr;

constexpr double J = test::turntable_inertia;

/// Of a table that nothing moves: what a controller commands of itself.
const std::string alone = test::turntable + "loads: {block: {of: axle, to: nothing, ";

TEST(Control, TransferFunctionAnswersAStepAsItsClosedForm) {
  // 9/(s² + 1.2 s + 9): ω = 3, ζ = 0.2.
  LoadedScene s(alone + "type: transfer-function, reference: 1, numerator: [9], denominator: [1, 1.2, 9]}}\n");
  for (const State& state : s.run()) {
    const double zeta = 0.2, w = 3, wd = w * std::sqrt(1 - zeta * zeta), t = state.time;
    const double step = 1 - std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t));
    EXPECT_NEAR(9 * state.y[3], step, 1e-8) << t;
  }
  // By the clock the states at the samples are the same: the input is held at 1.
  LoadedScene sampled(
      alone + "type: transfer-function, sample: 0.1, reference: 1, numerator: [9], denominator: [1, 1.2, 9]}}\n");
  const State end = sampled.run().back();
  const double t = 2.1;  // the end is an instant too, at which the states are taken a sample further
  const double wd = 3 * std::sqrt(1 - 0.04);
  const std::size_t x1 = 2 + 3;  // behind its error, that it has begun, and x0
  EXPECT_NEAR(9 * end.y[x1], 1 - std::exp(-0.6 * t) * (std::cos(wd * t) + 0.6 / wd * std::sin(wd * t)), 1e-12);
}

TEST(Control, ActuatorFollowsItsCommandWithinItsLimits) {
  LoadedScene small(alone +
                        "type: actuator, frequency: 3, damping_ratio: 0.2}, law: {type: expression, to: nothing, "
                        "value: 1 + 0 * t}}\n",
                    {"loads.block.of=law", "initial.loads.block.effort=0"});
  for (const State& state : small.run()) {
    const double t = state.time, wd = 3 * std::sqrt(1 - 0.04);
    EXPECT_NEAR(state.y[2], 1 - std::exp(-0.6 * t) * (std::cos(wd * t) + 0.6 / wd * std::sin(wd * t)), 1e-8) << t;
  }
  LoadedScene limited(alone +
                          "type: actuator, frequency: 30, rate_limit: 2, limit: 1.5}, law: {type: expression, to: "
                          "nothing, value: 5 + 0 * t}}\n",
                      {"loads.block.of=law", "initial.loads.block.effort=0"});
  double before = 0, greatest = 0;
  for (const State& state : limited.run()) {
    EXPECT_LE(std::abs(state.y[2] - before), 2 * 0.01 + 1e-9);
    if (state.time > 0.3 && state.time < 0.6) {
      EXPECT_NEAR(state.y[2] - before, 2 * 0.01, 1e-6);
    }
    before = state.y[2];
    greatest = std::max(greatest, state.y[2]);
  }
  EXPECT_NEAR(before, 1.5, 1e-6);
}

// (2 s + 3)/(s + 4) of a step: 2 at once, 3/4 in the end.
TEST(Control, ATransferFunctionWithAsManyZerosAsPolesPassesItsInputOn) {
  const test::Shown s(test::turntable + R"(initial: {hinges: {axle: {position: [1]}}}
loads: {lead: {type: transfer-function, of: axle, to: nothing, numerator: [2, 3], denominator: [1, 4]}}
outputs: {seen: {type: control, of: lead, show: command}}
)");
  const std::vector<double> v = s["seen.command"];
  for (std::size_t k = 0; k < v.size(); ++k) EXPECT_NEAR(v[k], 0.75 + 1.25 * std::exp(-4 * s.times[k]), 1e-8);
}

TEST(Control, MotorRunsUpToWhereItGeneratesItsVoltage) {
  const std::string motor =
      test::turntable +
      "loads: {motor: {type: dc-motor, hinge: axle, resistance: 2, torque_constant: 0.1, gear: 5, "
      "reference: 12}}\n";
  LoadedScene s(motor);
  const double last = 12 / (5 * 0.1), time = J * 2 / (0.25);  // V/(n k), J R/(n k)²
  for (const State& state : s.run()) EXPECT_NEAR(state.y[1], last * (1 - std::exp(-state.time / time)), 1e-8);
  // With an inductance too small to matter the current is the same but for L/R.
  LoadedScene coil(motor, {"loads.motor.inductance=1e-3"});
  EXPECT_NEAR(coil.run().back().y[1], s.run().back().y[1], 1e-2);
  const State end = coil.run().back();
  EXPECT_NEAR(end.y[2], (12 - 0.5 * end.y[1]) / 2, 1e-2);
}

TEST(Control, AntiWindupKeepsTheIntegralFromRunningAway) {
  const auto overshoot = [](const std::string& way) {
    LoadedScene s(test::turntable +
                      "loads: {servo: {type: pid, hinge: axle, proportional: 2, integral: 2, derivative: 0.8, limit: "
                      "0.4, reference: 2, anti_windup: " +
                      way + "}}\n",
                  {"time.end=8"});
    double greatest = 0;
    std::vector<double> efforts(1);
    Work work = s.equations->make_work();
    for (const State& state : s.run()) {
      greatest = std::max(greatest, state.y[0] - 2);
      s.equations->load_efforts(state.time, state.y, EquationsOfMotion::all_loads, efforts, work);
      EXPECT_LE(std::abs(efforts[0]), 0.4);
    }
    return greatest;
  };
  const double none = overshoot("none"), back = overshoot("back-calculation"), clamped = overshoot("clamping");
  EXPECT_GT(none, 1.0);
  EXPECT_LT(back, 0.3 * none);
  EXPECT_LT(clamped, 0.5 * none);
}

TEST(Control, SampledPidIsItsRecursionWithTheDelay) {
  const double T = 0.05, kp = 2, ki = 3, kd = 0.4, Tf = 0.1, r = 0.5;
  LoadedScene s(test::turntable +
                    "loads: {servo: {type: pid, hinge: axle, sample: 0.05, delay: 0.1, proportional: 2, integral: 3, "
                    "derivative: 0.4, filter: 0.1, reference: 0.5}}\n",
                {"time.output=0.05"});
  double x = 0, u = 0, I = 0, f = r, held[3] = {0, 0, 0};
  std::size_t k = 0;
  for (const State& state : s.run()) {
    ASSERT_NEAR(state.y[0], x, 1e-10) << k;
    ASSERT_NEAR(state.y[1], u, 1e-10) << k;
    const double e = r - x;
    held[0] = held[1], held[1] = held[2], held[2] = kp * e + I + kd * (e - f) / Tf;
    I += T * ki * e;
    f = e + (f - e) * std::exp(-T / Tf);
    x += T * u + T * T / 2 * held[0] / J;
    u += T * held[0] / J;
    ++k;
  }
  EXPECT_EQ(k, 41U);
}

/// m a = −k x + p, p = −g a of the sample before: with p held, x is a cosine about p/k.
TEST(Control, ASampledControllerMeasuresAccelerationsWithTheEffortHeldBefore) {
  const double T = 0.01, w = std::sqrt(k_felt / m_felt);
  LoadedScene s(felt + "  servo: {type: pid, of: imu.x, to: command, proportional: 1.5, sample: 0.01}\n",
                {"integrator=dopri5", "integrator.rtol=1e-10", "integrator.atol=1e-12"});
  double x = 0.3, u = 0, p = 0;
  std::size_t k = 0;
  for (const State& state : s.run()) {
    ASSERT_NEAR(state.y[0], x, 1e-10) << k;
    ASSERT_NEAR(state.y[1], u, 1e-9) << k;
    p = -g_felt * (p - k_felt * x) / m_felt;
    const double about = p / k_felt, d = x - about;
    x = about + d * std::cos(w * T) + u / w * std::sin(w * T);
    u = -d * w * std::sin(w * T) + u * std::cos(w * T);
    ++k;
  }
  EXPECT_EQ(k, 201U);
}

// What each holds is what the tables show at the sample, of flexible bodies, inner forces and efforts of others too.
// The last stands first in the file, and measures what the one before it gives at the same instant.
TEST(Control, SampledControllersMeasureWhatOutputsShow) {
  LoadedScene s(R"(format: withy/1
time: {end: 0.39, output: 0.02}
gravity: [0, -9.81, 0]
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0], frames: {out: {position: [0.1, 0, 0]}}}
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 40, modes: 2, family: clamped-free}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.out, child: boom}
outputs:
  imu: {type: accelerometer, of: boom.tip}
  strain: {type: section, of: boom, at: 0.3}
  held: {type: reaction, hinge: root}
  pulled: {type: effort, hinge: axle, of: by_imu}
  all: {type: energy}
loads:
  last: {type: expression, value: 3 * by_imu - axle, to: nothing, sample: 0.02}
  command: {type: input, hinge: axle}
  by_imu: {type: expression, value: 0.02 * imu.y, to: command, sample: 0.02}
  by_strain: {type: expression, value: 2 * strain.mz - held.fy, to: nothing, sample: 0.02}
  by_effort: {type: expression, value: pulled + all.kinetic, to: nothing, sample: 0.02}
)");
  SensorReader reader(s.scene.outputs, *s.equations);
  const auto column = [&](const std::vector<double>& row, const std::string& name) {
    for (std::size_t i = 0; i < row.size(); ++i)
      if (reader.columns()[i].name == name) return row[i];
    ADD_FAILURE() << name;
    return 0.0;
  };
  const auto given = [&](const State& state, const std::string& load) {
    for (const LoadNode& node : s.scene.model->loads())
      if (node.name == load) return state.y[node.slot.first + 1];
    ADD_FAILURE() << load;
    return 0.0;
  };
  std::vector<double> before(reader.columns().size());
  double turn_before = 0;
  std::size_t k = 0;
  for (const State& state : s.run()) {
    if (k++ > 0) {
      ASSERT_DOUBLE_EQ(given(state, "by_imu"), 0.02 * column(before, "imu.y"));
      ASSERT_DOUBLE_EQ(given(state, "by_strain"), 2 * column(before, "strain.mz") - column(before, "held.fy"));
      ASSERT_DOUBLE_EQ(given(state, "by_effort"), column(before, "pulled") + column(before, "all.kinetic"));
      ASSERT_DOUBLE_EQ(given(state, "last"), 3 * given(state, "by_imu") - turn_before);
    }
    State seen = state;
    if (k == 1) std::fill(seen.y.begin() + 6, seen.y.end(), 0.0);  // begun already: efforts were zero before
    ASSERT_TRUE(reader.read(seen, before));
    turn_before = state.y[0];
  }
  EXPECT_EQ(k, 21U);
}

TEST(Control, AnExpressionIsTheControllerThatItSpells) {
  const std::string pd =
      "loads: {servo: {type: pd-controller, law: constant, hinges: {axle: {to: 0.5, stiffness: 5, damping: 1}}}}\n";
  LoadedScene by_formula(test::turntable +
                         "outputs: {turn: {type: gyro, of: table}, twice: {type: expression, value: 2 * turn.z}}\n"
                         "loads: {law: {type: expression, to: command, value: 5 * (0.5 - axle) - twice / 2}, "
                         "command: {type: input, hinge: axle}}\n");
  LoadedScene built_in(test::turntable + pd);
  const std::vector<State> a = by_formula.run(), b = built_in.run();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i].y[0], b[i].y[0], 1e-9);
}

TEST(Control, MistakesAreLocatedAndNamed) {
  const auto problem = [](const std::string& load, const std::string& outputs = "") {
    return test::problem_of(test::turntable + outputs + "loads:\n  command: {type: input, hinge: axle}\n  servo: {" +
                            load + "}\n");
  };
  EXPECT_THAT(problem("type: pid, of: axel, to: command, proportional: 1"),
              testing::AllOf(HasSubstr("/loads/servo/of"), HasSubstr("no signal \"axel\"; did you mean 'axle'")));
  EXPECT_THAT(problem("type: pid, of: axle, to: comand, proportional: 1"), HasSubstr("did you mean 'command'"));
  EXPECT_THAT(problem("type: pid, of: axle, to: servo, proportional: 1"),
              HasSubstr("loop servo -> servo is algebraic"));
  const std::string imu =
      "outputs: {imu: {type: accelerometer, of: table}, drive: {type: effort, hinge: axle}, of_servo: {type: effort, "
      "hinge: axle, of: servo}}\n";
  EXPECT_THAT(problem("type: pid, of: imu.y, to: command, proportional: 1", imu),
              testing::AllOf(HasSubstr("imu.y -> this load -> accelerations -> imu.y"), HasSubstr("algebraic"),
                             HasSubstr("give this load a 'sample'"), HasSubstr("put a filter between")));
  const std::string felt_outputs = "outputs: {imu: {type: accelerometer, of: table}}\n";
  EXPECT_EQ(problem("type: pid, of: imu.y, to: command, integral: 1", felt_outputs), "");
  EXPECT_EQ(problem("type: pid, of: imu.y, to: command, proportional: 1, sample: 0.01", felt_outputs), "");
  EXPECT_THAT(problem("type: pid, of: felt.y, to: command, proportional: 1, sample: 0.01",
                      "outputs: {felt: {type: effort, hinge: axle, of: command}}\n"),
              HasSubstr("/loads/servo: no signal 'felt.y'; did you mean 'felt'?"));
  EXPECT_THAT(problem("type: pid, of: imu.y, to: nothing, proportional: 1}\n  second: {type: expression, to: command, "
                      "value: 2 * servo",
                      felt_outputs),
              testing::AllOf(HasSubstr("/loads/second"), HasSubstr("servo -> this load -> accelerations -> servo"),
                             HasSubstr("an actuator that measures this load")));
  EXPECT_THAT(problem("type: pid, of: drive, to: command, proportional: 1", imu), HasSubstr("algebraic"));
  EXPECT_THAT(problem("type: pid, of: of_servo, to: command, proportional: 1", imu), HasSubstr("algebraic"));
  EXPECT_THAT(problem("type: transfer-function, of: axle, to: command, numerator: [1, 0, 0], denominator: [1, 2]"),
              testing::AllOf(HasSubstr("/loads/servo/numerator"), HasSubstr("improper")));
  EXPECT_THAT(problem("type: transfer-function, of: axle, to: command, numerator: [], denominator: []"),
              testing::AllOf(HasSubstr("/loads/servo/numerator: got an empty list"),
                             HasSubstr("/loads/servo/denominator: got an empty list")));
  EXPECT_THAT(problem("type: pid, of: axle, to: command, proportional: 1, sample: 0.01, delay: 0.004"),
              testing::AllOf(HasSubstr("/loads/servo/delay"), HasSubstr("shorter than a step")));
  EXPECT_THAT(problem("type: pid, of: axle, to: command, proportional: 1, sample: 0.01, delay: 0.015"),
              HasSubstr("no multiple"));
  EXPECT_THAT(problem("type: pid, of: axle, to: command, proportional: 1, delay: 0.01"), HasSubstr("give a 'sample'"));
  EXPECT_THAT(
      problem("type: pid, of: turn.z, to: command, derivative: 1", "outputs: {turn: {type: gyro, of: table}}\n"),
      HasSubstr("give a 'filter'"));
  EXPECT_THAT(problem("type: state-space, of: axle, to: command, A: [[1, 2]], B: [[1]], C: [[1]]"),
              HasSubstr("needs to be 1 x 1"));
  EXPECT_THAT(problem("type: expression, to: command, value: axle + nothing.there"),
              HasSubstr("no signal 'nothing.there'"));
  EXPECT_THAT(problem("type: expression, to: command, value: second, sample: 0.1}\n  second: {type: expression, to: "
                      "nothing, value: servo"),
              HasSubstr("algebraic"));
}

TEST(Control, AMisspeltNumberOfASignalIsToldWhereItStandsWithTheNearest) {
  const auto problem = [](const std::string& load) {
    return test::problem_of(test::turntable + "outputs: {turn: {type: gyro, of: table}}\nloads:\n  servo: {" + load +
                            "}\n");
  };
  EXPECT_THAT(problem("type: pid, of: turn.zz, hinge: axle, proportional: 1"),
              HasSubstr("/loads/servo/of: no signal 'turn.zz'; did you mean 'turn.z'?"));
  EXPECT_THAT(problem("type: pid, of: turn.zz, hinge: axle, proportional: 1, sample: 0.1"),
              HasSubstr("/loads/servo/of: no signal 'turn.zz'; did you mean 'turn.z'?"));
  EXPECT_THAT(problem("type: expression, hinge: axle, value: 2 * axel.rate"),
              HasSubstr("/loads/servo/value: no signal 'axel.rate'; did you mean 'axle.rate'?"));
}

TEST(Control, AMistakeInTheTreeMakesNoSignalUnknown) {
  const std::string tree =
      "format: withy/1\ntime: {end: 1}\nbodies: {table: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
      "hinges: {axle: {type: revolute, axs: [0, 0, 1], axis: [0, 0, 1], parent: world, child: table}}\n"
      "outputs: {turn: {type: gyro, of: table}}\n";
  const std::string law = "loads:\n  law: {type: pid, of: [turn.z], to: nothing, proportional: 1}\n";
  const std::string problem = test::problem_of(
      tree + law +
      "  drive: {type: actuator, of: law, hinge: axle, frequency: 10}\n  brake: {type: pid, of: axle.rate, "
      "hinge: axle, proportional: 1}\n");
  EXPECT_THAT(problem, HasSubstr("/hinges/axle/axs: unknown key"));
  EXPECT_EQ(std::count(problem.begin(), problem.end(), '\n'), 0) << problem;
  // What is misspelt is still told beside it.
  EXPECT_THAT(test::problem_of(tree + law + "  drive: {type: actuator, of: lwa, hinge: axle, frequency: 10}\n"),
              HasSubstr("/loads/drive/of: no signal \"lwa\"; did you mean 'law'?"));
}

TEST(Control, WhatRestsOnAWrongOutputOrLoadIsNotReportedBesideIt) {
  const auto problem = [](const std::string& outputs, const std::string& loads) {
    return test::problem_of(test::turntable + "outputs:\n" + outputs + "loads:\n" + loads);
  };
  const std::string chain =
      "  law: {type: pid, of: back, to: nothing, proportional: 1}\n"
      "  drive: {type: actuator, of: law, hinge: axle, frequency: 10}\n";
  const std::string formula = problem("  back: {type: expression, value: -turn.z}\n", chain);
  EXPECT_THAT(formula, HasSubstr("/outputs/back: no number 'turn.z'"));
  EXPECT_EQ(std::count(formula.begin(), formula.end(), '\n'), 0) << formula;
  const std::string law =
      problem("  shown: {type: control, of: law}\n  twice: {type: expression, value: 2 * shown.error}\n",
              "  law: {type: pid, of: axel.rate, to: nothing, proportional: 1}\n"
              "  drive: {type: actuator, of: law, hinge: axle, frequency: 10}\n");
  EXPECT_THAT(law, HasSubstr("/loads/law/of"));
  EXPECT_EQ(std::count(law.begin(), law.end(), '\n'), 0) << law;
  // A load that names one which cannot be made is not missing where an output shows it.
  const std::string plain = problem("  shown: {type: control, of: drive}\n",
                                    "  law: {type: pid, of: axle, to: nothing, proportional: 1, sample: 0}\n"
                                    "  drive: {type: actuator, of: law, hinge: axle, frequency: 10}\n");
  EXPECT_THAT(plain, HasSubstr("/loads/law/sample: got 0"));
  EXPECT_EQ(std::count(plain.begin(), plain.end(), '\n'), 0) << plain;
  // Two that rest on each other and on nothing that is wrong are not silent.
  EXPECT_THAT(problem("  shown: {type: control, of: law}\n",
                      "  law: {type: pid, of: shown.command, hinge: axle, proportional: 1}\n"),
              HasSubstr("/loads/law"));
}

TEST(Control, FormulasThatRunAwayAreNamedWhereTheyEndARun) {
  const auto message = [](const std::string& loads) {
    LoadedScene s(test::turntable + "loads:\n" + loads);
    RunOptions options;
    options.end = 2;
    const RunSummary summary =
        simulate(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options, {});
    EXPECT_EQ(summary.status, RunStatus::diverged);
    return summary.message;
  };
  EXPECT_THAT(message("  wild: {type: expression, value: 1/(axle - axle), hinge: axle}\n"),
              HasSubstr("load 'wild' gives"));
  EXPECT_THAT(message("  wild: {type: expression, value: 1e300 * exp(t), hinge: axle}\n"),
              HasSubstr("load 'wild' gives 1e+300 on axle.0"));
  // What is none from the first is refused before there is a run.
  EXPECT_THAT(
      test::problem_of(test::turntable + "loads:\n  wild: {type: expression, value: log(axle - 1), to: nothing}\n"
                                         "  drive: {type: actuator, of: wild, hinge: axle, frequency: 3}\n"),
      HasSubstr("its state 'effort' begins with no number"));
}

// Three joints of a flexible arm under its weight: the integrals take it up, the shoulder's motor has a limit.
TEST(Control, AManipulatorHoldsItsPose) {
  LoadedScene s(test::shipped("manipulator-pid.yaml"));
  const std::vector<State> all = s.run();
  EXPECT_NEAR(s.position(all.back(), "shoulder"), 0.8, 1e-2);
  EXPECT_NEAR(s.position(all.back(), "elbow"), -1.0, 1e-2);
  EXPECT_NEAR(s.position(all.back(), "wrist"), 40 * std::numbers::pi / 180, 1e-2);
  EXPECT_LT(std::abs(s.rate(all.back(), "shoulder")), 1e-2);
  const double peak = s.summary.peak_effort[s.hinge("shoulder").speed];
  EXPECT_GT(peak, 40);
  EXPECT_LE(peak, 80);
}

/// What a law commands may be a matter of its states alone, and is then found without measuring; outputs measure
/// always.
TEST(Control, WhatActsIsWhatIsShown) {
  const std::vector<std::pair<std::string, std::string>> laws = {
      {"lag", "transfer-function, of: axle.rate, numerator: [-0.5], denominator: [1, 2]"},
      {"at_once", "transfer-function, of: axle.rate, numerator: [-0.1, -0.5], denominator: [1, 2]"},
      {"space", "state-space, of: [axle, axle.rate], A: [[-1]], B: [[1, 0.5]], C: [[-0.2]]"},
      {"pid", "pid, of: axle, proportional: 1, integral: 0.5, derivative: 0.1, filter: 0.05"},
      {"drive", "actuator, of: wave, frequency: 20, limit: 0.15"},
      {"motor", "dc-motor, of: wave, resistance: 1, inductance: 0.1, torque_constant: 0.2"},
      {"no_coil", "dc-motor, of: wave, resistance: 1, torque_constant: 0.2"},
      {"low", "filter, of: axle.rate, cutoff: 2 Hz, order: 3"},
      {"late", "delay, of: axle, time: 0.1"},
      {"wheel", "reaction-wheel, of: wave, time_constant: 0.1, viscous: 0.01"},
      {"sum", "over-time, of: axle, what: integral"},
      {"formula", "expression, value: -0.2 * axle"}};
  std::string outputs = "outputs:\n",
              loads = "loads:\n  wave: {type: expression, value: 0.2 * sin(5 * t), to: nothing}\n";
  for (const auto& [name, law] : laws) {
    outputs += "  " + name + "_shown: {type: control, of: " + name + ", show: command}\n";
    loads += "  " + name + ": {type: " + law + ", hinge: axle}\n";
  }
  LoadedScene s(test::turntable + outputs + loads, {"time.output=0.1", "initial.hinges.axle.position=0.3"});
  SensorReader reader(s.scene.outputs, *s.equations);
  std::vector<double> row(reader.columns().size()), efforts(1);
  Work work = s.equations->make_work();
  for (const State& state : s.run()) {
    ASSERT_TRUE(reader.read(state, row));
    for (std::size_t i = 0; i < laws.size(); ++i) {
      s.equations->load_efforts(state.time, state.y, static_cast<int>(i + 1), efforts, work);
      EXPECT_EQ(s.scene.model->loads()[i + 1].name, laws[i].first);
      EXPECT_DOUBLE_EQ(efforts[0], row[i]) << laws[i].first << " at " << state.time;
    }
  }
}

}  // namespace
}  // namespace withy
