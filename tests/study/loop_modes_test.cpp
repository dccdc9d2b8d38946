// Modes and steady states of bodies together with controllers that have states of their own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "withy/study/effective_mass.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/frequencies.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/response.hpp"
#include "withy/study/run.hpp"
#include "withy/study/variation_text.hpp"
#include "withy/tests/study/linear_scenes.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;

/// A table of 0.2 kg m² that a controller turns to half a radian.
const std::string servo_table = R"(
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads: {servo: {type: pid, hinge: axle, proportional: 5, integral: 4, derivative: 1, filter: 0.05, reference: 0.5}}
)";

/// A cantilever in gravity whose root a controller with an integral holds.
const std::string servo_beam = R"(
gravity: [0, 0, -9.81]
bodies:
  beam: {type: beam, length: 2, mass_per_length: 1, damping_ratio: 0.02, bending_z: {stiffness: 200, modes: 3}}
hinges: {root: {type: revolute, axis: [0, 1, 0], parent: world, child: beam}}
loads: {servo: {type: pid, hinge: root, proportional: 300, integral: 200, derivative: 60, filter: 0.02, reference: 0.3}}
)";

/// Every eigenvalue, those with negative imaginary parts too.
std::vector<std::complex<double>> eigenvalues(const std::vector<Mode>& modes) {
  std::vector<std::complex<double>> all;
  for (const Mode& m : modes) {
    all.push_back(m.eigenvalue);
    if (!m.single) all.push_back(m.partner);
  }
  return all;
}

/// That each number of one list is one of the other, to a share of the greatest.
void expect_same(std::vector<std::complex<double>> found, const Eigen::VectorXcd& expected, double share) {
  ASSERT_EQ(static_cast<Eigen::Index>(found.size()), expected.size());
  for (const std::complex<double>& e : expected) {
    const auto nearest =
        std::min_element(found.begin(), found.end(), [&](auto a, auto b) { return std::abs(a - e) < std::abs(b - e); });
    EXPECT_LE(std::abs(*nearest - e), share * expected.cwiseAbs().maxCoeff()) << e;
    found.erase(nearest);
  }
}

/// The hand-derived loop of θ, ω, integral I and filter f: J ω̇ = −(k_p + k_d/T) θ + I − k_d/T f, İ = −k_i θ,
/// T ḟ = −θ − f.
Eigen::VectorXcd of_table(double kd) {
  constexpr double J = 0.2, kp = 5, ki = 4, T = 0.05;
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A(0, 1) = 1;
  A.row(1) << -(kp + kd / T) / J, 0, 1 / J, -kd / T / J;
  A(2, 0) = -ki;
  A.row(3) << -1 / T, 0, 0, -1 / T;
  return A.eigenvalues();
}

TEST(LoopModes, AreTheEigenvaluesOfTheLoopByHand) {
  const ModesAt at = modes_at(at_start(scene_of(servo_table)), false);
  ASSERT_EQ(at.problem, "");
  EXPECT_EQ(at.names, (std::vector<std::string>{"axle.0", "servo.integral", "servo.filter"}));
  expect_same(eigenvalues(at.modes), of_table(1), 1e-12);
  // A slow real one, the integral's; the filter of 20 rad/s and the table share a pair.
  EXPECT_EQ(dominating(at, at.modes[0]), "servo.integral");
  EXPECT_EQ(behaviour(at, at.modes[0]), "decays");
  EXPECT_TRUE(at.modes[0].single);
  for (const Mode& m : at.modes) EXPECT_EQ(m.shape[m.dominant], 1.0);
}

TEST(LoopModes, OfMeasuredAccelerationsAreTheEigenvaluesOfTheLoopByHand) {
  // m ẍ = −k x − (g/T) z, ż = −z/T + ẍ.
  const Prepared felt = scene_of(R"(
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs: {imu: {type: accelerometer, of: block}}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 30}
  command: {type: input, hinge: slide}
  servo: {type: transfer-function, of: imu.x, to: command, numerator: [-1.5], denominator: [0.1, 1]}
)");
  Eigen::Matrix3d A;
  A << 0, 1, 0, -15, 0, -7.5, 0, 0, -10;
  A.row(2) += A.row(1);
  expect_same(eigenvalues(modes_at(at_start(felt), false).modes), A.eigenvalues(), 1e-9);
}

/// A fast filter follows a slow one, a thousand times as large: the slow pole is the slow filter's although the other
/// moves most in it.
TEST(LoopModes, BearTheNameOfWhatTakesPartAndNotOfWhatMovesMost) {
  const ModesAt at = modes_at(at_start(scene_of(R"(
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads:
  spring: {type: hinge-spring, hinge: axle, stiffness: 20}
  slow: {type: transfer-function, of: axle, to: nothing, numerator: [1], denominator: [1, 1]}
  fast: {type: state-space, of: slow, to: nothing, A: [[-10]], B: [[10000]], C: [[1]]}
)")),
                              true);
  const auto name_at = [&](double pole) {
    for (const Mode& m : at.modes)
      if (std::abs(m.eigenvalue - pole) < 1e-9) return dominating(at, m);
    return std::string("none");
  };
  EXPECT_EQ(name_at(-1), "slow.x0");
  EXPECT_EQ(name_at(-10), "fast.x0");
}

/// The poles of the linear model come from the same derivatives by another algorithm, without vectors.
TEST(LoopModes, AreThePolesOfTheLinearModelInEveryFormulation) {
  for (const std::string formulation : {"ruthless", "consistent", "symmetric", "quadratic", "exact"}) {
    SceneValues values = scene("manipulator-pid");
    values.set_text("formulation=" + formulation);
    const Prepared prepared = prepare(std::move(values), plugins());
    Configuration steady = at_start(prepared);
    const ModesAt at = modes_at(steady, false);
    ASSERT_EQ(at.problem, "");
    steady.set_state(at.steady->steady.state);
    const LinearModel linear = linear_model(steady, {});
    EXPECT_TRUE(linear.equilibrium);
    expect_same(eigenvalues(at.modes), poles(linear.system), 1e-11);
  }
}

/// A free satellite keeps its rigid motions, and the integral of nothing that is held is one too.
TEST(LoopModes, KeepRigidMotionsAndIntegratorsAtZero) {
  const Prepared prepared = scene_of(R"(
bodies:
  bus: {type: rigid, mass: 4, inertia: [3, 4, 5, 0, 0, 0]}
  panel: {type: beam, length: 3, mass_per_length: 0.5, bending_y: {stiffness: 20, modes: 2}}
hinges:
  float: {type: free, parent: world, child: bus}
  drive: {type: revolute, axis: [0, 0, 1], parent: bus, child: panel}
loads:
  sum: {type: transfer-function, of: drive.rate, to: nothing, numerator: [1], denominator: [1, 0]}
  hold: {type: pid, hinge: drive, proportional: 4, derivative: 2, filter: 0.1}
)");
  const ModesAt at = modes_at(at_start(prepared), true);
  std::size_t rigid = 0, pairs = 0;
  for (const Mode& m : at.modes) {
    rigid += m.rigid ? 1 : 0;
    pairs += m.rigid && !m.single ? 1 : 0;
  }
  EXPECT_EQ(pairs, 6U) << "of the free bus";
  EXPECT_EQ(rigid, 7U) << "and the sum";
  for (const Mode& m : at.modes) EXPECT_LE(resolved_growth(at, m), 0);
}

/// A pair that becomes two real eigenvalues goes on as one of them; the other begins. Nothing is lost at any value.
TEST(LoopModes, KeepTheirBranchesWherePairsPart) {
  const Sweep sweep = parse_sweep("loads.servo.derivative=0.05:8:600", "sweep");
  const Prepared prepared = scene_of(servo_table);
  const ModesOf run = sweep_modes(prepared.values, plugins(), {}, {}, sweep, false, {}, {});
  std::size_t least = 9, most = 0;
  for (const ModesAt& at : run.points) {
    ASSERT_EQ(at.problem, "");
    expect_same(eigenvalues(at.modes), of_table(at.value), 1e-11);
    least = std::min(least, at.modes.size()), most = std::max(most, at.modes.size());
    EXPECT_TRUE(std::is_sorted(at.branches.begin(), at.branches.end()));
    EXPECT_EQ(std::adjacent_find(at.branches.begin(), at.branches.end()), at.branches.end());
  }
  EXPECT_EQ(least, 2U);
  EXPECT_EQ(most, 3U);
  // Branches go on without jumps: between neighbours none moves by a third of its modulus.
  for (std::size_t branch = 0; branch < run.branches(); ++branch) {
    for (std::size_t k = 1; k < run.points.size(); ++k) {
      const Mode *before = run.points[k - 1].on(branch), *now = run.points[k].on(branch);
      if (before == nullptr || now == nullptr) continue;
      EXPECT_LT(std::abs(now->frequency() - before->frequency()), before->frequency() / 3) << branch << ' ' << k;
    }
  }
}

/// An integral takes the error away: the hinge is where it is to be, the integral is what a locked hinge needs, and the
/// beam is bent as on that.
TEST(LoopEquilibrium, OfAnIntegralIsThatOfALockedHinge) {
  const Configuration loop = at_start(scene_of(servo_beam));
  const Equilibrium found = find_equilibrium(loop, {}, plugins());
  ASSERT_EQ(found.problem, "");
  const Prepared locked = scene_of(servo_beam, {"loads={}", "initial={hinges: {root: {position: [0.3]}}}"});
  const Configuration at_reference(locked, locked.scene.initial, {{"root"}, {}});
  const Equilibrium held = find_equilibrium(at_reference, {{"root"}, {}}, plugins());
  ASSERT_EQ(held.problem, "");
  const Layout& layout = loop.layout();
  for (std::size_t i = 0; i < layout.positions; ++i)
    EXPECT_NEAR(found.steady.state.y[i], held.steady.state.y[i], 1e-12) << i;
  const double integral = found.steady.state.y[layout.positions + layout.speeds];
  EXPECT_NEAR(integral, held.steady.efforts[0], 1e-10 * std::abs(integral));
  EXPECT_GT(std::abs(integral), 10);
}

/// A turbine whose generator measures the rate of a shaft that turns freely: coordinates grow, what is measured stays.
/// What does not turn sees Floquet's exponents, and the loops by their own names.
TEST(LoopModes, OfATurbineAreThoseOfAWholeTurn) {
  SceneValues values = scene("gallery/turbine-control");
  for (const char* change :
       {"gravity=null", "loads.gust=null", "loads.rotor.value=4.0e6 - 2.0e6 * (shaft.rate - 1.2)", "loads.noisy=null",
        "loads.read=null", "loads.torque.of=speed", "loads.torque.sample=null"})
    values.set_text(change);
  const Prepared prepared = prepare(std::move(values), plugins());
  TurningWish wish;
  wish.floquet = wish.blades = true;
  const ModesAt at = modes_at(at_start(prepared), false, wish);
  ASSERT_EQ(at.problem, "");
  ASSERT_TRUE(at.turn && at.turn->floquet && at.turn->blades) << at.turn->problem;
  EXPECT_LT(at.turn->blades->change, 1e-9) << "of the accelerometer's loop derivatives are known to ten digits";
  const double rate = 1.2;
  std::vector<std::string> names;
  for (const NamedMode& mode : at.turn->blades->modes) {
    double nearest = 1;
    for (const NamedMode& other : at.turn->floquet->modes) {
      // A mode of the whole turn says its frequency but for whole turns, and its sign.
      for (const double sign : {-1.0, 1.0}) {
        const double turns = (mode.exponent.imag() - sign * other.exponent.imag()) / rate;
        nearest = std::min(
            nearest, std::hypot(mode.exponent.real() - other.exponent.real(), rate * (turns - std::round(turns))));
      }
    }
    EXPECT_LT(nearest, 1e-6) << mode.dominated_by;
    names.push_back(mode.dominated_by);
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"shaft.0", "sway.x0", "speed.x1", "tower.bending_z[1]",
                                            "blade1.bending_z[1] backward", "blade1.bending_z[1] forward"}));
}

/// A newton metre of the integral is nothing beside the vibrations, and is found all the same.
TEST(LoopEquilibrium, IsFoundWhateverTheSizesAre) {
  const Configuration c = at_start(scene_of(heavy_hub));
  const Equilibrium found = find_equilibrium(c, {}, plugins());
  ASSERT_EQ(found.problem, "");
  const double integral = found.steady.state.y[c.layout().positions + c.layout().speeds];
  EXPECT_NEAR(std::abs(integral), 9.81 * 2 * 1, 1e-6);
}

/// What time integration comes to, which knows nothing of Newton's method.
TEST(LoopEquilibrium, IsWhereTheMotionSettles) {
  const Prepared prepared =
      scene_of(servo_beam, {"time.end=40", "integrator={name: radau, rtol: 1e-9, atol: 1e-10}", "formulation=exact"});
  const Equilibrium found = find_equilibrium(at_start(prepared), {}, plugins());
  ASSERT_EQ(found.problem, "");
  State last;
  simulate(prepared, plugins(), [&](const State& state) { last = state; }, {});
  const Layout& layout = prepared.model().layout();
  for (std::size_t i = 0; i < layout.moving(); ++i)
    EXPECT_NEAR(last.y[i], found.steady.state.y[i], 1e-6 * (1 + std::abs(last.y[i]))) << i;
}

TEST(LoopEquilibrium, SaysWhichStateGoesOnChanging) {
  const Prepared prepared = scene_of(servo_beam);
  const Configuration locked(prepared, prepared.scene.initial, {{"root"}, {}});
  const Equilibrium found = find_equilibrium(locked, {{"root"}, {}}, plugins());
  // 200 N m/(rad s) times 0.3 rad.
  EXPECT_THAT(found.problem, HasSubstr("servo.integral changes by 60 a second"));
}

/// The gain at which the loop of the wrist is on the verge, found by opening it: a mode grows just beyond it, at the
/// frequency where the answer returns in phase, and decays just below.
TEST(LoopModes, GrowBeyondTheMarginsOfTheLoop) {
  const auto with_gain = [](double factor) {
    SceneValues values = scene("manipulator-pid");
    const std::vector<std::pair<std::string, double>> gains = {
        {"proportional", 4}, {"integral", 12}, {"derivative", 0.3}};
    for (const auto& [name, gain] : gains) values.set("loads.hold_wrist." + name, Value(factor * gain), "the test");
    return prepare(std::move(values), plugins());
  };
  Configuration steady = at_start(with_gain(1));
  steady.set_state(find_equilibrium(steady, {}, plugins()).steady.state);
  const Response opened = response(steady, {"wrist_drive", "", {}, {}, 50, {}});
  ASSERT_TRUE(opened.margins && opened.margins->upper() != nullptr);
  EXPECT_EQ(opened.margins->lower(), nullptr);
  const GainMargin& margin = *opened.margins->upper();
  EXPECT_GT(margin.factor, 3);
  for (const int beyond : {-1, 1}) {
    const ModesAt at = modes_at(at_start(with_gain(margin.factor * (1 + beyond * 1e-5))), false);
    ASSERT_EQ(at.problem, "");
    const Mode& most = *std::max_element(at.modes.begin(), at.modes.end(),
                                         [](const Mode& a, const Mode& b) { return a.growth() < b.growth(); });
    EXPECT_GT(beyond * most.growth(), 0);
    EXPECT_NEAR(most.frequency(), margin.omega, 1e-4 * margin.omega);
  }
}

/// Newton's method finds no way where a limit hides what a controller would do.
TEST(LoopEquilibrium, SaysWhatIsAtALimit) {
  const Prepared prepared = scene_of(servo_table, {"loads.servo.limit=1"});
  const Equilibrium found = find_equilibrium(at_start(prepared), {}, plugins());
  EXPECT_THAT(found.problem, HasSubstr("'servo' is at a limit there"));
}

/// What knows of bodies alone says so.
TEST(LoopModes, AreRefusedWhereBodiesAloneAreMeant) {
  const Prepared prepared = scene_of(servo_beam);
  EXPECT_THROW((void)effective_masses(at_start(prepared)), InputError);
  FrequencyQuestion question{{{}}, parse_sweep("loads.servo.derivative=50:60:2", "over"), {}};
  EXPECT_THROW(FrequencyStudy(prepared, plugins(), question), InputError);
}

}  // namespace
}  // namespace withy::study
