// Slow poles beside fast ones, rigid motions beside vibrations, and states of which a linearization does not tell all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "withy/study/linear_model.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/response.hpp"
#include "withy/tests/study/linear_scenes.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using std::numbers::pi;
using testing::HasSubstr;

ModesAt modes_here(const std::string& text, const Holding& holding = {}, bool as_is = false,
                   const TurningWish& wish = {}) {
  const Prepared prepared = scene_of(text);
  return modes_at(Configuration(prepared, prepared.scene.initial, holding), as_is, wish);
}

Response opened(const std::string& text, const std::string& load) {
  return response(at_start(scene_of(text)), {load, "", {}, {}, 20, {}});
}

double greatest_growth(const ModesAt& at) {
  double growth = -INFINITY;
  for (const Mode& m : at.modes)
    if (!m.rigid) growth = std::max(growth, m.growth());
  return growth;
}

/// The booms' bending out of the plane of the turn is no matter of the wheel's law: sampled it is what it is without.
TEST(SampledModes, OfAFreeSatelliteAreThoseWithoutSamplesWhereTheLawFeelsNothing) {
  SceneValues values = scene("gallery/satellite-wheel");
  values.set_text("loads.wheel.torque_limit=9");
  const Prepared without = prepare(values, test::plugins());
  values.set_text("loads.law.sample=0.01");
  const Prepared with = prepare(values, test::plugins());
  const ModesAt continuous = modes_at(at_start(without), false), sampled = modes_at(at_start(with), false);
  ASSERT_EQ(sampled.problem, "");
  const auto bending = [](const ModesAt& at) {
    std::vector<Mode> found;
    for (const Mode& m : at.modes)
      if (!m.rigid && dominating(at, m).find("boom.bending_z") != std::string::npos) found.push_back(m);
    return found;
  };
  const std::vector<Mode> of_continuous = bending(continuous), of_sampled = bending(sampled);
  ASSERT_EQ(of_continuous.size(), 2U);
  ASSERT_EQ(of_sampled.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LE(std::abs(of_sampled[i].eigenvalue - of_continuous[i].eigenvalue),
              1e-9 * std::abs(of_continuous[i].eigenvalue));
  // The turn about z has no part of one about x.
  for (const Mode& m : sampled.modes) {
    if (dominating(sampled, m) == "float.2") {
      EXPECT_LT(std::abs(m.shape[0]), 1e-9 * std::abs(m.shape[2]));
    }
    if (!m.rigid) {
      EXPECT_LT(m.frequency(), 2 * pi * 20) << dominating(sampled, m) << ": 1/T is 100 Hz";
    }
  }
}

/// A hub with a boom of up to 30 kHz under a controller that pushes away slowly.
std::string slowly_pushed(const std::string& sample) {
  return R"(
bodies:
  hub: {type: rigid, mass: 50, inertia: [10, 10, 20, 0, 0, 0], frames: {r: {position: [0.5, 0, 0]}}}
  boom: {type: beam, length: 2, mass_per_length: 0.5, damping_ratio: 0.005, bending_y: {stiffness: 2.0e+5, modes: 4, family: clamped-free}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.r, child: boom}
loads:
  law: {type: transfer-function, of: axle, hinge: axle, numerator: [1.5, 0.06, -1.0e-4], denominator: [0.05, 1, 0], reference: 0)" +
         sample + "}\n";
}

/// Own map of the rigid hub, 20 + 0.5 (2.5³ − 0.5³)/3 kg m², at T = 1 ms, and own polynomial in continuous time.
TEST(SlowPoles, ThatDivergeAreNoRigidMotionsBesideStiffBooms) {
  const ModesAt at = modes_here(slowly_pushed(", sample: 0.001"));
  ASSERT_EQ(at.problem, "");
  EXPECT_NEAR(greatest_growth(at), 0.0016004453802630826, 1e-9);
  EXPECT_TRUE(std::none_of(at.modes.begin(), at.modes.end(), [](const Mode& m) { return m.rigid; }));
  for (const std::string sample : {"", ", sample: 0.001"}) {
    const Response r = opened(slowly_pushed(sample), "law");
    ASSERT_TRUE(r.margins);
    EXPECT_FALSE(r.margins->stable) << sample;
    EXPECT_NEAR(r.margins->growth, 0.0016004453802630826, 1e-6) << sample;
    EXPECT_EQ(r.integrators, 3) << sample << " two of the hub, one of the law";
  }
}

/// An arm on a spring, its angle filtered far below what an actuator follows.
std::string filtered(int order, const std::string& law) {
  return R"(
bodies: {arm: {type: rigid, mass: 2, center_of_mass: [0.3, 0, 0], inertia: [0.03, 0.04, 0.05, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}}
loads:
  k: {type: hinge-spring, hinge: axle, stiffness: 2, damping: 0.1}
  lp: {type: filter, of: axle, cutoff: 0.05 Hz, order: )" +
         std::to_string(order) + R"(}
  law: {)" +
         law + R"(, of: lp, to: nothing}
  act: {type: actuator, of: law, hinge: axle, frequency: 3000}
)";
}

/// Own roots of the loop's equation, by bisection.
TEST(SlowPoles, OfFiltersAreFoundBesideFastActuators) {
  const ModesAt held = modes_here(filtered(12, "type: pid, proportional: 0.01, integral: 0.003"));
  EXPECT_NEAR(greatest_growth(held), -0.001549851463310026, 1e-9);
  EXPECT_TRUE(std::none_of(held.modes.begin(), held.modes.end(), [](const Mode& m) { return m.rigid; }));
  EXPECT_TRUE(opened(filtered(12, "type: pid, proportional: 0.01, integral: 0.003"), "act").margins->stable);
  const std::string away = "type: transfer-function, numerator: [-0.01, 0.003], denominator: [1, 0]";
  EXPECT_NEAR(greatest_growth(modes_here(filtered(4, away))), 0.0014743257349051507, 1e-9);
  const Response r = opened(filtered(4, away), "act");
  EXPECT_FALSE(r.margins->stable);
  EXPECT_NEAR(r.margins->growth, 0.0014743257349051507, 1e-8);
}

TEST(SlowPoles, AreNoIntegratorsHoweverShortTheSamples) {
  const Response r = opened(R"(
bodies: {arm: {type: rigid, mass: 2, center_of_mass: [0.3, 0, 0], inertia: [0.03, 0.04, 0.05, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}}
loads:
  oil: {type: hinge-spring, hinge: axle, stiffness: 0.001, damping: 5}
  servo: {type: pid, hinge: axle, proportional: 0.05, sample: 0.0001}
)",
                            "servo");
  EXPECT_EQ(r.integrators, 0);
  EXPECT_NEAR(r.static_gain, 0.05 / 0.001, 1e-5);
}

/// The arm is held and the pen beside it, 0.26 kg m² with 9.81 · 0.5 N m above its pin, falls.
TEST(Loop, IsNotStableWhereAPoleThatItDoesNotMoveGrows) {
  const Response r = opened(R"(
gravity: [0, -9.81, 0]
bodies:
  arm: {type: rigid, mass: 2, center_of_mass: [0.3, 0, 0], inertia: [0.03, 0.04, 0.05, 0, 0, 0]}
  pen: {type: rigid, mass: 1, center_of_mass: [0, 0.5, 0], inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}
  pin: {type: revolute, axis: [0, 0, 1], parent: world, child: pen}
loads: {servo: {type: pid, hinge: axle, proportional: 8, integral: 5, derivative: 1.2, filter: 0.05, reference: 0.4}}
)",
                            "servo");
  EXPECT_EQ(r.roots.hidden.size(), 2);
  ASSERT_TRUE(r.margins);
  EXPECT_FALSE(r.margins->stable);
  EXPECT_NEAR(r.margins->hidden_growth, std::sqrt(9.81 * 0.5 / 0.26), 1e-9);
  EXPECT_EQ(r.margins->lag(), nullptr);
}

/// Own maps with the command of n samples before: of 14 the greatest multiplier is 0.99986, of 15 it is 1.00076.
TEST(Loop, ThatIsSampledTakesTheDelayOfTheWholeSamplesItNames) {
  const std::string text = R"(
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads:
  spring: {type: hinge-spring, hinge: axle, stiffness: 1, damping: 0.5}
  servo: {type: pid, hinge: axle, proportional: 2, sample: 0.02)";
  const Response r = opened(text + "}\n", "servo");
  ASSERT_TRUE(r.margins && r.margins->stable);
  EXPECT_EQ(r.margins->samples(), 14);
  EXPECT_LT(greatest_growth(modes_here(text + ", delay: 0.28}\n")), 0);
  EXPECT_GT(greatest_growth(modes_here(text + ", delay: 0.3}\n")), 0);
}

/// Euler: Ω √((I₃ − I₂)(I₁ − I₃)/(I₁ I₂)) about the axis in between. In axes that stay the inertia turns.
TEST(TurningModes, OfABodyAboutItsIntermediateAxisGrowOverAWholeTurn) {
  const auto spinning = [](const std::string& inertia) {
    TurningWish wish;
    wish.floquet = true;
    return modes_here("gravity: [0, 0, 0]\nbodies: {b: {type: rigid, mass: 1, inertia: " + inertia + R"(}}
hinges: {g: {type: spherical, parent: world, child: b}}
initial: {hinges: {g: {position: [1, 0, 0, 0], rate: [0, 0, 2]}}}
)",
                      {}, false, wish);
  };
  const ModesAt between = spinning("[1, 2, 1.5, 0, 0, 0]");
  ASSERT_TRUE(between.turn && between.turn->floquet) << between.turn->problem;
  EXPECT_TRUE(between.frozen()) << "one angle tells no stability";
  EXPECT_NEAR(between.turn->check.turning.period, pi, 1e-12);
  EXPECT_FALSE(between.turn->floquet->stable);
  EXPECT_NEAR(between.turn->floquet->modes.front().exponent.real(), 2 * std::sqrt(0.5 * 0.5 / 2), 1e-7);
  const ModesAt top = spinning("[1, 1, 1.5, 0, 0, 0]");
  EXPECT_FALSE(top.frozen());
  EXPECT_TRUE(top.turn->floquet->stable);
}

/// Two unbalanced rotors on a base, whose rates have no common period.
TEST(TurningModes, WithoutACommonPeriodAreNotSteadyAllTheSame) {
  const ModesAt at = modes_here(R"(
gravity: [0, 0, 0]
bodies:
  base: {type: rigid, mass: 5}
  r1: {type: rigid, mass: 1, center_of_mass: [0, 0.1, 0], inertia: [0.2, 0.1, 0.1, 0, 0, 0]}
  r2: {type: rigid, mass: 1, center_of_mass: [0, 0.1, 0], inertia: [0.2, 0.1, 0.1, 0, 0, 0]}
hinges:
  y: {type: prismatic, axis: [0, 1, 0], parent: world, child: base}
  s1: {type: revolute, axis: [1, 0, 0], parent: base, child: r1}
  s2: {type: revolute, axis: [1, 0, 0], parent: base, child: r2}
loads: {ky: {type: hinge-spring, hinge: y, stiffness: 100, damping: 0.2}}
)",
                                {{}, {{"s1", 3}, {"s2", 4.24264}}});
  ASSERT_TRUE(at.turn && at.steady);
  EXPECT_THAT(at.turn->check.turning.problem, HasSubstr("common period"));
  EXPECT_FALSE(at.turn->check.steady);
  EXPECT_FALSE(at.steady->stays.value_or(true));
  EXPECT_THAT(turn_text(*at.turn), HasSubstr("tell no stability"));
}

/// Half of a shaft's slots: a mass on a spring across it, beside another across the world.
TEST(LinearModel, AboutATurningStateSaysThatItIsFrozen) {
  const std::string text = R"(
gravity: [0, 0, 0]
bodies:
  base: {type: rigid, mass: 1}
  shaft: {type: rigid, mass: 0, inertia: [1, 0.5, 0.5, 0, 0, 0]}
  disc: {type: rigid, mass: 2}
hinges:
  y: {type: prismatic, axis: [0, 1, 0], parent: world, child: base}
  spin: {type: revolute, axis: [1, 0, 0], parent: base, child: shaft}
  slot: {type: prismatic, axis: [0, 1, 0], parent: shaft, child: disc}
loads:
  ky: {type: hinge-spring, hinge: y, stiffness: 300}
  ks: {type: hinge-spring, hinge: slot, stiffness: 500}
)";
  const Prepared prepared = scene_of(text);
  const Configuration turns(prepared, prepared.scene.initial, {{}, {{"spin", 3}}}),
      rests(prepared, prepared.scene.initial, {{"spin"}, {}});
  const LinearModel of_turning = linear_model(turns, {{"y"}, {"y"}});
  EXPECT_TRUE(of_turning.frozen);
  EXPECT_THAT(note_of_frozen(of_turning), HasSubstr("tell no stability"));
  EXPECT_FALSE(linear_model(rests, {{"y"}, {"y"}}).frozen);
}

TEST(TurningModes, AreNotToldOfATurnAfterWhichMotionsOrStiffnessesAreOthers) {
  TurningWish wish;
  wish.floquet = true;
  wish.period = 0.2;
  const std::string driven = R"(
gravity: [0, -9.81, 0]
bodies:
  c: {type: rigid, mass: 1}
  p: {type: rigid, mass: 1, center_of_mass: [0, 1, 0]}
hinges:
  y: {type: prismatic, axis: [0, 1, 0], parent: world, child: c}
  h: {type: revolute, axis: [0, 0, 1], parent: c, child: p}
motions: {s: {type: sine, hinge: y, amplitude: 0.15, period: 0.25}}
)";
  const ModesAt other = modes_here(driven, {}, false, wish);
  EXPECT_THAT(other.turn->problem, HasSubstr("motion 's' moves otherwise 0.2 s later"));
  wish.period = 0.25;
  const ModesAt same = modes_here(driven, {}, false, wish);
  ASSERT_TRUE(same.turn->floquet) << same.turn->problem;
  // Own integration of the pendulum on the moving car.
  EXPECT_NEAR(same.turn->floquet->modes.front().exponent.real(), 1.70167021, 1e-6);
  const std::string sprung = R"(
gravity: [0, 0, 0]
bodies:
  m: {type: rigid, mass: 1}
  r: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  y: {type: prismatic, axis: [0, 1, 0], parent: world, child: m}
  s: {type: revolute, axis: [1, 0, 0], parent: m, child: r}
loads:
  k: {type: hinge-spring, hinge: y, stiffness: 162}
  p: {type: expression, hinge: y, value: "60*sin(18*t)*y"}
)";
  wish.period = 0;
  const ModesAt parametric = modes_here(sprung, {{}, {{"s", 3.2}}}, false, wish);
  EXPECT_THAT(parametric.turn->problem, HasSubstr("load 'p' acts otherwise"));
  const ModesAt in_step = modes_here(sprung, {{}, {{"s", 3}}}, false, wish);
  ASSERT_TRUE(in_step.turn->floquet) << in_step.turn->problem;
  // Own Mathieu equation ÿ = (−81 + 30 sin 18 t) y.
  EXPECT_NEAR(in_step.turn->floquet->modes.front().exponent.real(), 0.8300162, 1e-6);
}

}  // namespace
}  // namespace withy::study
