// Whether steady states last: what small motions about them do, whether they go on where hinges slide, and whether
// those of a sweep continue each other.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "withy/study/bent.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/variation_text.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;
using testing::Not;

Equilibrium balance_of(const std::string& scene, const Holding& holding = {},
                       const std::vector<std::string>& changes = {}) {
  const Prepared prepared = scene_of(scene, changes);
  return find_equilibrium({prepared, prepared.scene.initial, holding}, holding, plugins());
}

/// m g l = 9.81 N m about a pivot with J = 0.1 + 2 · 0.25 = 0.6 kg m².
const std::string rigid_pendulum = R"(
gravity: [0, -9.81, 0]
bodies: {bob: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: bob}}
)";

TEST(Stability, OfAPendulumIsToldWhereItHangsAndWhereItStands) {
  const Equilibrium standing = balance_of(rigid_pendulum, {}, {"initial={hinges: {pivot: {position: [1.5]}}}"});
  ASSERT_EQ(standing.problem, "");
  ASSERT_TRUE(standing.stability.has_value());
  EXPECT_EQ(standing.stability->growing, 1U);
  EXPECT_FALSE(standing.stability->stable());
  EXPECT_NEAR(standing.stability->growth, std::sqrt(9.81 / 0.6), 1e-9);
  EXPECT_EQ(standing.stability->most, "pivot.0");
  EXPECT_FALSE(standing.stability->vibrates);
  EXPECT_THAT(stability_text(standing.stability),
              HasSubstr("a small motion about it grows by 4.04/s, most in pivot.0"));

  const Equilibrium hanging = balance_of(rigid_pendulum, {}, {"initial={hinges: {pivot: {position: [-1.5]}}}"});
  ASSERT_TRUE(hanging.stability.has_value());
  EXPECT_TRUE(hanging.stability->stable());
  EXPECT_THAT(stability_text(hanging.stability), HasSubstr("stable"));
  // Nothing is free to move.
  EXPECT_FALSE(balance_of(rigid_pendulum, {{"pivot"}, {}}).stability.has_value());
}

/// θ and ω over T = 0.02 s with the torque −k θ held: the product of the multipliers is 1 + k T²/2J.
TEST(Stability, OfASampledLoopIsThatOfItsMap) {
  const Equilibrium found = balance_of(R"(
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads: {servo: {type: pid, hinge: axle, proportional: 5, sample: 0.02}}
)");
  ASSERT_TRUE(found.stability.has_value());
  EXPECT_EQ(found.stability->growing, 1U);
  EXPECT_TRUE(found.stability->vibrates);
  EXPECT_NEAR(found.stability->growth, std::log(1 + 5 * 0.02 * 0.02 / (2 * 0.2)) / (2 * 0.02), 1e-8);
}

TEST(Stability, DoesNotTakeWhatNothingHoldsForWhatGrows) {
  const Equilibrium found = balance_of(R"(
bodies: {car: {type: rigid, mass: 4, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {rail: {type: prismatic, axis: [1, 0, 0], parent: world, child: car}}
)");
  ASSERT_TRUE(found.stability.has_value());
  EXPECT_EQ(found.stability->growing, 0U);
  EXPECT_EQ(found.stability->unheld, 1U);
  EXPECT_THAT(stability_text(found.stability), HasSubstr("nothing holds"));
}

/// A car that slides past the anchor of a spring: beside the anchor the pull is at its greatest, and its derivative
/// along the way is zero.
const std::string sliding = R"(
bodies:
  c: {type: rigid, mass: 1}
  m: {type: rigid, mass: 1}
hinges:
  x: {type: prismatic, axis: [1, 0, 0], parent: world, child: c}
  y: {type: prismatic, axis: [0, 1, 0], parent: c, child: m}
loads:
  k: {type: hinge-spring, hinge: y, stiffness: 50}
)";
const std::string anchored =
    "loads.s={type: spring-damper, frame: m, anchor: [0, -1, 0], stiffness: 100, free_length: 0.5}";

TEST(Balance, WhereAHingeSlidesPastWhatPullsIsThatOfAPlace) {
  const Holding moving{{}, {{"x", 0.5}}};
  for (const std::string at : {"0", "0.3"}) {
    const Equilibrium found =
        balance_of(sliding, moving, {anchored, "initial={hinges: {x: {position: [" + at + "]}}}"});
    EXPECT_EQ(found.problem, "");
    EXPECT_FALSE(found.stays) << at;
    EXPECT_THAT(found.changing, HasSubstr("steady at this place alone")) << at;
    EXPECT_FALSE(found.stability.has_value());
  }
  EXPECT_TRUE(balance_of(sliding, moving).stays) << "a spring that goes along";
  EXPECT_TRUE(balance_of(sliding, {{"x"}, {}}, {anchored}).stays) << "it stands";
}

/// A rotor of n rigid blades on a soft bed: forces of the blades make up for each other, all free coordinates are zero.
std::string balanced_rotor(int blades) {
  std::string frames, bodies, hinges, loads;
  for (int i = 0; i < blades; ++i) {
    const std::string n = std::to_string(i);
    const double angle = 2 * std::acos(-1.0) * i / blades;
    frames +=
        fmt::format("{}p{}: {{position: [{:.17g}, {:.17g}, 0], orientation: {{axis: [0, 0, 1], angle: {:.17g} deg}}}}",
                    i > 0 ? ", " : "", n, 0.3 * std::cos(angle), 0.3 * std::sin(angle), 360.0 * i / blades);
    bodies += "  b" + n + ": {type: rigid, mass: 1, center_of_mass: [2, 0, 0], inertia: [0.01, 1, 1, 0, 0, 0]}\n";
    hinges += "  l" + n + ": {type: revolute, axis: [0, 0, 1], parent: hub.p" + n + ", child: b" + n + "}\n";
    loads += "  k" + n + ": {type: hinge-spring, hinge: l" + n + ", stiffness: 20, damping: 0.4}\n";
  }
  return R"(
bodies:
  bx: {type: rigid, mass: 5}
  by: {type: rigid, mass: 15}
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {)" +
         frames + "}}\n" + bodies + R"(hinges:
  x: {type: prismatic, axis: [1, 0, 0], parent: world, child: bx}
  y: {type: prismatic, axis: [0, 1, 0], parent: bx, child: by}
  rot: {type: revolute, axis: [0, 0, 1], parent: by, child: hub}
)" + hinges +
         R"(loads:
  kx: {type: hinge-spring, hinge: x, stiffness: 2000, damping: 4}
  ky: {type: hinge-spring, hinge: y, stiffness: 3000, damping: 4}
)" + loads;
}

/// What rounding leaves of 690 N that cancel moves the bed by more than a share of nothing.
TEST(Balance, OfForcesThatMakeUpForEachOtherAboutZeroIsFound) {
  for (const int blades : {3, 4, 6, 8}) {
    for (const double rate : {3.0, 10.0, 31.7}) {
      const Holding spun{{}, {{"rot", rate}}};
      const Prepared prepared = scene_of(balanced_rotor(blades));
      const Configuration c(prepared, prepared.scene.initial, spun);
      const SteadyState found = find_steady_state(c.dynamics(), c.state(), c.held());
      EXPECT_TRUE(found.converged) << blades << " blades at " << rate;
      EXPECT_LT(found.iterations, 10) << blades << " blades at " << rate;
      EXPECT_LT(std::abs(found.state.y[0]) + std::abs(found.state.y[1]), 1e-14) << "[m]";
    }
  }
}

/// A bob between a wall and a spring that is too long: pushed through the middle it snaps where d³ = L₀, d² = 1 + y²,
/// at a push of k (L₀/d − 1) y = 0.4975 N.
const std::string arch = R"(
bodies: {m: {type: rigid, mass: 1}}
hinges: {y: {type: prismatic, axis: [0, 1, 0], parent: world, child: m}}
loads:
  s: {type: spring-damper, frame: m, anchor: [1, 0, 0], stiffness: 100, free_length: 1.04403}
  p: {type: force, frame: m, value: [0, 0, 0]}
initial: {hinges: {y: {position: [0.3]}}}
)";

TEST(Sweep, SaysWhereItsStatesDoNotContinueEachOther) {
  const double d = std::cbrt(1.04403), snap = 100 * (1.04403 / d - 1) * std::sqrt(d * d - 1);
  EXPECT_NEAR(snap, 0.4975, 1e-4);
  const Sweep sweep = parse_sweep("loads.p.value.1=0:-0.8:9", "sweep");
  const ModesOf run = sweep_modes(scene_of(arch).values, plugins(), {}, {}, sweep, false, {}, {});
  ASSERT_EQ(run.points.size(), 9U);
  for (std::size_t k = 0; k < run.points.size(); ++k) {
    EXPECT_EQ(run.points[k].problem, "");
    const bool passes = k > 0 && -sweep.values[k - 1] < snap && -sweep.values[k] > snap;
    EXPECT_EQ(run.points[k].jump == Jump::no_way_back, passes) << sweep.values[k];
    if (!passes) {
      EXPECT_EQ(run.points[k].jump, Jump::none) << sweep.values[k];
    }
  }
}

/// Where nothing is bent there and back, nor along a line that nothing holds, no sweep jumps.
TEST(Sweep, OfStatesThatContinueEachOtherSaysNothing) {
  const std::string drifting = R"(
gravity: [0, -9.81, 0]
bodies:
  car: {type: rigid, mass: 4, inertia: [1, 1, 1, 0, 0, 0]}
  bob: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  rail: {type: prismatic, axis: [1, 0, 0], parent: world, child: car}
  pivot: {type: revolute, axis: [0, 0, 1], parent: car, child: bob}
loads: {turn: {type: hinge-spring, hinge: pivot, stiffness: 20}}
)";
  const Sweep sweep = parse_sweep("loads.turn.stiffness=20:2:7", "sweep");
  for (const ModesAt& at : sweep_modes(scene_of(drifting).values, plugins(), {}, {}, sweep, false, {}, {}).points)
    EXPECT_EQ(at.jump, Jump::none) << at.value;
}

/// A uniform blade hinged at the axis: the force −Ω² qᵀM₂q is what holds it, and without it, in `symmetric`, it
/// diverges from Ω² = (1/3)/(11/420) on, where the work that a load ρA x does on the deflection it makes outweighs the
/// inertia.
TEST(Symmetric, LosesABladeOnAFlappingHingeWhereTheoryHasIt) {
  const std::string blade = R"(
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  b: {type: beam, length: 1, mass_per_length: 1, bending_z: {stiffness: 1, modes: 8, family: orthogonal-polynomials}}
hinges:
  a: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  f: {type: revolute, axis: [0, 1, 0], parent: hub, child: b}
)";
  const double limit = std::sqrt(140.0 / 11);
  const auto grows = [&](const std::string& formulation, double rate) {
    const Prepared prepared = scene_of(blade, {"formulation=" + formulation});
    const ModesAt at = modes_at({prepared, prepared.scene.initial, {{}, {{"a", rate}}}}, false);
    EXPECT_EQ(at.problem, "");
    return !at.modes.empty() && unstable(at, at.modes.front());
  };
  EXPECT_FALSE(grows("symmetric", limit * (1 - 1e-4)));
  EXPECT_TRUE(grows("symmetric", limit * (1 + 1e-4)));
  for (const char* formulation : {"ruthless", "consistent", "quadratic"}) EXPECT_FALSE(grows(formulation, 3 * limit));
}

/// A blade on an axle that leans is bent by its spin alone.
TEST(Bent, NamesWhatThereIsThatBends) {
  const std::string cone = R"(
formulation: exact
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {rim: {position: [0.5, 0, 0]}}}
  blade: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 2, modes: 3}, bending_z: {stiffness: 1, modes: 3}}
hinges:
  axle: {type: revolute, axis: [0.4, 0.3, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.rim, child: blade}
)";
  const std::string spun = balance_of(cone, {{}, {{"axle", 2}}}).bent;
  EXPECT_THAT(spun, HasSubstr(", by the motion of hinges (axle) as they are at t = 0 s"));
  EXPECT_THAT(spun, Not(HasSubstr("weight")));
  const std::string hung = balance_of(cone, {{"axle"}, {}}, {"gravity=[0, 0, -2]"}).bent;
  EXPECT_THAT(hung, HasSubstr(", by weight as"));
}

/// A weight on a spring of 3 N m/rad, pushed: by a force that stays, which is a state that stays, and by loads that are
/// functions of time themselves, where the balance is of one instant.
TEST(Stability, OfABalanceOfALoadThatChangesWithTimeIsNotTold) {
  const auto pushed = [](const std::string& load) {
    return "bodies: {b: {type: rigid, mass: 2, inertia: [1, 4, 4.5, 0, 0, 0], frames: {e: {position: [1, 0, 0]}}}}\n"
           "hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}\n"
           "loads:\n  s: {type: hinge-spring, hinge: h, stiffness: 3, damping: 0.5}\n  f: " +
           load + "\n";
  };
  const Equilibrium still = balance_of(pushed("{type: force, frame: b.e, value: [0, 1, 0]}"));
  EXPECT_TRUE(still.stays) << still.changing;
  ASSERT_TRUE(still.stability.has_value());
  EXPECT_TRUE(still.stability->stable());
  for (const std::string load : {"{type: gravity-gradient, rate: 0.8, vertical: [1, 0.4, 0], normal: [0, 0, 1]}",
                                 "{type: force, frame: b.e, law: sine, amplitude: [0, 1, 0], period: 7, phase: 0.5}",
                                 "{type: force, frame: b.e, law: table, table: [[0, 0, 1, 0], [10, 0, -2, 0]]}"}) {
    const Equilibrium found = balance_of(pushed(load));
    ASSERT_TRUE(found.steady.converged) << load;
    EXPECT_FALSE(found.stays) << load;
    EXPECT_TRUE(found.instant) << load;
    EXPECT_FALSE(found.stability.has_value()) << load;
    EXPECT_THAT(found.changing, HasSubstr("The load 'f' changes with time")) << load;
    const Prepared prepared = scene_of(pushed(load), {});
    const ModesAt at = modes_at({prepared, prepared.scene.initial, {}}, false);
    ASSERT_TRUE(at.steady && at.steady->stays) << load;
    EXPECT_FALSE(*at.steady->stays) << load;
    EXPECT_TRUE(at.frozen()) << load;
  }
  // What holds the hinge bears it.
  EXPECT_TRUE(
      balance_of(pushed("{type: force, frame: b.e, law: sine, amplitude: [0, 1, 0], period: 7}"), {{"h"}, {}}).stays);
}

/// A flap on a hub that turns once in 1.05 s, pushed by a sine whose axes turn with it: the push is no angle's.
TEST(Stability, OfALoadThatChangesWithTimeIsNotToldWhereHingesTurnEither) {
  const std::string rotor = R"(
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  b: {type: rigid, mass: 2, inertia: [1, 4, 4.5, 0, 0, 0], frames: {e: {position: [1, 0, 0]}}}
hinges:
  a: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  f: {type: revolute, axis: [0, 1, 0], parent: hub, child: b}
loads:
  s: {type: hinge-spring, hinge: f, stiffness: 3, damping: 0.5}
)";
  const Holding spun{{}, {{"a", 6}}};
  EXPECT_TRUE(balance_of(rotor, spun).stays);
  for (const char* start : {"0", "2"}) {
    const Equilibrium found = balance_of(
        rotor +
            "  g: {type: force, frame: b.e, following: true, law: sine, amplitude: [0, 0, 1], period: 100, start: " +
            start + "}\n",
        spun, {"time.end=10"});
    ASSERT_TRUE(found.steady.converged) << start;
    EXPECT_FALSE(found.stays) << start;
    EXPECT_TRUE(found.instant) << start;
    EXPECT_THAT(found.changing, HasSubstr("The load 'g' changes with time")) << start;
  }
  // Axes that turn with what they act on change nothing, nor does a turn of weight become a matter of time.
  const std::string tide = "  g: {type: gravity-gradient, rate: 0.8, vertical: [1, 0, 0], normal: [0, 0, 1]}\n";
  const std::vector<std::string> leaning = {"time.end=10", "bodies.b.inertia=[1, 4, 4.5, 0, 0.2, 0]"};
  const Equilibrium with_its_axes = balance_of(rotor + tide, {{}, {{"a", 0.8}}}, leaning);
  EXPECT_TRUE(with_its_axes.stays) << with_its_axes.changing;
  EXPECT_THAT(balance_of(rotor + tide, {{}, {{"a", 0.9}}}, leaning).changing,
              HasSubstr("The load 'g' changes with time"));
  EXPECT_THAT(
      balance_of(rotor, spun, {"gravity=[1, 0, 0]", "bodies.b.center_of_mass=[0.1, 0, 0.1]", "time.end=10"}).changing,
      HasSubstr("The hinges turn"));
}

/// A pendulum on a base that shakes along its rod is balanced and driven up by parametric resonance: nothing pushes at
/// the state, and modes of one instant tell nothing. A whole period does.
TEST(Stability, OfSmallMotionsThatALoadChangesWithTimeIsNotTold) {
  const std::string pendulum = R"(
gravity: [0, -9.81, 0]
bodies: {b: {type: rigid, mass: 1, center_of_mass: [0, -1, 0], inertia: [0.01, 0.01, 0.01, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}
loads:
  f: )";
  for (const std::string load : {"{type: base-excitation, law: sine, amplitude: [0, 3, 0], period: 1}",
                                 "{type: base-excitation, law: sine, amplitude: [0, 3, 0], period: 1, start: 5}",
                                 "{type: expression, hinge: h, value: 4*sin(4.5*t)*h}"}) {
    const Equilibrium found = balance_of(pendulum + load + "\n", {}, {"time.end=20"});
    EXPECT_TRUE(found.stays) << load << found.changing;
    ASSERT_TRUE(found.stability.has_value()) << load;
    EXPECT_FALSE(found.stability->stable()) << load;
    EXPECT_THAT(stability_text(found.stability), HasSubstr("the load 'f' changes the equations of small motions"));
    const Prepared prepared = scene_of(pendulum + load + "\n", {"time.end=20"});
    const ModesAt at = modes_at({prepared, prepared.scene.initial, {}}, false);
    EXPECT_TRUE(at.frozen()) << load;
    EXPECT_THAT(turn_text(*at.turn), HasSubstr("tell no stability")) << load;
    const LinearModel linear = linear_model({prepared, prepared.scene.initial, {}}, {{"h"}, {"h"}});
    EXPECT_TRUE(linear.frozen) << load;
    EXPECT_THAT(note_of_frozen(linear), HasSubstr("'f' changes the equations of small motions"));
  }
  // Of what is of second order small motions know nothing, and a push that only time changes leaves them as they are.
  EXPECT_TRUE(balance_of(pendulum + "{type: expression, hinge: h, value: sin(t)*h*h}\n").stability->stable());
  const Prepared pushed = scene_of(pendulum + "{type: hinge-effort, hinge: h, law: sine, amplitude: 1, period: 7}\n");
  const ModesAt at = modes_at({pushed, pushed.scene.initial, {}}, false);
  EXPECT_FALSE(at.frozen());
  EXPECT_FALSE(at.steady->stays.value());
  EXPECT_FALSE(linear_model({pushed, pushed.scene.initial, {}}, {{"h"}, {"h"}}).frozen);
  // A weight that is given from outside is what it is at the state.
  const Prepared given =
      scene_of(pendulum + "{type: input, frame: b.end, direction: [0, 1, 0], table: [[0, 0], [1, 9]]}\n",
               {"bodies.b.frames={end: {position: [0, -1, 0]}}"});
  EXPECT_FALSE(linear_model({given, given.scene.initial, {}}, {{}, {"h"}}).frozen);
}

/// The exponent of ẍ + (9.81 + 3 sin 2πt)/1.01 x = 0 is that of its monodromy matrix over the second: 0.2358/s.
TEST(Stability, OfAShakenPendulumIsToldByAWholePeriodOfWhichNoAngleIsNamed) {
  const Prepared prepared = scene_of(R"(
gravity: [0, -9.81, 0]
bodies: {b: {type: rigid, mass: 1, center_of_mass: [0, -1, 0], inertia: [0.01, 0.01, 0.01, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}
loads: {f: {type: base-excitation, law: sine, amplitude: [0, 3, 0], period: 1}}
)");
  TurningWish wish;
  wish.floquet = true, wish.period = 1;
  const ModesAt at = modes_at({prepared, prepared.scene.initial, {}}, false, wish);
  ASSERT_TRUE(at.turn && at.turn->floquet);
  EXPECT_NEAR(at.turn->floquet->modes.front().exponent.real(), 0.2358, 1e-4);
  EXPECT_THAT(turn_text(*at.turn), HasSubstr("change with time, over the period of 1 s"));
  EXPECT_THAT(turn_text(*at.turn), Not(HasSubstr("angle")));
}

/// A root of the coordinate is balanced at zero and has no derivative there: no start nearer to it helps.
TEST(Stability, WhereADerivativeIsNotFiniteItIsNamed) {
  const Equilibrium found = balance_of(R"(
bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}
loads: {k: {type: expression, hinge: h, value: sqrt(h)}}
)");
  EXPECT_FALSE(found.steady.converged);
  EXPECT_THAT(found.problem, HasSubstr("the derivative of what acts by h.0 is not finite there"));
}

}  // namespace
}  // namespace withy::study
