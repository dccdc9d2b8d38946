/// \file
/// Loops closed by controllers, as the equations of motion have them: their solutions, derivatives and linear form,
/// states that are kept, and steps that allocate nothing.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>
#include <ostream>

#include "withy/core/analysis/modes.hpp"
#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/loads/control/linear_block.hpp"
#include "withy/tests/conformance/allocations.hpp"
#include "withy/tests/loads/control_scenes.hpp"

namespace withy {
namespace {

using test::felt;
using test::felt_lag;
using test::felt_matrix;
using test::k_felt;
using test::LoadedScene;
using test::m_felt;
using test::pid_turntable;
using testing::HasSubstr;

/// e^{At} x₀ of the turntable with the controller above, states θ, ω, I, f.
Eigen::Vector4d closed_form(double t) {
  const double kp = 5, ki = 4, kd = 1, Tf = 0.05, r = 0.5;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(5, 5);  // with the reference as a fifth, constant state
  A(0, 1) = 1;
  A.row(1) << -(kp + kd / Tf) / test::turntable_inertia, 0, 1 / test::turntable_inertia,
      -kd / Tf / test::turntable_inertia, (kp + kd / Tf) * r / test::turntable_inertia;
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

/// For the name of a test.
void PrintTo(const Method& method, std::ostream* out) { *out << method.name; }

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

/// Of the shaken arm with a boom of a length [m], at a state that is the same but for that; its axle turns or is at
/// rest.
void expect_measured_as_shown(const std::string& formulation, double length, bool turns) {
  const double stiffness = 30 * std::pow(length, 4);  // the frequencies stay
  LoadedScene s(shaken_arm, {"formulation=" + formulation, fmt::format("bodies.boom.length={}", length),
                             fmt::format("bodies.boom.bending_y.stiffness={}", stiffness),
                             fmt::format("bodies.hub.frames.out.position=[{}, 0, 0]", 0.1 * length)});
  const Layout& layout = s.scene.model->layout();
  State state = s.scene.initial;
  for (std::size_t i = 0; i < layout.moving(); ++i) state.y[i] += 0.3 * std::sin(1.0 + 2.3 * static_cast<double>(i));
  if (!turns) state.y[layout.positions + s.hinge("axle").speed] = 0;
  for (const Slot& boom : layout.bodies) {
    for (std::size_t i = 0; i < boom.positions; ++i) {
      state.y[boom.position + i] *= length;
      state.y[layout.positions + boom.speed + i] *= length;
    }
  }
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
    EXPECT_NEAR(y_dot[k++], value, 1e-10 * (length + std::abs(value))) << name << ", " << formulation << ", " << length;
    EXPECT_NE(value, 0) << name;
  }
}

TEST(Control, AccelerationsThatAreMeasuredAreThoseOfTheOutputs) {
  for (const char* formulation : {"quadratic", "exact", "consistent", "symmetric", "ruthless"})
    expect_measured_as_shown(formulation, 1, true);
}

TEST(Control, AccelerationsAreMeasuredAlikeOnBeamsOfMicrometresAndOfKilometres) {
  for (const char* formulation : {"quadratic", "exact"})
    for (const double length : {1e-6, 1e-3, 1e3})
      for (const bool turns : {false, true}) expect_measured_as_shown(formulation, length, turns);
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

TEST(Control, LinearFormHasTheStatesOfTheController) {
  LoadedScene s(pid_turntable);
  const TangentDynamics dynamics(s.scene.model, s.scene.formulation->terms());
  const Tangents tangents = dynamics.tangents(0, s.scene.initial.y, Eigen::VectorXd::Zero(1));
  const FirstOrderForm form = whole_first_order_form(tangents, {false});
  Eigen::Matrix4d A;
  A << 0, 1, 0, 0, -(5 + 20) / test::turntable_inertia, 0, 1 / test::turntable_inertia, -20 / test::turntable_inertia,
      -4, 0, 0, 0, -20, 0, 0, -20;
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

/// A joint's controller may have the joint's name where nothing asks which of the two is meant: it measures the joint
/// itself, and no load measures itself.
TEST(Control, NamesOfAHingeAndALoadAreToldApartOrRefused) {
  const auto end = [](const std::string& name) {
    LoadedScene s(test::turntable + "initial: {hinges: {axle: {position: [0.5]}}}\nloads:\n  " + name +
                  ": {type: expression, hinge: axle, value: -4 * axle - 0.8 * axle.rate}\n");
    return s.position(s.run().back(), "axle");
  };
  EXPECT_EQ(end("axle"), end("servo"));
  const auto problem = [](const std::string& drive) {
    return test::problem_of(test::turntable + "loads:\n  drive: {type: " + drive +
                            "}\n  axle: {type: pid, hinge: axle, to: nothing, proportional: 4}\n");
  };
  EXPECT_EQ(problem("expression, hinge: axle, value: -axle.rate"), "");
  for (const char* drive : {"actuator, of: axle, hinge: axle, frequency: 100", "expression, hinge: axle, value: 2-axle",
                            "pid, hinge: axle, proportional: [[0, 1], [1, 2]], schedule: axle"})
    EXPECT_THAT(problem(drive), testing::HasSubstr("'axle' is a hinge and a load")) << drive;
  EXPECT_EQ(
      test::problem_of(test::turntable + "loads:\n  drive: {type: actuator, of: axle, hinge: axle, frequency: 100}\n  "
                                         "axle: {type: hinge-spring, hinge: axle, stiffness: 4}\n"),
      "")
      << "a spring gives no number that could be measured";
}

TEST(Control, DoesNotGuessWhetherALoadOrAnOutputIsMeasured) {
  const auto scene = [](const std::string& output, const std::string& measured) {
    return R"(format: withy/1
time: {end: 1}
bodies: {a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: a}}
outputs: {q: {type: hinge, hinge: h}, )" +
           output + R"(: {type: expression, value: 100 + q.position}}
loads:
  s: {type: expression, hinge: h, value: -h}
  k: {type: expression, hinge: h, value: )" +
           measured + ", sample: 0.1}\n";
  };
  EXPECT_THAT(test::problem_of(scene("s", "s")),
              HasSubstr("'s' is a load and an output, and either can be measured: give the output another name"));
  EXPECT_EQ(test::problem_of(scene("s", "h")), "") << "nothing measures either";
  EXPECT_EQ(test::problem_of(scene("far", "s + far")), "");
}

/// A sign before a name, or a difference, is no part of it.
TEST(Control, FormulasFindLoadsFurtherDownWhateverStandsBeforeTheirNames) {
  for (const char* formula : {"-servo", "axle-servo", "2*(-servo)"})
    EXPECT_EQ(test::problem_of(test::turntable + "loads:\n  copy: {type: expression, to: nothing, value: " + formula +
                               "}\n  servo: {type: pid, hinge: axle, proportional: 3}\n"),
              "")
        << formula;
}

}  // namespace
}  // namespace withy
