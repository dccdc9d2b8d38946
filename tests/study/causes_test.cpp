// Why a run stops: each cause is planted in a scene that has no other, and is found named in the message, with the
// number that theory gives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "withy/study/plausibility.hpp"
#include "withy/study/remedy.hpp"
#include "withy/tests/study/message.hpp"
#include "withy/tests/study/planted.hpp"

namespace withy::study {
namespace {

using test::number_after;
using test::outcome_of;
using test::outcome_of_text;
using test::plugins;
using testing::HasSubstr;
using testing::Not;

const char* const buckling_words = "its buckling load";
const char* const spinning_words = "its stiffness is negative";
const char* const empty_words = "nothing limits its rate";
const char* const wild_words = "by its length";

TEST(Causes, AColumnUnderMoreThanItsBucklingLoad) {
  const double mass = 4, EI = 10, length = 1, g = 9.80665;
  const RunSummary s = outcome_of_text(R"(
gravity: [-9.80665, 0, 0]
time: {end: 20}
bodies:
  column: {type: beam, length: 1, mass_per_length: 0.01, bending_y: {stiffness: 10, modes: 2}}
  load: {type: rigid, mass: 4}
hinges:
  foot: {type: weld, parent: world, child: column}
  top: {type: weld, parent: column.tip, child: load}
initial: {bodies: {column: {modes: [0.001, 0]}}}
)");
  EXPECT_EQ(s.status, RunStatus::diverged);
  const double critical = std::pow(std::numbers::pi / (2 * length), 2) * EI;
  EXPECT_NEAR(number_after(s.message, "'column' is compressed by "), mass * g / critical, 0.02) << s.message;
  for (const char* other : {spinning_words, empty_words, wild_words}) EXPECT_THAT(s.message, Not(HasSubstr(other)));
}

TEST(Causes, ABladePastTheSpeedThatItsFormulationKnows) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spin-up.yaml");
  const RunSummary s = outcome_of(values.choose_formulation("inconsistent", "the test"));
  EXPECT_EQ(s.status, RunStatus::diverged);
  EXPECT_THAT(s.message, HasSubstr(spinning_words));
  // The first frequency of the clamped blade, (1.8751)^2 sqrt(EI / rho A L^4).
  EXPECT_NEAR(number_after(s.message, "its fundamental frequency of "), 2.911, 0.002) << s.message;
  EXPECT_GT(number_after(s.message, "'blade' turns at "), 1);
  for (const char* other : {buckling_words, empty_words, wild_words}) EXPECT_THAT(s.message, Not(HasSubstr(other)));
}

/// Two cranks of 0.2 m and a coupler of 0.6 m; `rest` says how they move.
std::string parallelogram(const std::string& rest) {
  return R"(time: {end: 5}
bodies:
  left: {type: rigid, mass: 2, inertia: [0.02, 0.02, 0.03, 0, 0, 0], frames: {end: {position: [0.2, 0, 0]}}}
  bar: {type: rigid, mass: 1.5, center_of_mass: [0.3, 0, 0], inertia: [0.02, 0.03, 0.05, 0, 0, 0], frames: {end: {position: [0.6, 0, 0]}}}
  right: {type: rigid, mass: 1.2, inertia: [0.02, 0.03, 0.04, 0, 0, 0], frames: {end: {position: [0.2, 0, 0]}}}
hinges:
  near: {type: revolute, axis: [0, 0, 1], parent: world, child: left}
  knee: {type: revolute, axis: [0, 0, 1], parent: left.end, child: bar}
  far: {type: revolute, axis: [0, 0, 1], parent: world, child: right, offset: {position: [0.6, 0, 0]}}
constraints: {loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: bar.end, b: right.end}}
)" + rest;
}

TEST(Causes, ALoopThatComesIntoOneLine) {
  const std::string scene = parallelogram(
      "initial: {hinges: {near: {position: [1.2], rate: [4]}}, guess: {hinges: {knee: {position: [-1.2]}, far: "
      "{position: [1.2]}}}}\n");
  const RunSummary s = outcome_of_text(scene);
  EXPECT_EQ(s.status, RunStatus::singular);
  EXPECT_THAT(s.message, HasSubstr("What to do: keep links from coming into one line"));
  EXPECT_THAT(s.message, Not(HasSubstr("inertia")));
  // What it advises helps.
  const double end = number_after(s.message, "lose rank between t = ");
  SceneValues shorter = SceneValues::parse("format: withy/1\n" + scene, "planted.yaml");
  EXPECT_EQ(outcome_of(shorter.set("time.end", Value(end), "the test")).status, RunStatus::completed);
}

TEST(Causes, MotionsThatPartALoop) {
  const RunSummary s = outcome_of_text(parallelogram(R"(motions:
  one: {type: constant-rate, hinge: near, rate: 1, from: 1.2}
  other: {type: expression, hinge: far, value: 1.2 + t + 0.3 * t^3}
initial: {guess: {hinges: {knee: {position: [-1.2]}}}}
)"));
  EXPECT_EQ(s.status, RunStatus::singular);
  EXPECT_THAT(s.message, HasSubstr("What to do: let motions drive no more hinges than the loops leave free"));
}

TEST(Causes, AMotionThatCeasesToBeFinite) {
  const std::string scene = R"(time: {end: 2}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
motions: {turn: {type: expression, hinge: axle, value: sqrt(1 - t) * sin(t)}}
)";
  const RunSummary s = outcome_of_text(scene);
  EXPECT_EQ(s.status, RunStatus::diverged);
  EXPECT_THAT(s.message, HasSubstr("motion 'turn' has no finite coordinate at t = 1 s."));
  EXPECT_THAT(s.message, HasSubstr("What to do: change the law of 'turn' (line 7 of the scene)"));
  EXPECT_THAT(s.message, HasSubstr("--set time.end=0.99."));
  // What it advises helps.
  SceneValues shorter = SceneValues::parse("format: withy/1\n" + scene, "planted.yaml");
  EXPECT_EQ(outcome_of(shorter.set("time.end", Value(0.99), "the test")).status, RunStatus::completed);
}

// Its rate and acceleration go on: the integrator, which asks for these, does not see it, and no step helps.
TEST(Causes, AMotionThatLosesItsCoordinateAlone) {
  const Prepared prepared = prepare(SceneValues::parse(R"(format: withy/1
time: {end: 1}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
motions: {turn: {type: constant-rate, hinge: axle, rate: 1}}
)",
                                                       "planted.yaml"),
                                    plugins());
  RunSummary summary;
  summary.status = RunStatus::inaccurate;
  EXPECT_THAT(remedy_text(prepared, summary), HasSubstr("take shorter steps"));
  summary.lost_motion = {"turn", 0.8};
  const std::string text = remedy_text(prepared, summary);
  EXPECT_THAT(text, HasSubstr("What to do: change the law of 'turn' (line 5 of the scene)"));
  EXPECT_THAT(text, HasSubstr("--set time.end=0.792."));
  EXPECT_THAT(text, Not(HasSubstr("shorter steps")));
}

TEST(Causes, ALoadThatCeasesToBeFinite) {
  const std::string scene = R"(time: {end: 1}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads:
  fine: {type: hinge-spring, hinge: axle, stiffness: 1}
  law: {type: expression, hinge: axle, value: log(0.5 - t)}
)";
  const RunSummary s = outcome_of_text(scene);
  EXPECT_EQ(s.status, RunStatus::diverged);
  EXPECT_NEAR(s.reached, 0.5, 1e-3);
  EXPECT_THAT(s.message, HasSubstr("load 'law' gives nan on axle.0"));
  EXPECT_THAT(s.message, HasSubstr("What to do: change load 'law' (line 9 of the scene)"));
  EXPECT_THAT(s.message, Not(HasSubstr("rtol"))) << "no accuracy mends it";
}

/// Modes of a plate leave its edge at the root straight.
TEST(Causes, APlateThatIsNotHeldAtItsRoot) {
  const auto remarks = [](const std::string& body, const std::string& child) {
    const SceneValues values =
        SceneValues::parse("format: withy/1\ntime: {end: 1}\nbodies: {p: " + body +
                               "}\nhinges:\n  w: {type: weld, parent: world, child: " + child + "}\n",
                           "planted.yaml");
    return implausible(prepare(values, plugins()), plugins());
  };
  const std::string plate = "{type: plate, length: 1, width: 1, mass_per_area: 1, stiffness: 1}";
  const std::vector<Remark> found = remarks(plate, "p.tip");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].place.path, "/hinges/w");
  EXPECT_THAT(found[0].text, HasSubstr("holds 'p' at 'tip', where its modes move"));
  EXPECT_THAT(remarks(plate, "p"), testing::IsEmpty());
}

// A cantilever of 2 m that its load bends by more than its length, and back: no fault of the motion.
TEST(Causes, ABodyThatMayBendFarAndOneWhoseKinematicsMayNot) {
  SceneValues values = SceneValues::parse(R"(format: withy/1
time: {end: 2}
bodies:
  beam: {type: beam, length: 2, mass_per_length: 0.5, bending_y: {stiffness: 10, modes: 4, family: orthogonal-polynomials}}
  load: {type: rigid, mass: 6, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  clamp: {type: weld, parent: world, child: beam}
  end: {type: weld, parent: beam.tip, child: load}
gravity: [0, -9.81, 0]
)",
                                          "heavy.yaml");
  const RunSummary exact = outcome_of(values.choose_formulation("exact", "the test"));
  EXPECT_EQ(exact.status, RunStatus::diverged);
  EXPECT_THAT(exact.message, HasSubstr("--set limits.deflection=3"));
  SceneValues allowed = values;
  EXPECT_EQ(outcome_of(allowed.set("limits.deflection", Value(3.0), "the test")).status, RunStatus::completed);
  const RunSummary quadratic = outcome_of(values.choose_formulation("quadratic", "the test"));
  EXPECT_EQ(quadratic.status, RunStatus::diverged);
  EXPECT_THAT(quadratic.message, HasSubstr("What to do: use --formulation exact"));
}

TEST(Causes, AMassMatrixThatTurnsIndefinite) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/two-link-slew.yaml");
  values.set("loads.slew.time_scale", Value(1.2), "the test");
  const RunSummary s = outcome_of(values.choose_formulation("consistent", "the test"));
  EXPECT_EQ(s.status, RunStatus::singular);
  EXPECT_NEAR(s.reached, 0.527, 0.002);
  EXPECT_THAT(s.message, HasSubstr("det M came to zero"));
  EXPECT_THAT(s.message, HasSubstr("modes of 'link2'"));
}

/// A point mass is lifted onto the axis that a motor turns it about: momentum goes on to grow, inertia to zero.
TEST(Causes, AHingeWhoseInertiaIsEmpty) {
  const RunSummary s = outcome_of_text(R"(
time: {end: 2}
bodies:
  post: {type: rigid, mass: 1}
  arm: {type: rigid, mass: 1, center_of_mass: [1, 0, 0]}
hinges:
  turn: {type: revolute, axis: [0, 0, 1], parent: world, child: post}
  lift: {type: revolute, axis: [0, 1, 0], parent: post, child: arm}
motions: {raise: {type: constant-rate, hinge: lift, rate: 1}}
loads: {motor: {type: hinge-effort, hinge: turn, law: table, table: [[0, 1], [10, 1]]}}
)");
  EXPECT_EQ(s.status, RunStatus::step_underflow);
  EXPECT_NEAR(s.reached, std::numbers::pi / 2, 1e-4);
  EXPECT_THAT(s.message, HasSubstr(empty_words));
  EXPECT_LT(number_after(s.message, "turn.0 moves "), 1e-6) << s.message;
  for (const char* other : {buckling_words, spinning_words}) EXPECT_THAT(s.message, Not(HasSubstr(other)));
}

TEST(Causes, ALoadThatIsWild) {
  const RunSummary s = outcome_of_text(R"(
time: {end: 2}
bodies:
  arm: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 10, modes: 2}}
hinges:
  turn: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}
loads:
  push: {type: force, frame: arm.tip, law: table, table: [[0, 0, 0, 0], [1, 0, 0, 0], [1.1, 0, 1e7, 0], [3, 0, 1e7, 0]]}
)");
  EXPECT_EQ(s.status, RunStatus::diverged);
  EXPECT_GT(s.reached, 1);
  EXPECT_THAT(s.message, HasSubstr("Load 'push' gives"));
  EXPECT_THAT(s.message, HasSubstr("what bends 'arm' by its length"));
  for (const char* other : {buckling_words, spinning_words, empty_words}) EXPECT_THAT(s.message, Not(HasSubstr(other)));
}

/// The law of a motor pushes along with the hinge's rate, −80 φ + 1.5 φ̇. When the arm is bent by its length it turns
/// past its fundamental frequency, and what grows then is another thing. At the start M of hinge and two clamped-free
/// modes (own quadratures) gives 1.799/s at 25.24 rad/s.
TEST(Causes, AMotorThatFeedsAVibrationIsNamedAsItIsAtTheStart) {
  const SceneValues arm = SceneValues::parse(R"(
format: withy/1
integrator: {name: dopri5, rtol: 1e-7, atol: 1e-9}
time: {end: 20}
bodies:
  hub: {type: rigid, mass: 3, inertia: [0.2, 0.2, 0.3, 0, 0, 0]}
  l: {type: beam, length: 1.5, mass_per_length: 0.8, bending_y: {stiffness: 60, modes: 2, family: clamped-free}, damping_ratio: 0.005}
  p: {type: rigid, mass: 0.6, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  h: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  r: {type: weld, parent: hub, child: l}
  t: {type: weld, parent: l.tip, child: p}
loads:
  s: {type: expression, hinge: h, value: "-80*h + 1.5*h.rate"}
initial: {hinges: {h: {position: [0.05]}}}
)",
                                             "motor.yaml");
  const RunSummary s = outcome_of(arm);
  EXPECT_EQ(s.status, RunStatus::diverged);
  EXPECT_NEAR(number_after(s.message, "Already at the start small motions grew by "), 1.799, 0.03) << s.message;
  EXPECT_THAT(s.message, HasSubstr("vibrating at 25.2 rad/s, most by damping of load 's' on h"));
}

/// A cantilever of 2 m with 6 kg at its end, let go: it bends by more than its length, which exact kinematics knows of
/// (an elastica of the same data reaches 1.56 lengths). The key that ended the run is named, and with it the run goes
/// on.
TEST(Causes, ADeflectionPastTheLimitInExactKinematicsNamesTheLimitThatMayBeRaised) {
  const auto heavy = [](const std::string& limits) {
    return outcome_of(SceneValues::parse(R"(
format: withy/1
formulation: exact
integrator: {name: dopri5, rtol: 1e-6, atol: 1e-8}
gravity: [0, -9.81, 0]
time: {end: 0.9}
)" + limits + R"(
bodies:
  l: {type: beam, length: 2, mass_per_length: 1, bending_y: {stiffness: 20, modes: 3, family: orthogonal-polynomials}, damping_ratio: 0.01}
  p: {type: rigid, mass: 6, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  r: {type: weld, parent: world, child: l}
  w: {type: weld, parent: l.tip, child: p}
)",
                                         "heavy.yaml"));
  };
  const RunSummary ended = heavy("");
  EXPECT_EQ(ended.status, RunStatus::diverged);
  EXPECT_THAT(ended.message, HasSubstr("limits.deflection is 1 of a body's length"));
  EXPECT_THAT(ended.message, HasSubstr("--set limits.deflection=3"));
  const RunSummary whole = heavy("limits: {deflection: 3}");
  EXPECT_EQ(whole.status, RunStatus::completed) << whole.message;
  EXPECT_GT(whole.peak_deflection_ratio.at("l"), 1);
}

}  // namespace
}  // namespace withy::study
