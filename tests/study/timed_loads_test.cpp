// Loads that change small motions with time or with an angle, told from those of which a displacement's square changes.
#include "withy/study/timed_loads.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "withy/study/equilibrium.hpp"
#include "withy/study/felt_states.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/stability.hpp"
#include "withy/study/turning.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Two hinges that have nothing to do with each other, and a load on each.
LinearModel of_two_hinges(const std::string& soft, const std::string& hard) {
  return linear_model(at_start(scene_of(R"(
bodies:
  arm: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  stiff: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  h: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}
  s: {type: prismatic, axis: [1, 0, 0], parent: world, child: stiff}
loads:
  soft: {type: expression, hinge: h, value: ")" +
                                            soft + R"("}
  hard: {type: expression, hinge: s, value: ")" +
                                            hard + R"("}
)",
                                        {"time.end=16"})),
                      {{"h"}, {"h"}});
}

/// Parametric resonance grows, whatever spring another body has.
TEST(TimedLoads, ThatChangeSmallMotionsAreSeenBesideWhatIsStiffElsewhere) {
  for (const std::string hard : {"-1000*s", "-1e7*s", "-1e12*s", "-2e5*s + sin(t)"}) {
    const LinearModel m = of_two_hinges("-10*(1 + 0.5*sin(6.3*t))*h", hard);
    EXPECT_TRUE(m.frozen) << hard;
    EXPECT_THAT(m.shaking, ElementsAre("soft")) << hard;
  }
}

/// A stiffness that is negative for half a second.
TEST(TimedLoads, ThatChangeSmallMotionsForAShortTimeAreSeenWheneverThatIs) {
  for (const std::string at : {"4.23", "5.23", "5.73", "10.2", "14.77"}) {
    const LinearModel m = of_two_hinges("-10*(1 - 2*max(0, 1 - abs(t - " + at + ")/0.49))*h", "-100*s");
    EXPECT_THAT(m.shaking, ElementsAre("soft")) << at;
  }
}

/// What has no derivative at rest has none at any time.
TEST(TimedLoads, OfWhichTimeChangesTheSquareOfASpeedLeaveSmallMotions) {
  for (const std::string square : {"h.rate*abs(h.rate)", "h*h", "h*h.rate*h", "1e6*h.rate*abs(h.rate)"}) {
    const LinearModel m = of_two_hinges("-10*h - (1 + 0.3*sin(t))*" + square, "-100*s");
    EXPECT_FALSE(m.frozen) << square;
    EXPECT_THAT(m.shaking, IsEmpty()) << square;
  }
}

TEST(TimedLoads, ThatMakeUpForEachOtherLeaveSmallMotions) {
  const auto shaking = [](const std::string& other) {
    return linear_model(at_start(scene_of(R"(
bodies: {arm: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}}
loads:
  one: {type: expression, hinge: h, value: "-10*sin(t)^2*h"}
  other: {type: expression, hinge: h, value: ")" +
                                          other + R"("}
)")),
                        {{"h"}, {"h"}})
        .shaking;
  };
  EXPECT_THAT(shaking("-10*cos(t)^2*h"), IsEmpty());
  EXPECT_THAT(shaking("-11*cos(t)^2*h"), ElementsAre("one", "other"));
}

/// A blade that slides along the axle it turns about at 2 rad/s. \param loads beside its spring
Prepared sliding_blade(const std::string& loads) {
  return scene_of(R"(
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  blade: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [1, 0, 0], parent: world, child: hub}
  flap: {type: prismatic, axis: [1, 0, 0], parent: hub, child: blade}
loads:
  stay: {type: expression, hinge: flap, value: "-10*flap"}
)" + loads,
                  {"time.end=10"});
}
const std::string sliding_drag =
    "  drag: {type: expression, hinge: flap, value: \"-(1 + 0.3*sin(axle))*flap.rate*abs(flap.rate)\"}\n";
const std::string sliding_square =
    "  square: {type: expression, hinge: flap, value: \"-(1 + 0.3*sin(axle))*flap*flap\"}\n";
const std::string sliding_shadow =
    "  shadow: {type: expression, hinge: flap, value: \"5*max(0, 1 - (1 + cos(axle))/0.001)\"}\n";

Configuration turned(const Prepared& prepared) { return {prepared, prepared.scene.initial, {{}, {{"axle", 2.0}}}}; }

TEST(NarrowLoads, OfWhichTheAngleChangesTheSquareOfASpeedLeaveSmallMotions) {
  const Prepared prepared = sliding_blade(sliding_drag);
  const ModesAt at = modes_at(turned(prepared), false);
  ASSERT_TRUE(at.turn.has_value());
  EXPECT_THAT(at.turn->narrow, IsEmpty());
  EXPECT_FALSE(at.frozen());
  const Equilibrium found = find_equilibrium(turned(prepared), {}, test::plugins());
  ASSERT_TRUE(found.stability.has_value());
  EXPECT_THAT(found.stability->unknown, IsEmpty());
}

/// A push within 3 degrees of half a turn, behind angles at which others bend more.
TEST(NarrowLoads, ThatPushAreNamedBesideThoseOfWhichTheAngleChangesASquare) {
  for (const std::string& other : {sliding_drag, sliding_square}) {
    const Prepared prepared = sliding_blade(other + sliding_shadow);
    const ModesAt at = modes_at(turned(prepared), false);
    ASSERT_TRUE(at.turn.has_value());
    EXPECT_EQ(at.turn->narrow, "shadow") << other;
    const Equilibrium found = find_equilibrium(turned(prepared), {}, test::plugins());
    EXPECT_FALSE(found.stays) << other;
    EXPECT_THAT(found.changing, HasSubstr("'shadow'")) << other;
  }
}

/// The square is another at every instant, the derivative for three seconds of the run alone.
TEST(Outputs, WhoseDerivativesTimeChangesLateAreSeenBehindSquaresThatItChangesBefore) {
  const auto timed = [](const std::string& more) {
    return linear_model(at_start(scene_of(R"(
bodies: {b: {type: rigid, mass: 1}}
hinges: {s: {type: prismatic, axis: [1, 0, 0], parent: world, child: b}}
loads: {k: {type: hinge-spring, hinge: s, stiffness: 10}}
outputs:
  at: {type: hinge, hinge: s}
  m: {type: expression, value: "at.position^2*(2 + sin(t)))" +
                                              more + "\"}\n",
                                          {"time.end=20"})),
                        {{"s"}, {"m"}})
        .timed_outputs;
  };
  EXPECT_THAT(timed(""), IsEmpty());
  EXPECT_THAT(timed(" + at.position*max(0, 1 - abs(t - 12.5)/1.5)"), ElementsAre("m"));
}

/// An integral of what `signal` says of the hinge acts on it: time changes the rate of a controller's state, and its
/// effort by that state alone.
Prepared with_integral_of(const std::string& signal) {
  return scene_of(R"(
bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}
outputs: {q: {type: hinge, hinge: h}, e: {type: expression, value: ")" +
                      signal + R"("}}
loads:
  s: {type: hinge-spring, hinge: h, stiffness: 1, damping: 1}
  c: {type: pid, of: e, hinge: h, integral: 0.5}
)",
                  {"time.end=60"});
}

TEST(TimedLoads, OfWhichTimeChangesTheRatesOfTheirOwnStatesAlone) {
  const auto seen = [](const std::string& signal) {
    const Configuration c = at_start(with_integral_of(signal));
    return timed_loads(c, c.state(), check_turn(c.dynamics(), c.state(), c.held()).turning, Shaken::all);
  };
  const TimedLoads still = seen("q.position"), shaken = seen("q.position*(1 + 0.9*sin(2*t))"),
                   pushed = seen("q.position - 0.3*sin(t)");
  EXPECT_THAT(still.pushing, IsEmpty());
  EXPECT_THAT(still.shaking, IsEmpty());
  EXPECT_THAT(shaken.pushing, IsEmpty());
  EXPECT_THAT(shaken.shaking, ElementsAre("c"));
  EXPECT_THAT(pushed.pushing, ElementsAre("c"));
  EXPECT_THAT(pushed.shaking, IsEmpty());
  EXPECT_TRUE(linear_model(at_start(with_integral_of("q.position*(1 + 0.9*sin(2*t))")), {{"h"}, {"h.0"}}).frozen);
  EXPECT_FALSE(linear_model(at_start(with_integral_of("q.position - 0.3*sin(t)")), {{"h"}, {"h.0"}}).frozen);
  EXPECT_TRUE(find_equilibrium(at_start(with_integral_of("q.position")), {}, test::plugins()).stays);
  EXPECT_FALSE(find_equilibrium(at_start(with_integral_of("q.position - 0.3*sin(t)")), {}, test::plugins()).stays);
}

/// A pendulum that hangs at rest, with more loads and outputs.
Prepared hanging(const std::string& loads, const std::string& outputs = "") {
  return scene_of(R"(
gravity: [0, -9.81, 0]
bodies: {l1: {type: rigid, mass: 1.2, center_of_mass: [0.15, 0, 0], inertia: [0.002, 0.01, 0.011, 0, 0, 0]}}
hinges: {j: {type: revolute, axis: [0, 0, 1], parent: world, child: l1}}
initial: {hinges: {j: {position: ["-90 deg"]}}}
loads:
  d: {type: hinge-spring, hinge: j, stiffness: 0, damping: 0.05}
)" + loads + (outputs.empty() ? "" : "outputs:\n" + outputs),
                  {"time.end=20"});
}

/// Its first link is to follow a sine by a controller with states, the second hangs on it.
Prepared following() {
  return scene_of(R"(
gravity: [0, -9.81, 0]
bodies:
  l1: {type: rigid, mass: 1.2, center_of_mass: [0.15, 0, 0], inertia: [0.002, 0.01, 0.011, 0, 0, 0], frames: {out: {position: [0.3, 0, 0]}}}
  l2: {type: rigid, mass: 1.2, center_of_mass: [0.15, 0, 0], inertia: [0.002, 0.01, 0.011, 0, 0, 0]}
hinges:
  j: {type: revolute, axis: [0, 0, 1], parent: world, child: l1}
  k: {type: revolute, axis: [0, 0, 1], parent: l1.out, child: l2}
initial: {hinges: {j: {position: ["-90 deg"]}}}
loads:
  dk: {type: hinge-spring, hinge: k, stiffness: 2, damping: 0.05}
  ref: {type: expression, to: nothing, value: j + pi/2 - 0.3 * sin(2 * t)}
  c: {type: pid, of: ref, hinge: j, proportional: 10, derivative: 1, filter: 0.05, integral: 5}
)",
                  {"time.end=20"});
}

Equilibrium found_of(const Prepared& prepared, const Holding& holding = {}) {
  return find_equilibrium({prepared, prepared.scene.initial, holding}, holding, test::plugins());
}

/// What time changes alone, and a filter of it.
const std::string filtered_sine = R"(  s: {type: expression, to: nothing, value: sin(t)}
  f: {type: filter, of: s, cutoff: 2, to: nothing}
)";

void expect_stable(const Equilibrium& found) {
  EXPECT_TRUE(found.stays) << found.changing;
  ASSERT_TRUE(found.stability.has_value());
  EXPECT_THAT(found.stability->unknown, IsEmpty());
  EXPECT_EQ(found.stability->growing, 0U);
}

/// What holds the hinge bears what the controller does, and its states act on nothing else.
TEST(TimedLoads, WhoseStatesActOnAHeldHingeLeaveAStateThatStays) {
  const Prepared prepared = following();
  expect_stable(found_of(prepared, {{"j"}, {}}));
  const Equilibrium free = found_of(prepared);
  EXPECT_FALSE(free.stays);
  EXPECT_THAT(free.changing, HasSubstr("The load 'ref' changes with time"));
}

TEST(TimedLoads, WhoseStatesNothingFeelsLeaveAStateThatStays) {
  expect_stable(found_of(hanging(filtered_sine)));
  expect_stable(found_of(hanging(filtered_sine, "  shown: {type: control, of: f}\n")));
  // A sampled load that acts on nothing is nothing that is free, whatever it measures.
  expect_stable(
      found_of(hanging(filtered_sine + "  n: {type: filter, of: f, cutoff: 2, to: nothing, sample: 0.01}\n")));
  expect_stable(found_of(hanging(R"(  s: {type: expression, to: nothing, value: sin(t)}
  f: {type: filter, of: s, cutoff: 2, to: nothing, sample: 0.01}
  n: {type: filter, of: f, cutoff: 2, to: nothing, sample: 0.01}
)")));
}

/// Through another filter, a sampled one, and as a factor that does nothing at the state itself. The load is named that
/// has the time, and what measures it goes with it.
TEST(TimedLoads, AreNamedThatWhatIsFreeFeelsThroughTheStatesOfOthers) {
  for (const std::string other :
       {"g: {type: filter, of: f, cutoff: 2, hinge: j}", "g: {type: filter, of: f, cutoff: 2, hinge: j, sample: 0.01}",
        "g: {type: expression, hinge: j, value: -f*(j + pi/2)}"}) {
    const std::string loads = filtered_sine + "  " + other + "\n";
    const Equilibrium found = found_of(hanging(loads));
    EXPECT_FALSE(found.stays) << other;
    EXPECT_THAT(found.changing, HasSubstr("The load 's' changes with time")) << other;
    EXPECT_THAT(found.changing, HasSubstr("Take it away with what measures it (--set loads.s=null --set loads.f=null "
                                          "--set loads.g=null), or choose the time that is meant (--at)."))
        << other;
    SceneValues values = hanging(loads).values;
    for (const char* load : {"s", "f", "g"}) values.set_text(std::string("loads.") + load + "=null");
    expect_stable(found_of(prepare(std::move(values), test::plugins())));
    // An output that shows one of them would be left with nothing to show.
    const Equilibrium shown = found_of(hanging(loads, "  shown: {type: control, of: f}\n"));
    EXPECT_THAT(shown.changing, HasSubstr("no state that stays. Choose the time that is meant (--at)."));
    EXPECT_THAT(shown.changing, testing::Not(HasSubstr("--set")));
  }
}

TEST(TimedLoads, ThatActByThemselvesAreTakenAwayAlone) {
  const Equilibrium found = found_of(hanging("  push: {type: expression, hinge: j, value: 0.3*sin(t)}\n"));
  EXPECT_FALSE(found.stays);
  EXPECT_THAT(found.changing, HasSubstr("The load 'push' changes with time"));
  EXPECT_THAT(found.changing, HasSubstr("Take it away (--set loads.push=null), or choose"));
}

/// What a state that nothing feels takes from others is seen by who looks at it, and leaves growth and decay.
TEST(TimedLoads, ThatShakeStatesThatNothingFeelsLeaveGrowth) {
  const auto shaken = [](const std::string& to, const std::string& value) {
    return hanging("  s: {type: expression, to: nothing, value: " + value +
                   "}\n  f: {type: filter, of: s, cutoff: 2, " + to + "}\n");
  };
  const auto seen = [](const Prepared& prepared, Shaken what) {
    const Configuration c = at_start(prepared);
    return timed_loads(c, c.state(), check_turn(c.dynamics(), c.state(), c.held()).turning, what).shaking;
  };
  const Prepared unfelt = shaken("to: nothing", "(j + pi/2)*sin(t)"), felt = shaken("hinge: j", "(j + pi/2)*sin(t)");
  EXPECT_THAT(seen(unfelt, Shaken::all), ElementsAre("f"));
  EXPECT_THAT(seen(unfelt, Shaken::growth), IsEmpty());
  EXPECT_THAT(seen(felt, Shaken::growth), ElementsAre("f"));
  expect_stable(found_of(unfelt));
  EXPECT_TRUE(linear_model(at_start(unfelt), {{"j"}, {"j"}}).frozen);
  const Equilibrium found = found_of(felt);
  EXPECT_TRUE(found.stays);
  ASSERT_TRUE(found.stability.has_value());
  EXPECT_THAT(found.stability->unknown, HasSubstr("the load 's' changes the equations of small motions with time"));
}

TEST(FeltStates, ActOnWhatIsFreeAtOnceOrThroughOthers) {
  const auto felt = [](const Prepared& prepared, const Holding& holding = {}) {
    const Configuration c(prepared, prepared.scene.initial, holding);
    return felt_states(c, c.state(), check_turn(c.dynamics(), c.state(), c.held()).turning);
  };
  EXPECT_THAT(felt(following()).continuous, ElementsAre(true, true));
  EXPECT_THAT(felt(following(), {{"j"}, {}}).continuous, ElementsAre(false, false));
  EXPECT_THAT(felt(hanging(filtered_sine)).continuous, ElementsAre(false));
  const FeltStates through =
      felt(hanging(filtered_sine + "  g: {type: filter, of: f, cutoff: 2, hinge: j, sample: 0.01}\n"
                                   "  n: {type: filter, of: f, cutoff: 2, to: nothing, sample: 0.01}\n"));
  EXPECT_THAT(through.continuous, ElementsAre(true));
  EXPECT_THAT(through.sampled, ElementsAre(true, false));
}

}  // namespace
}  // namespace withy::study
