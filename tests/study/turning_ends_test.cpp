// Linear models of what turns, or changes with time, though masses, stiffnesses and what depends on speeds are
// constant: inputs, outputs, sampled loads, loads that act in a narrow part of a turn.
#include "withy/study/turning_ends.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "withy/study/effective_mass.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/formulation_modes.hpp"
#include "withy/study/frequencies.hpp"
#include "withy/study/narrow_loads.hpp"
#include "withy/study/response.hpp"
#include "withy/study/stability.hpp"
#include "withy/study/variation_text.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A mass on a spring in a slot across a rotor that turns at 3 rad/s without weight: its equations are those of
/// v̈ + 0.5 v̇ + (50 − 9) v = F at every angle.
std::string slotted(const std::string& more) {
  return R"(
gravity: [0, 0, 0]
bodies:
  rotor: {type: rigid, mass: 0, inertia: [1, 1, 1, 0, 0, 0], frames: {rim: {position: [1, 0, 0]}}}
  disc: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: rotor}
  slot: {type: prismatic, axis: [0, 1, 0], parent: rotor.rim, child: disc}
motions: {turn: {type: constant-rate, hinge: axle, rate: 3}}
outputs:
  ang: {type: hinge, hinge: axle}
  own: {type: frame, of: disc, in: own, show: velocity}
  seen: {type: frame, of: disc, in: rotor, show: position}
  place: {type: frame, of: disc, show: position}
  m: {type: expression, value: MEASURED}
loads:
  spring: {type: hinge-spring, hinge: slot, stiffness: 50, damping: 0.5}
  push: {type: input, frame: disc, direction: [0, 1, 0]PUSH}
)" + more;
}

Prepared slotted_scene(const std::string& push, const std::string& measured, const std::string& more = "") {
  std::string text = slotted(more);
  text.replace(text.find("MEASURED"), 8, measured);
  text.replace(text.find("PUSH"), 4, push);
  return scene_of(text, {"time.end=20"});
}

TEST(LinearModel, OfARotorNamesOutputsAndInputsThatDoNotTurnWithIt) {
  const Prepared turns_with_it = slotted_scene(", following: true", "seen.y");
  const LinearModel in_rotor = linear_model(at_start(turns_with_it), {{"push"}, {"seen", "own", "m", "slot"}});
  EXPECT_FALSE(in_rotor.frozen) << note_of_frozen(in_rotor);
  EXPECT_THAT(in_rotor.moving_outputs, IsEmpty());
  const LinearModel in_world = linear_model(at_start(turns_with_it), {{"push"}, {"place", "seen"}});
  EXPECT_TRUE(in_world.frozen);
  EXPECT_THAT(in_world.turning_outputs, ElementsAre("place.x", "place.y"));
  EXPECT_THAT(in_world.moving_outputs, ElementsAre("place.x", "place.y"));
  EXPECT_THAT(in_world.turning_inputs, IsEmpty());
  EXPECT_THAT(note_of_frozen(in_world), HasSubstr("in: own"));
  const LinearModel pushed = linear_model(at_start(slotted_scene("", "seen.y")), {{"push"}, {"seen"}});
  EXPECT_THAT(pushed.turning_inputs, ElementsAre("push"));
  EXPECT_THAT(pushed.turning_outputs, IsEmpty());
  EXPECT_THAT(note_of_frozen(pushed), HasSubstr("following: true"));
  // The angle goes on, and deviations from that have a model.
  const LinearModel of_angle = linear_model(at_start(turns_with_it), {{"push"}, {"axle.0"}});
  EXPECT_FALSE(of_angle.frozen);
  EXPECT_THAT(of_angle.moving_outputs, ElementsAre("axle.0"));
}

TEST(LinearModel, OfAnOutputThatTimeChangesNamesIt) {
  const LinearModel m =
      linear_model(at_start(slotted_scene(", following: true", "(1 + cos(2*t))*seen.y")), {{"push"}, {"m", "seen"}});
  EXPECT_TRUE(m.frozen);
  EXPECT_THAT(m.timed_outputs, ElementsAre("m"));
  EXPECT_THAT(m.turning_outputs, IsEmpty());
}

/// A disc on a gimbal turns at 60 rad/s: seen from its gimbal and from the world it is the same at every angle.
TEST(LinearModel, OfARotorWithTwoEqualInertiasTurnsNowhere) {
  const Prepared prepared = scene_of(R"(
gravity: [0, 0, 0]
bodies:
  arm: {type: rigid, mass: 0, frames: {top: {position: [0, 0, 0.5]}}}
  disc: {type: rigid, mass: 12, inertia: [0.8, 0.8, 1.3, 0, 0, 0]}
hinges:
  g: {type: universal, first_axis: [1, 0, 0], second_axis: [0, 1, 0], parent: world, child: arm}
  shaft: {type: revolute, axis: [0, 0, 1], parent: arm.top, child: disc}
loads:
  a: {type: hinge-spring, hinge: g, component: 0, stiffness: 900}
  b: {type: hinge-spring, hinge: g, component: 1, stiffness: 900}
  act: {type: input, frame: arm.top, direction: [1, 0, 0]}
outputs:
  place: {type: frame, of: disc, show: position}
  box: {type: accelerometer, of: arm.top}
  bearing: {type: reaction, hinge: g}
)");
  const Configuration c(prepared, prepared.scene.initial, {{}, {{"shaft", 60}}});
  const LinearModel m = linear_model(c, {{"act"}, {"place", "box", "bearing"}});
  EXPECT_FALSE(m.frozen) << note_of_frozen(m);
  EXPECT_THAT(m.moving_outputs, IsEmpty());
  EXPECT_TRUE(response(c, {"act", "place.x", {}, {}, 20, {}}).margins.has_value());
}

TEST(Response, OfWhatTurnsHasNoMargins) {
  const Prepared prepared = slotted_scene(", following: true", "seen.y");
  const Response r = response(at_start(prepared), {"push", "place.y", {}, {}, 20, {}});
  EXPECT_TRUE(r.model.frozen);
  EXPECT_FALSE(r.margins.has_value());
  const Response seen = response(at_start(prepared), {"push", "seen.y", {}, {}, 20, {}});
  EXPECT_TRUE(seen.margins.has_value());
  EXPECT_NEAR(seen.static_gain, 1.0 / 41, 1e-12);
}

TEST(Response, OfEquationsThatALoadChangesWithTimeHasNoMargins) {
  const Prepared prepared = scene_of(R"(
gravity: [0, -9.81, 0]
bodies: {b: {type: rigid, mass: 1, center_of_mass: [0, -1, 0], inertia: [0.01, 0.01, 0.01, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}
loads:
  x: {type: base-excitation, law: sine, amplitude: [0, 3, 0], period: 1}
  u: {type: input, hinge: h}
)");
  const Response r = response(at_start(prepared), {"u", "h.0", {}, {}, 20, {}});
  EXPECT_TRUE(r.model.frozen);
  EXPECT_FALSE(r.margins.has_value());
}

/// \param more of the law
Prepared sampled_rotor(const std::string& measured, const std::string& more = "") {
  return slotted_scene(", following: true", measured,
                       "  law: {type: pid, of: m, to: push, proportional: 30, sample: 0.002" + more + "}\n");
}

TEST(SampledLoads, WhoseGainTurnsTellNoStability) {
  const Prepared prepared = sampled_rotor("cos(ang.position)*seen.y");
  const Equilibrium found = find_equilibrium(at_start(prepared), {}, test::plugins());
  EXPECT_TRUE(found.stays) << found.changing;
  ASSERT_TRUE(found.stability.has_value());
  EXPECT_FALSE(found.stability->unknown.empty());
  const ModesAt at = modes_at(at_start(prepared), false);
  EXPECT_TRUE(at.frozen());
  EXPECT_THAT(turn_text(*at.turn), HasSubstr("'law'"));
  const LinearModel m = linear_model(at_start(prepared), {{"slot"}, {"seen"}});
  EXPECT_TRUE(m.frozen);
  EXPECT_THAT(m.turning_loads, ElementsAre("law"));
  const Response opened = response(at_start(prepared), {"law", "", {}, {}, 20, {}});
  EXPECT_FALSE(opened.margins.has_value());
}

TEST(SampledLoads, WhoseCommandTurnsAreBalancedAtOneAngleAlone) {
  const Prepared prepared = sampled_rotor("seen.y + 0.1*sin(ang.position)");
  const Equilibrium found = find_equilibrium(at_start(prepared), {}, test::plugins());
  EXPECT_FALSE(found.stays);
  EXPECT_FALSE(found.stability.has_value());
  EXPECT_THAT(found.changing, HasSubstr("'law'"));
}

TEST(SampledLoads, ThatChangeWithTimeAreNamed) {
  for (const auto& [measured, more] : std::vector<std::pair<std::string, std::string>>{
           {"seen.y + 0.1*sin(2*t)", ""}, {"seen.y", ", reference: [[0, 0], [10, 1]]"}}) {
    const Equilibrium found = find_equilibrium(at_start(sampled_rotor(measured, more)), {}, test::plugins());
    EXPECT_FALSE(found.stays) << measured << more;
    EXPECT_THAT(found.changing, HasSubstr("'law' changes with time")) << measured << more;
  }
  const Equilibrium found = find_equilibrium(at_start(sampled_rotor("(1 + cos(2*t))*seen.y")), {}, test::plugins());
  EXPECT_TRUE(found.stays) << found.changing;
  ASSERT_TRUE(found.stability.has_value());
  EXPECT_THAT(found.stability->unknown, HasSubstr("'law' changes the equations of small motions with time"));
}

TEST(SampledLoads, ThatTurnWithTheRotorTellStability) {
  const Prepared prepared = sampled_rotor("seen.y");
  const Equilibrium found = find_equilibrium(at_start(prepared), {}, test::plugins());
  EXPECT_TRUE(found.stays) << found.changing;
  ASSERT_TRUE(found.stability.has_value());
  EXPECT_TRUE(found.stability->stable()) << found.stability->unknown;
  EXPECT_FALSE(linear_model(at_start(prepared), {{"slot"}, {"seen"}}).frozen);
}

/// A flapping blade that a pulse of ±1.3 deg drives on once a turn. By averaging, with β̈ + (c/I) β̇ + ω² β = 0, it grows
/// by −mean(c)/2I, and the mean of exp(−8000 cos²(ψ/2)) is e^−4000 I₀(4000) = 1/√(8000 π) but for 1/32000 of itself.
TEST(NarrowLoads, AreSeenAndResolvedOverAWholeTurn) {
  const Prepared prepared = scene_of(R"(
gravity: [0, 0, 0]
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {h: {position: [0.3, 0, 0]}}}
  blade: {type: rigid, mass: 30, center_of_mass: [2.5, 0, 0], inertia: [1, 62.5, 62.5, 0, 0, 0]}
hinges:
  shaft: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  flap: {type: revolute, axis: [0, -1, 0], parent: hub.h, child: blade}
loads: {air: {type: expression, hinge: flap, value: "-20*flap.rate + 20000*exp(-8000*cos(shaft/2)^2)*flap.rate"}}
)");
  const Configuration c(prepared, prepared.scene.initial, {{}, {{"shaft", 30}}});
  const ModesAt frozen = modes_at(c, false);
  EXPECT_TRUE(frozen.frozen());
  EXPECT_THAT(turn_text(*frozen.turn), HasSubstr("'air' acts in a narrow part"));
  TurningWish wish;
  wish.floquet = true;
  const ModesAt at = modes_at(c, false, wish);
  ASSERT_TRUE(at.turn && at.turn->floquet) << at.turn->problem;
  EXPECT_FALSE(at.turn->floquet->stable);
  const double inertia = 62.5 + 30 * 2.5 * 2.5;
  const double mean = 20000 / std::sqrt(8000 * M_PI) * (1 + 1.0 / 32000) - 20;
  EXPECT_NEAR(at.turn->floquet->modes.front().exponent.real(), mean / (2 * inertia), 1e-3 * mean / (2 * inertia));
}

/// A blade to one side of a shaft on a base that gives way: its equations change over a turn.
const std::string one_blade = R"(
gravity: [0, 0, 0]
bodies:
  base: {type: rigid, mass: 5}
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  blade: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 40, modes: 2}}
hinges:
  y: {type: prismatic, axis: [0, 1, 0], parent: world, child: base}
  shaft: {type: revolute, axis: [0, 0, 1], parent: base, child: hub}
  root: {type: weld, parent: hub, child: blade}
loads: {ky: {type: hinge-spring, hinge: y, stiffness: 900}}
)";

TEST(Frequencies, OfWhatTurnsAreThoseOfOneAngleAndSaySo) {
  const Prepared prepared = scene_of(one_blade);
  FrequencyQuestion question;
  question.points = {{"quadratic", "", 2, "dopri5", 1e-6, {}}};
  question.sweep = parse_sweep("spin.shaft=0:0.5:3", "over");
  question.count = 1;
  FrequencyStudy study(prepared, test::plugins(), question);
  for (const double value : question.sweep.values)
    static_cast<void>(study.reference_frequency(study.names().front(), value));
  EXPECT_EQ(study.frozen_from(), 0.25);
}

TEST(MountedDamping, OfWhatTurnsIsThatOfOneAngleAndSaysSo) {
  const Prepared prepared = scene_of(one_blade);
  for (const bool turns : {false, true}) {
    ModesQuestion question;
    question.compared = 0;
    question.damp = {0.01};
    if (turns) question.holding.spun = {{"shaft", 0.25}};
    if (!turns) question.holding.locked = {"shaft"};
    const ModesFound found =
        find_modes(prepared, test::plugins(), question, [](const std::string&) { return Control(); });
    ASSERT_TRUE(found.damping.has_value());
    EXPECT_EQ(found.damping->frozen, turns);
  }
}

TEST(EffectiveMass, OfWhatTurnsIsThatOfOneAngleAndSaysSo) {
  const Prepared prepared = slotted_scene(", following: true", "seen.y");
  EXPECT_TRUE(effective_masses(at_start(prepared)).turning);
  const Prepared along = scene_of(R"(
bodies: {disc: {type: rigid, mass: 2, inertia: [1, 1, 2, 0, 0, 0]}, base: {type: rigid, mass: 1}}
hinges:
  x: {type: prismatic, axis: [1, 0, 0], parent: world, child: base}
  shaft: {type: revolute, axis: [0, 0, 1], parent: base, child: disc}
loads: {spring: {type: hinge-spring, hinge: x, stiffness: 9}}
)");
  EXPECT_FALSE(effective_masses({along, along.scene.initial, {{}, {{"shaft", 5}}}}).turning);
}

}  // namespace
}  // namespace withy::study
