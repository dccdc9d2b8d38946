// Whether a state is steady where nothing holds a coordinate: what is left over counts against the forces in play
// there, not against how stiff something else is. Each scene by itself, and beside a sampled loop on a hinge of its
// own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "withy/study/equilibrium.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/modes.hpp"
#include "withy/tests/study/linear_scenes.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;

/// A craft of 4 kg on a free slide, with a panel whose vibrations are faster than 1e4 rad/s; a table with a servo.
const std::string craft = R"(
bodies:
  hub: {type: rigid, mass: 4, inertia: [1, 1, 1, 0, 0, 0]}
  panel: {type: beam, length: 1, mass_per_length: 0.1, bending_y: {stiffness: 1e6, modes: 2}}
  table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
hinges:
  slide: {type: prismatic, axis: [0, 1, 0], parent: world, child: hub}
  root: {type: weld, parent: hub, child: panel}
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}
loads:
  servo: {type: pid, hinge: axle, proportional: 5, derivative: 1, filter: 0.02}
)";

/// A heavy body about an axle that leans by so much [rad], and a stiff beam that stands.
std::string leaning(const std::string& by) {
  return R"(
gravity: [0, 0, -9.81]
bodies:
  wheel: {type: rigid, mass: 2, center_of_mass: [0.5, 0.3, 0], inertia: [1, 1, 1, 0, 0, 0]}
  mast: {type: beam, length: 1, mass_per_length: 0.1, bending_y: {stiffness: 1e6, modes: 2}}
  table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [)" +
         by + R"(, 0, 1], parent: world, child: wheel}
  root: {type: weld, parent: world, child: mast}
  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: table}
loads:
  servo: {type: pid, hinge: pivot, proportional: 5, derivative: 1, filter: 0.02}
)";
}

/// What is said where there is no steady state; by itself, then with samples.
std::vector<std::string> problems(const std::string& scene, const std::vector<std::string>& loads = {}) {
  std::vector<std::string> said, sampled = loads;
  sampled.emplace_back("loads.servo.sample=0.01");
  for (const std::vector<std::string>& overrides : {loads, sampled})
    said.push_back(find_equilibrium(at_start(scene_of(scene, overrides)), {}, plugins()).problem);
  return said;
}

std::string push(const std::string& name, const std::string& force) {
  return "loads." + name + "={type: force, frame: hub, law: constant, value: [0, " + force + ", 0]}";
}

TEST(Balance, IsLostToASmallForceBesideAStiffPanel) {
  for (const std::string& said : problems(craft)) EXPECT_EQ(said, "");
  for (const std::string force : {"1e-2", "1e-8", "1e-16"})
    for (const std::string& said : problems(craft, {push("thrust", force)}))
      EXPECT_THAT(said, HasSubstr("nothing holds slide")) << force;
}

TEST(Balance, IsLostToASmallTorqueOnASmallRotor) {
  const std::vector<std::string> rotor = {
      "bodies.rotor={type: rigid, mass: 1e-9, inertia: [1e-12, 1e-12, 1e-12, 0, 0, 0]}",
      "hinges.bearing={type: revolute, axis: [0, 0, 1], parent: world, child: rotor}",
      "loads.drag={type: torque, frame: rotor, law: constant, value: [0, 0, 1e-16]}"};
  for (const std::string& said : problems(craft, rotor)) EXPECT_THAT(said, HasSubstr("nothing holds bearing"));
}

/// 0.1 + 0.2 − 0.3 is 5.6e-17.
TEST(Balance, IsKeptWhereForcesMakeUpForEachOtherButForRounding) {
  const std::vector<std::string> three = {push("a", "0.1"), push("b", "0.2"), push("c", "-0.3")};
  for (const std::string& said : problems(craft, three)) EXPECT_EQ(said, "");
  for (const std::string& said : problems(craft, {push("a", "0.1"), push("b", "0.2"), push("c", "-0.3000001")}))
    EXPECT_THAT(said, HasSubstr("nothing holds slide"));
}

/// Data with ten digits are meant as they are read: an axle is upright that leans by less than 1e-9.
TEST(Balance, IsKeptByWeightOnAnUprightAxle) {
  for (const std::string by : {"0", "1e-10"})
    for (const std::string& said : problems(leaning(by))) EXPECT_EQ(said, "") << by;
  // One that leans by more holds the wheel, however stiff a mast stands beside it: it hangs where its weight is lowest.
  const Prepared prepared = scene_of(leaning("1e-7"));
  const Equilibrium found = find_equilibrium(at_start(prepared), {}, plugins());
  ASSERT_EQ(found.problem, "");
  EXPECT_EQ(found.steady.neutral.size(), 0);
  const double angle = found.steady.state.y[prepared.model().layout().hinge("axle")->position];
  EXPECT_NEAR(std::remainder(angle + std::atan2(0.3, 0.5), std::numbers::pi), 0, 1e-6);
}

/// A chain of rods in the plane, the first turned so far from the horizontal; weight acts down.
std::string chain(int rods, const std::string& angle) {
  std::string bodies = "\ngravity: [0, -9.81, 0]\nbodies:\n", hinges = "hinges:\n", parent = "world";
  for (int i = 1; i <= rods; ++i) {
    const std::string n = std::to_string(i);
    bodies += "  rod" + n +
              ": {type: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0], " +
              "frames: {end: {position: [1, 0, 0]}}}\n";
    hinges += "  joint" + n + ": {type: revolute, axis: [0, 0, 1], parent: " + parent + ", child: rod" + n + "}\n";
    parent = "rod" + n + ".end";
  }
  return bodies + hinges + "initial: {hinges: {joint1: {position: [" + angle + "]}}}\n";
}

// Where Newton's method ends depends on rounding: of 2ⁿ balances of n rods one lasts. From the horizontal it does not
// move at all, for there K is zero.
TEST(Balance, OfAChainThatIsFarFromItIsWhereItHangs) {
  for (const int rods : {1, 2, 6, 30}) {
    for (const std::string start : {"0", "0.3", "3"}) {
      SCOPED_TRACE(std::to_string(rods) + " rods from " + start);
      const Prepared prepared = scene_of(chain(rods, start));
      const Equilibrium found = find_equilibrium(at_start(prepared), {}, plugins());
      ASSERT_EQ(found.problem, "");
      const std::vector<double>& y = found.steady.state.y;
      double angle = 0;
      for (int i = 0; i < rods; ++i) {
        angle += y[static_cast<std::size_t>(i)];
        EXPECT_NEAR(std::sin(angle), -1, 1e-12) << "rod " << i + 1;
      }
    }
  }
}

// The step along the forces is at first as short as the beam's stiffness asks, and weight is the same all the way: one
// that grows only as the forces fall comes nowhere, and Newton's method ends many turns away.
TEST(Balance, OfABeamThatStartsLevelIsWhereItHangs) {
  for (const std::string stiffness : {"8", "80", "800", "8000", "8e6"}) {
    SCOPED_TRACE(stiffness + " N m^2");
    const Prepared prepared =
        scene_of("\ngravity: [0, -9.81, 0]\nbodies: {flap: {type: beam, length: 2, mass_per_length: " +
                 std::string("0.5, bending_y: {stiffness: ") + stiffness +
                 ", modes: 2}}}\nhinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, "
                 "child: flap}}\n");
    const Equilibrium found = find_equilibrium(at_start(prepared), {}, plugins());
    ASSERT_EQ(found.problem, "");
    const Layout& layout = prepared.model().layout();
    const std::vector<double>& y = found.steady.state.y;
    EXPECT_NEAR(y[layout.hinge("axle")->position], -std::numbers::pi / 2, 1e-9);
    for (std::size_t i = 0; i < layout.positions; ++i) {
      if (i == layout.hinge("axle")->position) continue;
      EXPECT_NEAR(y[i], 0, 1e-9) << i;
    }
  }
}

TEST(Balance, NearAnUprightPendulumIsThatOne) {
  const Equilibrium found = find_equilibrium(at_start(scene_of(chain(2, "1.4"))), {}, plugins());
  ASSERT_EQ(found.problem, "");
  EXPECT_EQ(found.steady.relaxations, 0);
  EXPECT_NEAR(found.steady.state.y[0], 0.5 * std::numbers::pi, 1e-12);
}

/// An integral that nothing feeds back goes on, however slowly.
TEST(Balance, IsLostWhereAnIntegralGoesOn) {
  const Holding locked{{"axle"}, {}};
  for (const std::string reference : {"0", "1e-6"}) {
    for (const std::string sample : {"", ", sample: 0.01"}) {
      const Prepared prepared = scene_of(
          craft, {"loads.servo={type: pid, hinge: axle, integral: 1e-6, reference: " + reference + sample + "}"});
      const Configuration c(prepared, prepared.scene.initial, locked);
      EXPECT_EQ(find_equilibrium(c, locked, plugins()).problem.empty(), reference == "0") << reference << sample;
    }
  }
}

/// A blade that turns at 2 rad/s, and whose weight bends it or does not; so stiff that it is bent by less than a
/// micrometre.
struct TurningBlade {
  Equilibrium equilibrium;
  ModesAt modes;
};

TurningBlade turning_blade(const std::string& gravity, const std::string& stiffness, const std::string& modes) {
  const Prepared prepared = scene_of("gravity: " + gravity + R"(
bodies: {blade: {type: beam, length: 1, mass_per_length: 0.5, bending_z: {stiffness: )" +
                                     stiffness + ", modes: " + modes + R"(}}}
hinges: {axle: {type: revolute, axis: [0, 1, 0], parent: world, child: blade}}
)");
  const Holding holding{{}, {{"axle", 2}}};
  const Configuration c(prepared, prepared.scene.initial, holding);
  return {find_equilibrium(c, holding, plugins()), modes_at(c, false)};
}

TEST(Balance, TurnsWithWeightHoweverStiffABladeIs) {
  for (const std::string stiffness : {"200", "2e6", "2e10"}) {
    for (const std::string modes : {"2", "16"}) {
      const TurningBlade under_weight = turning_blade("[0, 0, -9.81]", stiffness, modes);
      EXPECT_EQ(under_weight.equilibrium.problem, "");
      EXPECT_FALSE(under_weight.equilibrium.stays) << stiffness << ' ' << modes;
      EXPECT_FALSE(under_weight.modes.steady->stays.value());
      EXPECT_FALSE(under_weight.modes.turn->check.steady);
      EXPECT_TRUE(under_weight.modes.turn->check.periodic());
      for (const std::string gravity : {"[0, 0, 0]", "[0, -9.81, 0]"}) {
        const TurningBlade even = turning_blade(gravity, stiffness, modes);
        EXPECT_TRUE(even.equilibrium.stays) << stiffness << ' ' << modes << ' ' << gravity;
        EXPECT_TRUE(even.modes.steady->stays.value());
        EXPECT_FALSE(even.modes.turn->check.periodic()) << even.modes.turn->check.change;
      }
    }
  }
}

/// A pendulum on a wheel beside a mast that is a million times stiffer: what the turn does to it is seen.
TEST(Balance, OfASlowMotionIsSeenToTurnBesideFastOnes) {
  const Prepared prepared = scene_of(R"(
gravity: [0, 0, -9.81]
bodies:
  wheel: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  bob: {type: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.3, 0.3, 0, 0, 0]}
  mast: {type: beam, length: 0.3, mass_per_length: 1, bending_y: {stiffness: 1e8, modes: 8}}
hinges:
  axle: {type: revolute, axis: [0, 1, 0], parent: world, child: wheel}
  pin: {type: revolute, axis: [0, 0, 1], parent: wheel, child: bob}
  root: {type: weld, parent: wheel, child: mast}
)");
  const Configuration c(prepared, prepared.scene.initial, Holding{{}, {{"axle", 3}}});
  const ModesAt at = modes_at(c, false);
  EXPECT_LT(at.turn->check.change, 1e-8) << "of the greatest element";
  EXPECT_TRUE(at.turn->check.steady);
  EXPECT_TRUE(at.turn->check.periodic()) << "weight holds the pin, then lets it go";
}

/// A flap on an axle that a motion drives to and fro, and a pendulum on a car that goes from here to there.
TEST(Balance, OfWhatAMotionAcceleratesIsThatOfAnInstant) {
  const Prepared axle = scene_of(R"(
gravity: [0, 0, -9.81]
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {e: {position: [0.2, 0, 0]}}}
  p: {type: rigid, mass: 2, center_of_mass: [1, 0, 0], inertia: [0.01, 0.1, 0.1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  flap: {type: revolute, axis: [0, 1, 0], parent: hub.e, child: p}
motions: {sway: {type: sine, hinge: axle, amplitude: 0.5, period: 2}}
)");
  const Equilibrium swayed = find_equilibrium(at_start(axle), {}, plugins());
  EXPECT_EQ(swayed.problem, "");
  EXPECT_FALSE(swayed.stays);
  EXPECT_THAT(swayed.changing, HasSubstr("motion 'sway' does not go on"));
  EXPECT_FALSE(modes_at(at_start(axle), false).steady->stays.value());

  const Prepared car = scene_of(R"(
gravity: [0, 0, -9.81]
bodies:
  car: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  p: {type: rigid, mass: 2, center_of_mass: [0, 0, -1], inertia: [0.1, 0.1, 0.01, 0, 0, 0]}
hinges:
  rail: {type: prismatic, axis: [1, 0, 0], parent: world, child: car}
  pin: {type: revolute, axis: [0, 1, 0], parent: car, child: p}
motions: {go: {type: quintic, hinge: rail, to: 3, duration: 2}}
)");
  for (const double time : {0.4, 3.0}) {
    State state = car.scene.initial;
    state.time = time;
    car.model().prescribe(state);
    const Configuration c(car, state, {});
    const Equilibrium found = find_equilibrium(c, {}, plugins());
    EXPECT_EQ(found.problem, "") << time;
    EXPECT_EQ(found.stays, time > 2) << found.changing;
    Configuration there = c;
    there.set_state(found.steady.state);
    EXPECT_EQ(linear_model(there, {{"pin"}, {"pin"}}).equilibrium, time > 2) << time;
  }
}

/// The bob on a turning arm swings under weight, on a hinge and with no body that deforms.
TEST(Balance, OverATurnTellsWhatMovesAndByHowMuch) {
  const Prepared prepared = scene_of(R"(
gravity: [0, -9.81, 0]
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {e: {position: [0.5, 0, 0]}}}
  p: {type: rigid, mass: 2, center_of_mass: [1, 0, 0], inertia: [0, 0, 0, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  pin: {type: revolute, axis: [0, 0, 1], parent: hub.e, child: p}
loads: {brake: {type: hinge-spring, hinge: pin, stiffness: 0, damping: 0.3}}
)");
  const Configuration c(prepared, prepared.scene.initial, Holding{{}, {{"axle", 8}}});
  TurningWish wish;
  wish.floquet = true;
  const ModesAt at = modes_at(c, true, wish);
  ASSERT_TRUE(at.turn->floquet.has_value()) << at.turn->problem;
  EXPECT_TRUE(at.turn->moves);
  EXPECT_THAT(at.turn->greatest_displacement, HasSubstr(" rad (pin)"));
  EXPECT_GT(std::stod(at.turn->greatest_displacement), 0.1);
}

/// What a run leaves of the rate of a damped hinge is no motion; of a wheel that nothing pulls there is no such rate.
TEST(Balance, AHingeThatCreepsAboutRestIsAtRest) {
  const auto at_rate = [](const std::string& rate) {
    return scene_of(R"(
bodies:
  arm: {type: rigid, mass: 1, center_of_mass: [0.35, 0, 0], inertia: [0.01, 0.05, 0.05, 0, 0, 0]}
  wheel: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  joint: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}
loads: {spring: {type: hinge-spring, hinge: joint, stiffness: 30, damping: 2}}
initial: {hinges: {joint: {rate: )" +
                    rate + "}, axle: {rate: 1.3e-11}}}\n");
  };
  const Configuration creeping = at_start(at_rate("-1.3e-11"));
  const Equilibrium found = find_equilibrium(creeping, {}, plugins());
  EXPECT_TRUE(found.stays) << found.changing;
  EXPECT_THAT(found.passing, testing::IsEmpty());
  const auto rate = [&](std::size_t hinge) {
    return creeping.state().y[creeping.layout().positions + creeping.layout().hinges[hinge].speed];
  };
  EXPECT_EQ(rate(0), 0);
  EXPECT_EQ(rate(1), 1.3e-11);
  const Equilibrium passing = find_equilibrium(at_start(at_rate("-1e-4")), {}, plugins());
  EXPECT_FALSE(passing.stays);
  EXPECT_THAT(passing.passing, testing::Contains("joint"));
}

}  // namespace
}  // namespace withy::study
