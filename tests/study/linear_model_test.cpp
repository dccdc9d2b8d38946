// Linear models with inputs, sensors and sampled loads: what forces do to accelerations, and the map of a run.
#include "withy/study/linear_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "withy/core/model/switched_load.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/open_loop.hpp"
#include "withy/study/response.hpp"
#include "withy/study/run.hpp"
#include "withy/study/sampled_steady.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;

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
  const LinearModel m = linear_model({prepared, rest, {}}, {{"slide"}, {"slide"}});
  EXPECT_DOUBLE_EQ(m.system.period, 0.06);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(m.system.A.rows());
  z.head(2) << 0.1, 0.5;
  for (int k = 0; k < 10; ++k) z = m.system.A * z;
  const RunSummary run = simulate(prepared, plugins(), {});
  ASSERT_EQ(run.status, RunStatus::completed);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(run.final.y[i], z[static_cast<Eigen::Index>(i)], 1e-9) << i;
}

/// At rest until 0.03 s, when an input begins that stays: how far a run and the map from sample to sample are apart at
/// 0.6 s, over all that moves.
double map_against_run(const std::string& text, double kick) {
  const Prepared prepared = prepare(SceneValues::parse("format: withy/1\ntime: {end: 0.6}\n"
                                                       "integrator: {name: dopri5, rtol: 1e-12, atol: 1e-14}\n" +
                                                           text,
                                                       "text"),
                                    plugins());
  State rest = prepared.scene.initial;
  std::fill(rest.y.begin(), rest.y.end(), 0.0);
  const LinearModel m = linear_model({prepared, rest, {}}, {{"kick"}, {"slide"}});
  EXPECT_DOUBLE_EQ(m.system.period, 0.03);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(m.system.A.rows());
  // At its time a row of a table is what is measured already.
  if (m.states.back() == "kick.before") z[z.size() - 1] = kick;
  for (int k = 1; k < 20; ++k) z = m.system.A * z + m.system.B.col(0) * kick;
  const RunSummary run = simulate(prepared, plugins(), {});
  EXPECT_EQ(run.status, RunStatus::completed);
  double apart = 0;
  for (std::size_t i = 0; i < prepared.model().layout().moving(); ++i)
    apart = std::max(apart, std::abs(run.final.y[i] - z[static_cast<Eigen::Index>(i)]));
  EXPECT_GT(std::abs(run.final.y[0]), 0.01) << "it moves";
  return apart;
}

const std::string kicked_cart = R"(
bodies: {cart: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}}
)";

/// A mean since the start is a sum over a time that grows: its gain is that of the state's time, and that is said, of
/// loads that act alone.
TEST(LinearModel, SaysWhichLoadsHaveTheGainOfAnInstant) {
  const Prepared prepared = scene_of(R"(
bodies: {cart: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}}
loads:
  area: {type: over-time, of: slide, what: integral}
  mean: {type: over-time, of: slide, what: mean}
  size: {type: over-time, of: slide, what: rms}
  stay: {type: expression, hinge: slide, value: -12 * mean - area}
events: {later: {at: 0.9, do: {switch_off: size}}}
)");
  const auto gain = [&](double time) {
    State state = prepared.scene.initial;
    state.time = time;
    const LinearModel m = linear_model({prepared, state, {}}, {{"slide"}, {"slide"}});
    EXPECT_EQ(m.changing, (std::vector<std::string>{"mean", "size"}));
    EXPECT_NE(note_of_changing(m, time).find("the gain of 'mean', 'size' changes"), std::string::npos);
    const auto sum = std::find(m.states.begin(), m.states.end(), "mean.sum") - m.states.begin();
    return m.system.A(1, sum);
  };
  EXPECT_NEAR(gain(0.5), -12 / (2 * 0.5), 1e-9);
  EXPECT_NEAR(gain(0.8), -12 / (2 * 0.8), 1e-9);
  State off = prepared.scene.initial;
  off.time = 0.5;
  for (const LoadSlot& slot : prepared.model().layout().discrete_slots)
    if (prepared.model().loads()[slot.load].name == "size")
      off.y[SwitchedLoad::place_of_form(slot)] = SwitchedLoad::off;
  const LinearModel m = linear_model({prepared, off, {}}, {{"slide"}, {"slide"}});
  EXPECT_EQ(m.changing, std::vector<std::string>{"mean"});
}

/// An actuator follows what a sampled controller commands, and a spring without pause what a sampled mean shows.
TEST(LinearModel, OfLoadsThatMeasureWhatIsHeldIsTheMapOfARun) {
  EXPECT_LT(map_against_run(kicked_cart + R"(
loads:
  kick: {type: input, hinge: slide, table: [[0, 0], [0.03, 5]]}
  servo: {type: pid, of: slide, to: nothing, proportional: 30, derivative: 4, sample: 0.03, delay: 0.03}
  drive: {type: actuator, of: servo, hinge: slide, frequency: 20}
  mean: {type: moving-average, of: slide, window: 0.06, sample: 0.03}
  stay: {type: expression, hinge: slide, value: -12 * mean}
)",
                            5),
            1e-9);
}

/// The force moves nothing, for it stands across the slide; the reaction to it is what a controller measures.
TEST(LinearModel, OfALoadThatSamplesAReactionFeelsWhereAForceActs) {
  EXPECT_LT(map_against_run(kicked_cart + R"(
outputs: {rail: {type: reaction, hinge: slide}}
loads:
  kick: {type: input, frame: cart, direction: [0, 1, 0], table: [[0, 0], [0.03, 5]]}
  spring: {type: hinge-spring, hinge: slide, stiffness: 30}
  servo: {type: expression, hinge: slide, value: 0.7 * rail.fy, sample: 0.03}
)",
                            5),
            1e-9);
}

/// Two sampled controllers on a sprung hinge: what they tell is of a sample at the state, not of one at the start.
TEST(LinearModel, WhatSampledControllersTellFollowsTheState) {
  const Prepared prepared = scene_of(R"(
bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}
loads:
  s: {type: hinge-spring, hinge: h, stiffness: 20, preload: 5, damping: 1}
  c: {type: pid, of: h, hinge: h, sample: 0.1, proportional: 3, derivative: 0.2, filter: 0.05, limit: 5, reference: 1}
  d: {type: pd-controller, law: constant, sample: 0.1, hinges: {h: {to: 2, stiffness: 1, damping: 0.1, limit: 7}}}
outputs: {cc: {type: control, of: c}, dd: {type: control, of: d}}
)");
  const SteadyState steady = steady_state_of(at_start(prepared));
  ASSERT_TRUE(steady.converged);
  const double h = steady.state.y[0];
  const std::vector<LoadSlot> told = told_slots(prepared.model());
  ASSERT_EQ(told.size(), 2U);
  EXPECT_NEAR(steady.state.y[told[0].first], 1 - h, 1e-12) << "the error, as files of states keep it";
  Configuration c = at_start(prepared);
  c.set_state(steady.state);
  const LinearModel m = linear_model(c, {{"h"}, {"cc", "dd", "h.0", "h.0.rate"}});
  const auto value = [&](const std::string& name) {
    return m.output_values[static_cast<std::size_t>(find(m.outputs, name))];
  };
  EXPECT_NEAR(value("cc.error"), 1 - h, 1e-12);
  EXPECT_NEAR(value("cc.margin"), 5 - value("cc.command"), 1e-12);
  EXPECT_NEAR(value("dd.error"), 2 - h, 1e-12);
  EXPECT_NEAR(value("dd.margin"), 7 - (2 - h), 1e-12) << "of what is asked for";
  const auto row = [&](const std::string& name) { return m.system.C.row(find(m.outputs, name)); };
  EXPECT_LT((row("cc.error") + row("h.0")).norm(), 1e-10);
  EXPECT_LT((row("dd.error") + row("h.0")).norm(), 1e-10);
  EXPECT_LT((row("cc.margin") + row("cc.command")).norm(), 1e-8 * row("cc.command").norm());
  EXPECT_LT((row("dd.margin") - row("h.0") - 0.1 * row("h.0.rate")).norm(), 1e-10);
  EXPECT_NEAR(response(c, {"h", "cc.error", {}, {}, 20, {}}).static_gain,
              -response(c, {"h", "h.0", {}, {}, 20, {}}).static_gain, 1e-10);
}

/// Three links of 1 m, each turned by 0.3 rad against the one before: places of tips in closed form, whichever are
/// asked for and in what order.
TEST(LinearModel, OfSomeTipsHasTheirPlacesAndNoOthers) {
  const Prepared prepared = scene_of(R"(
bodies:
  a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {tip: {position: [1, 0, 0]}}}
  b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {tip: {position: [1, 0, 0]}}}
  c: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {tip: {position: [1, 0, 0]}}}
hinges:
  i: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  j: {type: revolute, axis: [0, 0, 1], parent: a.tip, child: b}
  k: {type: revolute, axis: [0, 0, 1], parent: b.tip, child: c}
initial: {hinges: {i: {position: 0.3}, j: {position: 0.3}, k: {position: 0.3}}}
)");
  const Configuration c = at_start(prepared);
  const LinearModel all = linear_model(c, {{"i"}, {}});
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"c.tip.y"}, {"b.tip.x", "j.0", "c.tip.y", "b.tip"}, {"a.tip.z", "c.tip.y"}}) {
    const LinearModel some = linear_model(c, {{"i"}, names});
    for (const Column& output : some.outputs) {
      const Eigen::Index one = find(some.outputs, output.name), among = find(all.outputs, output.name);
      EXPECT_EQ(some.system.C.row(one), all.system.C.row(among)) << output.name;
      EXPECT_EQ(some.output_values[static_cast<std::size_t>(one)], all.output_values[static_cast<std::size_t>(among)]);
    }
    const Eigen::RowVectorXd row = some.system.C.row(find(some.outputs, "c.tip.y"));
    EXPECT_NEAR(row[0], std::cos(0.3) + std::cos(0.6) + std::cos(0.9), 1e-14);
    EXPECT_NEAR(row[1], std::cos(0.6) + std::cos(0.9), 1e-14);
    EXPECT_NEAR(row[2], std::cos(0.9), 1e-14);
    EXPECT_EQ(row.tail(3).norm(), 0);
  }
  EXPECT_THROW(static_cast<void>(linear_model(c, {{"i"}, {"b.tip.deflection_x"}})), InputError) << "b is rigid";
}

/// At 1e8 m a coordinate has steps of 1.5e-8 m.
TEST(LinearModel, OfSensorsFarFromTheOriginIsThatOfSensorsNearIt) {
  for (const char* place : {"0.5", "1e8", "1e11"}) {
    const LinearModel m = linear_model(at_start(scene_of(R"(
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
loads: {k: {type: hinge-spring, hinge: slide, stiffness: 200, free_position: )" +
                                                         std::string(place) + R"(}}
outputs: {d: {type: distance, to: block}, f: {type: frame, of: block}}
initial: {hinges: {slide: {position: [)" + place + "]}}}\n")),
                                       {{"slide"}, {"d", "f.x", "f.ax"}});
    const auto of_place = [&](const std::string& name) { return m.system.C(find(m.outputs, name), 0); };
    EXPECT_NEAR(of_place("d"), 1, 1e-9) << place;
    EXPECT_NEAR(of_place("f.x"), 1, 1e-9) << place;
    EXPECT_NEAR(of_place("f.ax"), -100, 1e-7) << place;
    EXPECT_EQ(m.output_derivatives.find("inf"), std::string::npos) << m.output_derivatives;
  }
}

/// With one rate of a hinge held, what a sampled load measures of accelerations would be that of a body free in it.
TEST(LinearModel, OfASampledAccelerationOnAHingeThatIsHeldInPartIsRefused) {
  const auto scene = [](const std::string& measured) {
    return scene_of(R"(
bodies: {puck: {type: rigid, mass: 2, center_of_mass: [0.3, 0.2, 0], inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {ice: {type: planar, parent: world, child: puck}}
outputs: {imu: {type: accelerometer, of: puck}, turn: {type: gyro, of: puck}}
loads: {servo: {type: pid, of: )" +
                    measured + ", hinge: ice, component: 2, proportional: 0.4, sample: 0.01}}\n");
  };
  const auto held = [](const Prepared& prepared) {
    return Configuration{prepared, prepared.scene.initial, {{"ice.1"}, {}}};
  };
  const Prepared acceleration = scene("imu.y"), rate = scene("turn.z");
  EXPECT_THROW(static_cast<void>(linear_model(held(acceleration), {{"ice.2"}, {"ice.2"}})), InputError);
  EXPECT_THROW(static_cast<void>(open_loop(held(acceleration), "servo")), InputError);
  EXPECT_NO_THROW(static_cast<void>(linear_model(held(rate), {{"ice.2"}, {"ice.2"}})));
}

/// A spring of -20 N m/rad by the error of another sample pushes for a whole period where it should not: such a loop
/// grows, and "stable" would be said of it, for the error is told and nothing follows it.
TEST(LinearModel, OfALoadThatSamplesWhatASampledControllerTellsIsRefused) {
  const auto scene = [](const std::string& measured) {
    return scene_of(R"(
bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}
outputs: {q: {type: hinge, hinge: h}, cc: {type: control, of: c}, twice: {type: expression, value: 2 * cc.error}}
loads:
  s: {type: hinge-spring, hinge: h, stiffness: 1, damping: 0.1}
  c: {type: pid, of: h, hinge: h, proportional: 0.0001, sample: 0.5}
  k: {type: expression, hinge: h, value: ")" +
                    measured + "\", sample: 0.5}\n");
  };
  for (const std::string measured : {"20*cc.error", "20*cc.error^2", "10*twice"}) {
    const Prepared told = scene(measured);
    EXPECT_THROW(static_cast<void>(linear_model(at_start(told), {{"h"}, {"h.0"}})), InputError) << measured;
    EXPECT_THROW(static_cast<void>(find_equilibrium(at_start(told), {}, plugins())), InputError) << measured;
  }
  for (const std::string measured : {"-20*q.position", "20*cc.command"})
    EXPECT_NO_THROW(static_cast<void>(linear_model(at_start(scene(measured)), {{"h"}, {"h.0", "cc.error"}})))
        << measured;
}

TEST(LinearModel, TellsHowWellTheDerivativesOfTheOutputsAskedForAreKnown) {
  const Prepared prepared = scene_of(free_body + "  jumps: {type: expression, value: 'atan(1e18 * place.x)'}\n");
  const auto to = [&](const std::vector<std::string>& outputs) {
    const std::string text = linear_model(at_start(prepared), {{}, outputs}).output_derivatives;
    return std::stod(text.substr(text.rfind(' ') + 1));
  };
  EXPECT_GT(to({"place", "jumps"}), 0.1);
  EXPECT_LT(to({"place"}), 1e-10);
}

TEST(LinearModel, TellsWhereAFreeBodyIs) {
  const Prepared prepared = scene_of(free_body + "initial: {hinges: {float: {position: {position: [3, -2, 0.5]}}}}\n");
  const LinearModel m = linear_model(at_start(prepared), {{"push"}, {"float"}});
  std::vector<double> place;
  for (std::size_t i = 0; i < m.outputs.size(); ++i)
    if (m.outputs[i].unit == "m") place.push_back(m.output_values[i]);
  EXPECT_EQ(place, (std::vector<double>{3, -2, 0.5}));
}

}  // namespace
}  // namespace withy::study
