#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "withy/core/analysis/modes.hpp"
#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/loads/control/linear_block.hpp"
#include "withy/tests/conformance/allocations.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy {
namespace {

using test::LoadedScene;
using testing::HasSubstr;

constexpr double J = 0.2;  // of the turntable

const std::string pid_turntable =
    test::turntable +
    "loads: {servo: {type: pid, hinge: axle, proportional: 5, integral: 4, derivative: 1, "
    "filter: 0.05, reference: 0.5}}\n";

/// e^{At} x₀ of the turntable with the controller above, states θ, ω, I, f.
Eigen::Vector4d closed_form(double t) {
  const double kp = 5, ki = 4, kd = 1, Tf = 0.05, r = 0.5;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(5, 5);  // with the reference as a fifth, constant state
  A(0, 1) = 1;
  A.row(1) << -(kp + kd / Tf) / J, 0, 1 / J, -kd / Tf / J, (kp + kd / Tf) * r / J;
  A.row(2) << -ki, 0, 0, 0, ki * r;
  A.row(3) << -1 / Tf, 0, 0, -1 / Tf, r / Tf;
  Eigen::VectorXd x(5);
  x << 0, 0, 0, r, 1;
  return (matrix_exponential(A * t) * x).head(4);
}

struct Method {
  const char* name;
  const char* integrator;
  double tolerance;
};

// A mass on a spring whose accelerometer feeds a force back through a lag: m ẍ = −k x − (g/T) z, ż = −z/T + ẍ.
constexpr double m_felt = 2, k_felt = 30, g_felt = 1.5, T_felt = 0.1;
const std::string felt = R"(format: withy/1
time: {end: 2, output: 0.01}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs: {imu: {type: accelerometer, of: block}}
initial: {hinges: {slide: {position: [0.3]}}}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 30}
  command: {type: input, hinge: slide}
)";
const std::string felt_lag =
    felt + "  servo: {type: transfer-function, of: imu.x, to: command, numerator: [-1.5], denominator: [0.1, 1]}\n";

/// Of x, ẋ, z.
Eigen::Matrix3d felt_matrix() {
  Eigen::Matrix3d A;
  A << 0, 1, 0, -k_felt / m_felt, 0, -g_felt / T_felt / m_felt, 0, 0, -1 / T_felt;
  A.row(2) += A.row(1);  // ż sees ẍ
  return A;
}

class EveryIntegrator : public testing::TestWithParam<Method> {};

TEST_P(EveryIntegrator, SolvesALinearLoopToItsTolerance) {
  LoadedScene s(pid_turntable, {std::string("integrator=") + GetParam().integrator});
  ASSERT_EQ(s.scene.model->layout().continuous_names, (std::vector<std::string>{"servo.integral", "servo.filter"}));
  const std::vector<State> all = s.run();
  for (const State& state : all) {
    const Eigen::Vector4d x = closed_form(state.time);
    for (Eigen::Index i = 0; i < 4; ++i)
      ASSERT_NEAR(state.y[static_cast<std::size_t>(i)], x[i], GetParam().tolerance)
          << "element " << i << " at " << state.time;
  }
}

TEST_P(EveryIntegrator, SolvesAFeedbackOfAccelerationToItsTolerance) {
  LoadedScene s(felt_lag, {std::string("integrator=") + GetParam().integrator});
  for (const State& state : s.run()) {
    const Eigen::Vector3d x = matrix_exponential(felt_matrix() * state.time) * Eigen::Vector3d(0.3, 0, 0);
    for (Eigen::Index i = 0; i < 3; ++i)
      ASSERT_NEAR(state.y[static_cast<std::size_t>(i)], x[i], GetParam().tolerance)
          << "element " << i << " at " << state.time;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Withy, EveryIntegrator,
    testing::Values(Method{"rk4", "{name: rk4, step: 0.001}", 1e-8},
                    Method{"rk4_adaptive", "{name: rk4-adaptive, rtol: 1e-9, atol: 1e-9}", 1e-8},
                    Method{"dopri5", "{name: dopri5, rtol: 1e-9, atol: 1e-9}", 1e-8},
                    Method{"dop853", "{name: dop853, rtol: 1e-9, atol: 1e-9}", 1e-8},
                    Method{"imex", "{name: imex, rtol: 1e-9, atol: 1e-9}", 1e-8},
                    Method{"rosenbrock_w", "{name: rosenbrock-w, rtol: 1e-7, atol: 1e-7}", 1e-6},
                    Method{"radau", "{name: radau, rtol: 1e-9, atol: 1e-9}", 1e-8},
                    Method{"radau_exact", "{name: radau, rtol: 1e-9, atol: 1e-9, jacobian: exact}", 1e-8},
                    Method{"gauss", "{name: gauss, step: 0.01, jacobian: exact}", 3e-6},
                    Method{"generalized_alpha", "{name: generalized-alpha, step: 0.0005, jacobian: exact}", 1e-4}),
    [](const testing::TestParamInfo<Method>& tested) { return std::string(tested.param.name); });

/// Jacobian of the scene at a state off its start, against differences of what moves.
void expect_jacobian(const std::string& text, double tolerance) {
  LoadedScene s(text);
  const Layout& layout = s.scene.model->layout();
  const std::size_t n = layout.moving();
  State state = s.scene.initial;
  for (std::size_t i = 0; i < n; ++i) state.y[i] += 0.11 * std::sin(1.0 + 2.3 * static_cast<double>(i));
  s.equations->normalize(state.y);
  state.time = 0.31;
  Work work = s.equations->make_work();
  const auto rates = [&](const std::vector<double>& y) {
    Eigen::VectorXd all(static_cast<Eigen::Index>(layout.size()));
    EXPECT_TRUE(s.equations->derivatives(state.time, y, {all.data(), layout.size()}, work).ok());
    return Eigen::VectorXd(all.head(static_cast<Eigen::Index>(n)));
  };
  std::vector<double> y_dot(layout.size());
  ASSERT_TRUE(s.equations->derivatives(state.time, state.y, y_dot, work).ok());
  Eigen::MatrixXd exact(n, n);
  ASSERT_NE(s.equations->linearization(), nullptr);
  ASSERT_TRUE(s.equations->linearization()->jacobian(state.time, state.y, y_dot, {exact.data(), n * n}).ok());
  for (std::size_t j = 0; j < n; ++j) {
    const Eigen::VectorXd numeric = central_difference(
        [&](double h) {
          std::vector<double> moved = state.y;
          moved[j] += h;
          return rates(moved);
        },
        1e-3);
    const auto column = exact.col(static_cast<Eigen::Index>(j));
    EXPECT_LT((numeric - column).cwiseAbs().maxCoeff(), tolerance * (1 + column.cwiseAbs().maxCoeff()))
        << "column " << j;
  }
}

const std::string arm = R"(format: withy/1
gravity: [0, -9.81, 0]
formulation: quadratic
time: {end: 1, output: 0.05}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-9}
bodies:
  hub: {type: rigid, mass: 2, inertia: [0.1, 0.1, 0.2, 0, 0, 0], frames: {out: {position: [0.1, 0, 0]}}}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 30, modes: 2, family: clamped-free}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.out, child: boom}
)";

TEST(Control, JacobiansAreThoseOfTheWholeLoop) {
  expect_jacobian(pid_turntable, 1e-7);
  expect_jacobian(
      arm + "loads: {servo: {type: pid, hinge: axle, proportional: 50, integral: 30, derivative: 5, limit: 3}}\n",
      1e-7);
  expect_jacobian(arm +
                      "loads: {servo: {type: pid, hinge: axle, proportional: [[-1, 30], [1, 50]], integral: "
                      "[[-1, 10], [1, 40]], derivative: [[-1, 2], [1, 7]], filter: 0.1, schedule: axle.rate}}\n",
                  1e-7);
  for (const char* lag : {"0", "0.1"})
    expect_jacobian(arm +
                        "loads:\n  law: {type: expression, value: 20 - axle, to: nothing}\n  wheel: {type: "
                        "reaction-wheel, of: law, hinge: axle, viscous: 0.2, coulomb: 0.5, coulomb_speed: 0.3, "
                        "speed_limit: 300, time_constant: " +
                        std::string(lag) + "}\n",
                    1e-7);
  // What is measured at a frame of a flexible body, and acts at one, is differentiated numerically.
  expect_jacobian(arm + R"(outputs: {end: {type: frame, of: boom.tip, show: velocity}, turn: {type: gyro, of: boom.tip}}
loads:
  jet: {type: input, frame: boom.tip, direction: [0, 1, 0], following: true}
  command: {type: input, hinge: axle}
  damper: {type: transfer-function, of: end.vy, to: jet, numerator: [-2], denominator: [0.05, 1]}
  servo: {type: state-space, of: [axle, turn.z], to: [command], A: [[-3]], B: [[1, 0.5]], C: [[-4]], D: [[-20, -2]]}
)",
                  1e-7);
}

const std::string shaken_arm = arm + R"(outputs:
  imu: {type: accelerometer, of: boom.tip}
  end: {type: frame, of: boom.tip, show: all}
  joint: {type: hinge, hinge: axle}
loads:
  jet: {type: input, frame: boom.tip, direction: [0, 1, 0], following: true}
  servo: {type: pid, of: imu.y, to: nothing, proportional: 3, reference: 0.2}
  drive: {type: actuator, of: servo, hinge: axle, frequency: 40}
  damper: {type: transfer-function, of: imu.y, to: jet, numerator: [-0.2], denominator: [0.05, 1]}
  seen: {type: state-space, of: [imu.x, imu.y, end.ax, end.wz, joint.acceleration], to: nothing, A: [[0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0]], B: [[1, 0, 0, 0, 0], [0, 1, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 1, 0], [0, 0, 0, 0, 1]], C: [[1, 0, 0, 0, 0]]}
)";

TEST(Control, AccelerationsThatAreMeasuredAreThoseOfTheOutputs) {
  LoadedScene s(shaken_arm);
  const Layout& layout = s.scene.model->layout();
  State state = s.scene.initial;
  for (std::size_t i = 0; i < layout.moving(); ++i) state.y[i] += 0.3 * std::sin(1.0 + 2.3 * static_cast<double>(i));
  Work work = s.equations->make_work();
  std::vector<double> y_dot(layout.size());
  ASSERT_TRUE(s.equations->derivatives(0, state.y, y_dot, work).ok());
  SensorReader reader(s.scene.outputs, *s.equations);
  std::vector<double> values(reader.columns().size());
  ASSERT_TRUE(reader.read(state, values));
  const std::vector<std::string>& names = layout.continuous_names;
  const auto first = static_cast<std::size_t>(std::find(names.begin(), names.end(), "seen.x0") - names.begin());
  std::size_t k = first + layout.positions + layout.speeds;
  for (const char* name : {"imu.x", "imu.y", "end.ax", "end.wz", "joint.acceleration"}) {
    const auto column =
        std::find_if(reader.columns().begin(), reader.columns().end(), [&](const Column& c) { return c.name == name; });
    ASSERT_NE(column, reader.columns().end()) << name;
    const double value = values[static_cast<std::size_t>(column - reader.columns().begin())];
    EXPECT_NEAR(y_dot[k++], value, 1e-10 * (1 + std::abs(value))) << name;
    EXPECT_NE(value, 0) << name;
  }
}

TEST(Control, JacobiansKnowOfMeasuredAccelerations) {
  expect_jacobian(felt_lag, 1e-7);
  expect_jacobian(shaken_arm, 1e-6);
}

TEST(Control, AnActuatorBreaksTheLoopOfAnAccelerometer) {
  LoadedScene s(felt +
                "  servo: {type: pid, of: imu.x, to: nothing, proportional: 1.5}\n"
                "  drive: {type: actuator, of: servo, to: command, frequency: 30, damping_ratio: 0.8}\n");
  // x, ẋ, τ, v: v̇ = ω² (−P ẍ − τ) − 2 ζ ω v.
  Eigen::Matrix4d A;
  A << 0, 1, 0, 0, -k_felt / m_felt, 0, 1 / m_felt, 0, 0, 0, 0, 1, 0, 0, -900, -48;
  A.row(3) -= 900 * 1.5 * A.row(1);
  for (const State& state : s.run()) {
    const Eigen::Vector4d x = matrix_exponential(A * state.time) * Eigen::Vector4d(0.3, 0, 0, 0);
    for (Eigen::Index i = 0; i < 4; ++i)
      ASSERT_NEAR(state.y[static_cast<std::size_t>(i)], x[i], 1e-4) << "element " << i << " at " << state.time;
  }
}

TEST(Control, ResumesFromACheckpointBitByBit) {
  for (const char* integrator :
       {"dopri5", "{name: radau, jacobian: exact}", "{name: generalized-alpha, step: 0.01}", "imex"}) {
    LoadedScene s(pid_turntable, {std::string("integrator=") + integrator});
    const auto stepper = s.scene.integrator->start(*s.equations, s.scene.initial);
    for (int i = 0; i < 7; ++i) ASSERT_EQ(stepper->step(2).outcome, StepResult::Outcome::ok);
    const State there = stepper->state();
    const std::vector<double> memory = stepper->memory();
    while (stepper->state().time < 2) ASSERT_EQ(stepper->step(2).outcome, StepResult::Outcome::ok);
    const auto resumed = s.scene.integrator->start(*s.equations, s.scene.initial);
    resumed->resume(there, memory);
    while (resumed->state().time < 2) ASSERT_EQ(resumed->step(2).outcome, StepResult::Outcome::ok);
    EXPECT_EQ(resumed->state().y, stepper->state().y) << integrator;
  }
}

TEST(Control, StatesGoThroughStateFilesToTheBit) {
  LoadedScene s(pid_turntable);
  State state = s.run().back();
  const State read = parse_state(write_state(*s.scene.model, state), "state.json", *s.scene.model, s.scene.initial);
  EXPECT_EQ(read.y, state.y);
  LoadedScene given(pid_turntable + "initial: {hinges: {axle: {position: [0.2]}}, loads: {servo: {integral: 0.7}}}\n");
  EXPECT_EQ(given.scene.initial.y[2], 0.7);
  EXPECT_EQ(given.scene.initial.y[3], 0.5 - 0.2) << "the filter begins at the error";
  EXPECT_THAT(test::problem_of(pid_turntable + "initial: {loads: {servo: {integrl: 0.7}}}\n"),
              HasSubstr("did you mean 'integral'"));
  EXPECT_THAT(test::problem_of(pid_turntable + "initial: {loads: {srevo: {integral: 0.7}}}\n"),
              HasSubstr("did you mean 'servo'"));
}

TEST(Control, StepsAllocateNothing) {
  LoadedScene s(arm + R"(outputs: {turn: {type: gyro, of: boom.tip}, imu: {type: accelerometer, of: boom.tip}}
loads:
  servo: {type: pid, hinge: axle, proportional: 50, integral: 30, derivative: 5, limit: 3}
  damper: {type: transfer-function, of: turn.z, hinge: axle, numerator: [-2], denominator: [0.05, 1]}
  feels: {type: transfer-function, of: imu.y, hinge: axle, numerator: [-0.1], denominator: [0.05, 1]}
  law: {type: expression, value: -2*axle.rate + servo / 10, hinge: axle}
)");
  const auto stepper = s.scene.integrator->start(*s.equations, s.scene.initial);
  ASSERT_EQ(stepper->step(1).outcome, StepResult::Outcome::ok);
  const std::size_t before = allocations();
  while (stepper->state().time < 0.2) ASSERT_EQ(stepper->step(1).outcome, StepResult::Outcome::ok);
  EXPECT_EQ(allocations(), before);
}

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
  EXPECT_NEAR(9 * end.y[2 + 2], 1 - std::exp(-0.6 * t) * (std::cos(wd * t) + 0.6 / wd * std::sin(wd * t)), 1e-12);
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

TEST(Control, LinearFormHasTheStatesOfTheController) {
  LoadedScene s(pid_turntable);
  const TangentDynamics dynamics(s.scene.model, s.scene.formulation->terms());
  const Tangents tangents = dynamics.tangents(0, s.scene.initial.y, Eigen::VectorXd::Zero(1));
  const FirstOrderForm form = whole_first_order_form(tangents, {false});
  Eigen::Matrix4d A;
  A << 0, 1, 0, 0, -(5 + 20) / J, 0, 1 / J, -20 / J, -4, 0, 0, 0, -20, 0, 0, -20;
  EXPECT_LT((form.A - A).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_TRUE(tangents.differenced.empty());
}

TEST(Control, LinearFormSeesMeasuredAccelerations) {
  LoadedScene s(felt_lag);
  const TangentDynamics dynamics(s.scene.model, s.scene.formulation->terms());
  const Tangents tangents =
      dynamics.tangents(0, s.scene.initial.y, Eigen::VectorXd::Constant(1, -0.3 * k_felt / m_felt));
  const FirstOrderForm form = whole_first_order_form(tangents, {false});
  EXPECT_LT((form.A - felt_matrix()).cwiseAbs().maxCoeff(), 1e-9);
  // An effort moves the filter's state at once.
  EXPECT_LT((form.B - Eigen::Vector3d(0, 1 / m_felt, 1 / m_felt)).cwiseAbs().maxCoeff(), 1e-9);
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
      "load: servo}}\n";
  EXPECT_THAT(problem("type: pid, of: imu.y, to: command, proportional: 1", imu),
              testing::AllOf(HasSubstr("imu.y -> this load -> accelerations -> imu.y"), HasSubstr("algebraic"),
                             HasSubstr("give this load a 'sample'"), HasSubstr("put a filter between")));
  const std::string felt_outputs = "outputs: {imu: {type: accelerometer, of: table}}\n";
  EXPECT_EQ(problem("type: pid, of: imu.y, to: command, integral: 1", felt_outputs), "");
  EXPECT_EQ(problem("type: pid, of: imu.y, to: command, proportional: 1, sample: 0.01", felt_outputs), "");
  EXPECT_THAT(problem("type: pid, of: felt.y, to: command, proportional: 1, sample: 0.01",
                      "outputs: {felt: {type: effort, hinge: axle, of: command}}\n"),
              HasSubstr("/loads/servo: no signal 'felt.y'; known: axle, axle.rate, felt, servo"));
  EXPECT_THAT(problem("type: pid, of: imu.y, to: nothing, proportional: 1}\n  second: {type: expression, to: command, "
                      "value: 2 * servo",
                      felt_outputs),
              testing::AllOf(HasSubstr("/loads/second"), HasSubstr("servo -> this load -> accelerations -> servo"),
                             HasSubstr("an actuator that measures this load")));
  EXPECT_THAT(problem("type: pid, of: drive, to: command, proportional: 1", imu), HasSubstr("algebraic"));
  EXPECT_THAT(problem("type: pid, of: of_servo, to: command, proportional: 1", imu), HasSubstr("algebraic"));
  EXPECT_THAT(problem("type: transfer-function, of: axle, to: command, numerator: [1, 0, 0], denominator: [1, 2]"),
              testing::AllOf(HasSubstr("/loads/servo/numerator"), HasSubstr("improper")));
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

}  // namespace
}  // namespace withy
