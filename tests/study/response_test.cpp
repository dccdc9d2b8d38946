// Linear models with inputs and sensors, transfer functions and margins, against closed forms and simulation.
#include "withy/study/response.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "withy/study/effective_mass.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/open_loop.hpp"
#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using std::numbers::pi;
using test::plugins;

constexpr double beta = 1.8751040687119611;  // first root of 1 + cos β cosh β

Prepared scene_of(const std::string& text, const std::vector<std::string>& changes = {}) {
  SceneValues values = SceneValues::parse("format: withy/1\ntime: {end: 1}\n" + text, "text");
  for (const std::string& change : changes) values.set_text(change);
  return prepare(std::move(values), plugins());
}

Configuration at_start(const Prepared& prepared) { return {prepared, prepared.scene.initial, {}, Sampling::kept}; }

/// Index of a name among columns.
Eigen::Index find(const std::vector<Column>& columns, const std::string& name) {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == name) return static_cast<Eigen::Index>(i);
  ADD_FAILURE() << "no " << name;
  return 0;
}

const std::string free_body = R"(
bodies: {bus: {type: rigid, mass: 4, inertia: [3, 3, 5, 0, 0, 0], frames: {arm: {position: [0.5, 0, 0]}}}}
hinges: {float: {type: free, parent: world, child: bus}}
loads:
  push: {type: input, frame: bus.arm, direction: [0, 2, 0]}
  turn: {type: input, frame: bus, direction: [0, 0, 1], acts: torque}
outputs:
  box: {type: accelerometer, of: bus.arm}
  rate: {type: gyro, of: bus}
  place: {type: frame, of: bus, show: position}
)";

TEST(LinearModel, OfAFreeBodyHasWhatForcesDoToAccelerometers) {
  const LinearModel m = linear_model(at_start(scene_of(free_body)), {});
  ASSERT_EQ(m.inputs.size(), 2U) << "the scene's inputs are the default";
  EXPECT_EQ(m.inputs[0].unit, "N");
  EXPECT_EQ(m.inputs[1].unit, "N m");
  const auto D = [&](const std::string& output, Eigen::Index input) {
    return m.system.D(find(m.outputs, output), input);
  };
  // 1/m + r²/I of a push beside the centre of mass, r/I of a turn.
  EXPECT_NEAR(D("box.y", 0), 1.0 / 4 + 0.25 / 5, 1e-12);
  EXPECT_NEAR(D("box.x", 0), 0, 1e-12);
  EXPECT_NEAR(D("box.y", 1), 0.5 / 5, 1e-12);
  EXPECT_EQ(D("rate.z", 1), 0) << "a rate has no jump";
  // Rates follow through the states: C B is what the rate begins with.
  EXPECT_NEAR((m.system.C * m.system.B)(find(m.outputs, "rate.z"), 1), 1.0 / 5, 1e-10);
}

TEST(Response, KnowsOfAccelerationsThatAreFedBack) {
  constexpr double m = 2, k = 30, g = 1.5, T = 0.1;
  const Prepared prepared = scene_of(R"(
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs: {imu: {type: accelerometer, of: block}}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 30}
  command: {type: input, hinge: slide}
  servo: {type: transfer-function, of: imu.x, to: command, numerator: [-1.5], denominator: [0.1, 1]}
)");
  // m s² x + k x = F − g s² x/(T s + 1)
  const Response closed = response(at_start(prepared), {"command", "imu.x", 0.1, 10, 20, {}});
  const Response opened = response(at_start(prepared), {"servo", "", 0.1, 10, 20, {}});
  EXPECT_TRUE(opened.opened);
  for (std::size_t i = 0; i < closed.values.size(); ++i) {
    const std::complex<double> s(0, closed.values[i].omega), lag = g * s * s / (T * s + 1.0);
    const std::complex<double> G = s * s / (m * s * s + k + lag);
    EXPECT_LT(std::abs(closed.values[i].value - G), 1e-7 * std::abs(G));
  }
  for (const ResponseAt& at : opened.values) {
    const std::complex<double> s(0, at.omega), L = g * s * s / (T * s + 1.0) / (m * s * s + k);
    EXPECT_LT(std::abs(std::abs(at.value) - std::abs(L)), 1e-7 * std::abs(L));
  }
}

TEST(LinearModel, AccelerationsOfHingesAreRowsOfTheExactMatrices) {
  // Spinning, bent and swinging, with friction that saturates within a thousandth of a radian a second.
  const Prepared arm = prepare(
      [] {
        SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/pd-arm.yaml");
        values.set_text("outputs={a: {type: hinge, hinge: elbow}, b: {type: hinge, hinge: shoulder}}");
        return values;
      }(),
      plugins());
  State state = arm.scene.initial;
  for (std::size_t i = 0; i < arm.model().layout().speeds; ++i) {
    state.y[i] += 0.01 * static_cast<double>(i % 3);
    state.y[arm.model().layout().positions + i] = 0.02 * static_cast<double>(i % 4);
  }
  const LinearModel m = linear_model({arm, state, {}}, {{"shoulder", "elbow"}, {}});
  for (const std::string hinge : {"elbow", "shoulder"}) {
    const Eigen::Index row = find(m.outputs, std::string(hinge == "elbow" ? "a" : "b") + ".acceleration");
    Eigen::Index rate = 0;
    while (m.states[static_cast<std::size_t>(rate)] != hinge + ".0.rate") ++rate;
    const double greatest = m.system.A.row(rate).cwiseAbs().maxCoeff();
    EXPECT_LT((m.system.C.row(row) - m.system.A.row(rate)).cwiseAbs().maxCoeff(), 1e-8 * greatest) << hinge;
    EXPECT_LT((m.system.D.row(row) - m.system.B.row(rate)).cwiseAbs().maxCoeff(),
              1e-10 * m.system.B.row(rate).cwiseAbs().maxCoeff());
  }
}

/// One clamped-free mode on a hinge: J = 1/3, coupling ∫xφ = 2/β², modal mass 1, stiffness β⁴.
const std::string hinged_beam = R"(
bodies: {boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 1, modes: 1, family: clamped-free}}}
hinges: {root: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
outputs: {turn: {type: hinge, hinge: root}, load: {type: section, of: boom, at: 0}}
)";

TEST(Response, OfAHingedBeamIsTheClosedForm) {
  const double coupling = 2 / (beta * beta), J = 1.0 / 3, clamped = beta * beta;
  const Prepared prepared = scene_of(hinged_beam);
  const LinearModel m = linear_model(at_start(prepared), {{"root"}, {}});
  EXPECT_NEAR(m.system.D(find(m.outputs, "turn.acceleration"), 0), 1 / (J - coupling * coupling), 1e-6);
  EXPECT_NEAR(m.system.D(find(m.outputs, "load.mz"), 0), 1, 1e-9) << "what is put on the hinge goes into the beam";

  const Response r = response(at_start(prepared), {"root", "turn.position", {}, {}, 20, {}});
  // θ/τ = (s² + ω_c²) / (J s² (…)): the zero is the frequency with the hinge locked.
  ASSERT_EQ(r.roots.zeros.size(), 2);
  EXPECT_NEAR(std::abs(r.roots.zeros[0].imag()), clamped, 1e-6);
  const double free = clamped / std::sqrt(1 - coupling * coupling / J);
  double fastest = 0;
  for (const auto pole : r.roots.poles) fastest = std::max(fastest, std::abs(pole));
  EXPECT_NEAR(fastest, free, 1e-6 * free);
  EXPECT_EQ(r.integrators, 2);
  EXPECT_NEAR(r.static_gain, 1 / J, 1e-6) << "slowly it is a rigid body";
  ASSERT_EQ(r.peaks.size(), 1U);
  EXPECT_FALSE(r.peaks[0].height) << "nothing damps it";
  for (const ResponseAt& at : r.values) {
    const double w2 = at.omega * at.omega;
    const double exact = (clamped * clamped - w2) / (-w2 * (J * (clamped * clamped - w2) + coupling * coupling * w2));
    // Beside the pole what rounding leaves of its place is seen.
    const double beside = 1e-9 / std::min(std::abs(at.omega / free - 1), std::abs(at.omega / clamped - 1));
    EXPECT_NEAR(std::abs(at.value - exact), 0, (1e-7 + beside) * std::abs(exact)) << at.omega;
  }
}

TEST(Response, WhatCannotBeAskedIsSaid) {
  const Prepared prepared = scene_of(free_body);
  const auto ask = [&](const std::string& input, const std::string& output) {
    return response(at_start(prepared), {input, output, {}, {}, 10, {}});
  };
  EXPECT_THROW(ask("push", "box"), OptionError) << "three components";
  EXPECT_THROW(ask("pusch", "box.y"), InputError);
  EXPECT_THROW(ask("push", "boxx.y"), InputError);
  EXPECT_THROW(ask("push", ""), InputError);
  EXPECT_THROW(ask("turn", "place.z"), std::domain_error) << "a turn in the plane lifts nothing";
}

/// A wheel of inertia J behind a controller of one hinge.
std::string servo(const std::string& gains) {
  return R"(
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
loads: {control: {type: pd-controller, law: constant, )" +
         gains + "}}\n";
}

TEST(Loop, OfAControllerOnAWheelHasTheTextbooksMargins) {
  const Response r = response(at_start(scene_of(servo("hinges: {axle: {stiffness: 8, damping: 4}}"))),
                              {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins && r.opened);
  EXPECT_TRUE(r.margins->stable);
  EXPECT_EQ(r.margins->upper(), nullptr);
  EXPECT_EQ(r.margins->lower(), nullptr);
  // L = (8 + 4 s)/(2 s²): |L| = 1 at ω⁴ = 4 ω² + 16, phase margin atan(ω/2).
  const double omega = std::sqrt(2 + std::sqrt(20.0));
  ASSERT_EQ(r.margins->phases.size(), 1U);
  EXPECT_NEAR(r.margins->phase()->omega, omega, 1e-9);
  EXPECT_NEAR(r.margins->phase()->angle, std::atan(omega / 2), 1e-9);
}

TEST(Loop, OfASampledDamperIsUnstableAtTwiceTheInertiaOverTheDamping) {
  const Response r = response(at_start(scene_of(servo("sample: 0.05, hinges: {axle: {stiffness: 0, damping: 4}}"))),
                              {"control", "", {}, {}, 50, {}});
  ASSERT_TRUE(r.margins && r.margins->upper() != nullptr);
  EXPECT_NEAR(r.margins->upper()->factor, 2 * 2 / (4 * 0.05), 1e-9);
  EXPECT_NEAR(r.margins->upper()->omega, pi / 0.05, 1e-9);
  // L = c T / (J (z − 1)) has the pole 1 and no zero.
  EXPECT_EQ(r.roots.poles.size(), 1);
}

/// Two wheels on one axis are linear; their controllers sample every 20 and every 30 ms.
TEST(LinearModel, OfLoadsSampledAtTwoRatesIsTheMapOfARunOverTheirCommonPeriod) {
  const std::string text = R"(
time: {end: 0.6}
integrator: {name: dopri5, rtol: 1e-12, atol: 1e-14}
bodies:
  inner: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}
  outer: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  base: {type: revolute, axis: [0, 0, 1], parent: world, child: inner}
  joint: {type: revolute, axis: [0, 0, 1], parent: inner, child: outer}
loads:
  slow: {type: pd-controller, law: constant, sample: 0.03, hinges: {base: {stiffness: 30, damping: 10}}}
  fast: {type: pd-controller, law: constant, sample: 0.02, hinges: {joint: {stiffness: 20, damping: 5}}}
initial: {hinges: {base: {position: [0.1], rate: [0.5]}, joint: {position: [-0.3]}}}
)";
  const Prepared prepared = prepare(SceneValues::parse("format: withy/1\n" + text, "text"), plugins());
  const LinearModel m = linear_model(at_start(prepared), {{"base"}, {"base", "joint"}});
  EXPECT_DOUBLE_EQ(m.system.period, 0.06);
  EXPECT_EQ(m.states.back(), "fast.held[0]");
  Eigen::VectorXd z = Eigen::VectorXd::Zero(m.system.A.rows());
  z.head(4) << 0.1, -0.3, 0.5, 0;
  for (int k = 0; k < 10; ++k) z = m.system.A * z;
  const RunSummary run = simulate(prepared, plugins(), {});
  ASSERT_EQ(run.status, RunStatus::completed);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(run.final.y[i], z[static_cast<Eigen::Index>(i)], 1e-10) << i;
  EXPECT_THROW(static_cast<void>(open_loop(at_start(prepared), "fast")), InputError)
      << "the slowest alone can be opened";
}

/// The second measures an acceleration which the efforts of both move, and what the first gives at the same instant.
TEST(LinearModel, OfLoadsThatSampleAccelerationsIsTheMapOfARun) {
  const std::string text = R"(
time: {end: 0.6}
integrator: {name: dopri5, rtol: 1e-12, atol: 1e-14}
bodies: {cart: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}}
outputs: {imu: {type: accelerometer, of: cart}}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 30}
  slow: {type: expression, hinge: slide, value: -5 * slide.rate - 0.3 * imu.x, sample: 0.03}
  fast: {type: transfer-function, hinge: slide, of: both, numerator: [0.02, 0.8], denominator: [0.05, 1], sample: 0.02}
  both: {type: expression, value: imu.x + 0.1 * slow, to: nothing, sample: 0.02}
initial: {hinges: {slide: {position: [0.1], rate: [0.5]}}}
)";
  const Prepared prepared = prepare(SceneValues::parse("format: withy/1\n" + text, "text"), plugins());
  State rest = prepared.scene.initial;
  std::fill(rest.y.begin(), rest.y.end(), 0.0);
  const LinearModel m = linear_model({prepared, rest, {}, Sampling::kept}, {{"slide"}, {"slide"}});
  EXPECT_DOUBLE_EQ(m.system.period, 0.06);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(m.system.A.rows());
  z.head(2) << 0.1, 0.5;
  for (int k = 0; k < 10; ++k) z = m.system.A * z;
  const RunSummary run = simulate(prepared, plugins(), {});
  ASSERT_EQ(run.status, RunStatus::completed);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(run.final.y[i], z[static_cast<Eigen::Index>(i)], 1e-9) << i;
}

using Gains = std::vector<std::pair<std::string, double>>;

/// Greatest |coordinate| in the last over that in the first fifth of a run with the controller's gains times `factor`.
double growth_in_simulation(SceneValues values, double factor, const Gains& gains) {
  for (const auto& [path, gain] : gains) values.set("loads.control." + path, Value(factor * gain), "the test");
  const Prepared prepared = prepare(std::move(values), plugins());
  const double end = *prepared.scene.end;
  double first = 0, last = 0;
  simulate(prepared, plugins(), [&](const State& s) {
    double& most = s.time < 0.2 * end ? first : last;
    if (s.time < 0.2 * end || s.time > 0.8 * end) most = std::max(most, std::abs(s.y[0]));
  });
  return last / first;
}

/// Where the margin says that the loop is on the edge, a run two per cent below decays and one two per cent above
/// grows.
void confirm(const std::string& text, bool from_below, const Gains& gains) {
  SceneValues values = SceneValues::parse("format: withy/1\n" + text, "text");
  const Prepared prepared = prepare(values, plugins());
  State rest = prepared.scene.initial;
  std::fill(rest.y.begin(), rest.y.end(), 0.0);
  const Response r = response({prepared, rest, {}, Sampling::kept}, {"control", "", {}, {}, 100, {}});
  ASSERT_TRUE(r.margins && r.margins->stable);
  const GainMargin* margin = from_below ? r.margins->lower() : r.margins->upper();
  ASSERT_NE(margin, nullptr);
  const double inside = from_below ? 1.02 : 0.98, outside = from_below ? 0.98 : 1.02;
  EXPECT_LT(growth_in_simulation(values, inside * margin->factor, gains), 0.9) << margin->factor;
  EXPECT_GT(growth_in_simulation(values, outside * margin->factor, gains), 1.1) << margin->factor;
}

TEST(Loop, OfASampledControllerOfAFlexibleArmGoesUnstableInSimulationWhereItsMarginSays) {
  confirm(R"(
time: {end: 12, output: 0.02}
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0], frames: {out: {position: [0.1, 0, 0]}}}
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 40, modes: 2, family: clamped-free}, damping_ratio: 0.02}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.out, child: boom}
loads: {control: {type: pd-controller, law: constant, sample: 0.02, hinges: {axle: {stiffness: 10, damping: 2}}}}
initial: {hinges: {axle: {position: [0.001]}}}
)",
          false, {{"hinges.axle.stiffness", 10}, {"hinges.axle.damping", 2}});
}

// p⁺ = −g a with a from the p before: alone that converges for g below the mass felt, whatever the sample.
TEST(Loop, OfASampledAccelerationGoesUnstableInSimulationWhereItsMarginSays) {
  confirm(R"(
time: {end: 6, output: 0.002}
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs: {imu: {type: accelerometer, of: block}}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 30, damping: 0.5}
  control: {type: pid, of: imu.x, hinge: slide, proportional: 1, sample: 0.01}
initial: {hinges: {slide: {position: [0.01]}}}
)",
          false, {{"proportional", 1}});
}

TEST(Loop, ThatHoldsAPendulumUprightFallsInSimulationWhereItsMarginSays) {
  confirm(R"(
gravity: [-9.81, 0, 0]
time: {end: 12, output: 0.02}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-13}
bodies:
  pole: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: pole}}
loads: {control: {type: pd-controller, law: constant, hinges: {axle: {stiffness: 20, damping: 0.5}}}}
initial: {hinges: {axle: {position: [1.0e-6], rate: [0]}}}
)",
          true, {{"hinges.axle.stiffness", 20}, {"hinges.axle.damping", 0.5}});
}

/// J s³ + k (k_d s² + k_p s + k_i) is stable for k above J k_i/(k_d k_p).
TEST(Loop, ThatIntegratesGoesUnstableInSimulationWhereItsMarginSays) {
  const std::string text = R"(
time: {end: 60, output: 0.05}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-12}
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
loads: {control: {type: pid, hinge: axle, proportional: 8, integral: 10, derivative: 4}}
initial: {hinges: {axle: {position: [0.01]}}}
)";
  const Response r = response(at_start(prepare(SceneValues::parse("format: withy/1\n" + text, "text"), plugins())),
                              {"control", "", {}, {}, 50, {}});
  EXPECT_EQ(r.integrators, 3);
  ASSERT_TRUE(r.margins && r.margins->lower() != nullptr);
  EXPECT_NEAR(r.margins->lower()->factor, 2.0 * 10 / (4 * 8), 1e-8);
  confirm(text, true, {{"proportional", 8}, {"integral", 10}, {"derivative", 4}});
}

TEST(Reduction, OfALongArmStaysWithinItsBound) {
  const Prepared prepared = scene_of(R"(
bodies:
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 40, modes: 6, family: clamped-free}, damping_ratio: 0.02}
hinges: {root: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
loads: {control: {type: pd-controller, law: constant, sample: 0.01, hinges: {root: {stiffness: 4, damping: 1}}}}
outputs: {tip: {type: frame, of: boom.tip, show: position}}
)");
  SceneValues continuous = prepared.values;
  continuous.set_text("loads={}");
  for (const Prepared& p : {prepared, prepare(continuous, plugins())}) {
    const bool free = p.model().loads().empty();
    for (const int order : {4, 6, 9}) {
      const Response r = response(at_start(p), {"root", "tip.y", {}, {}, 50, order});
      ASSERT_TRUE(r.reduction);
      EXPECT_EQ(r.reduction->system.A.rows(), order);
      EXPECT_EQ(r.reduction->kept, free ? 2 : 0) << "a free hinge does not decay";
      EXPECT_LE(r.reduction_error, r.reduction->bound * (1 + 1e-6) + 1e-12);
      EXPECT_GT(r.reduction_error, 1e-3 * r.reduction->bound) << "the bound is not idle";
    }
  }
}

/// 61.31, 18.83 and 6.47 % in the first three modes of a clamped beam, as textbooks have it; all of it where the base
/// is free.
TEST(EffectiveMass, OfABeamIsTheTextbooksAndInAllTheMassThatIsFree) {
  const std::string beam =
      "bodies: {boom: {type: beam, length: 2, mass_per_length: 3, bending_y: {stiffness: 40, modes: 8, family: "
      "clamped-free}}}\n";
  const EffectiveMasses clamped =
      effective_masses(at_start(scene_of(beam + "hinges: {root: {type: weld, parent: world, child: boom}}\n")));
  EXPECT_NEAR(clamped.total, 6, 1e-12);
  const Eigen::VectorXd y = clamped.masses().row(1) / clamped.total;
  EXPECT_NEAR(y[0], 0.6131, 1e-4);
  EXPECT_NEAR(y[1], 0.1883, 1e-4);
  EXPECT_NEAR(y[2], 0.0647, 1e-4);
  EXPECT_LT(clamped.sum()[1], clamped.total);
  EXPECT_EQ(clamped.sum()[2], 0) << "nothing bends that way";
  const EffectiveMasses sliding = effective_masses(
      at_start(scene_of(beam + "hinges: {root: {type: prismatic, axis: [0, 1, 0], parent: world, child: boom}}\n"
                               "loads: {base: {type: hinge-spring, hinge: root, stiffness: 100}}\n")));
  EXPECT_NEAR(sliding.sum()[1], sliding.total, 1e-10);
  EXPECT_GT(sliding.frequencies[0], 0);
}

TEST(Response, OfALoopThatMovesInStepsIsRefusedByTheNameOfWhatDoes) {
  const Prepared p = scene_of(R"(
bodies: {table: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads:
  read: {type: quantizer, of: axle, step: 0.005, sample: 0.01}
  servo: {type: pid, of: read, hinge: axle, proportional: 3, sample: 0.01}
)");
  try {
    ResponseQuestion question;
    question.input = "servo";
    static_cast<void>(response(at_start(p), question));
    FAIL() << "a quantizer has no linear form";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("load 'read' gives what it measures in steps"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace withy::study
