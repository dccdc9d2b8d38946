// Why steps are short, too long or come to nothing: each cause is planted in a scene that has no other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "withy/study/fast_course.hpp"
#include "withy/study/plausibility.hpp"
#include "withy/study/step_limit.hpp"
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

// d/J = 1500/1e-9 = 1.5e12/s: dopri5, stable to 1.7 over that of a vibration, would need 9e11 steps, of a motion that
// dies out half as many.
TEST(Causes, ADampedHingeThatMovesNextToNothing) {
  const std::string scene = R"(time: {end: 1}
bodies:
  arm: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  wheel: {type: rigid, mass: 1, inertia: [1, 1, 1.0e-9, 0, 0, 0]}
hinges:
  axle: {type: revolute, parent: world, child: arm, axis: [0, 0, 1]}
  pin: {type: revolute, parent: arm, child: wheel, axis: [0, 0, 1]}
motions: {turn: {type: expression, hinge: axle, value: "0.1*t^2"}}
loads: {drag: {type: hinge-spring, hinge: pin, stiffness: 1, damping: 1500}}
)";
  const RunSummary s = outcome_of_text(scene);
  EXPECT_EQ(s.status, RunStatus::too_stiff);
  EXPECT_LE(s.steps.accepted, std::size_t{1} << 18U) << "it stops at its first look";
  EXPECT_NEAR(number_after(s.message, "its fastest motion is "), -1.5e12, 1e9) << s.message;
  EXPECT_NEAR(number_after(s.message, "of which the run would need about "), 9e11, 0.5e11) << s.message;
  EXPECT_THAT(s.message, HasSubstr("damping of load 'drag' on pin"));
  EXPECT_THAT(s.message, HasSubstr("What to do: use --integrator radau"));
  // What it advises helps, and `check` says so beforehand.
  SceneValues values = SceneValues::parse("format: withy/1\n" + scene, "planted.yaml");
  const std::vector<Remark> remarks = implausible(prepare(values, plugins()), plugins());
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_THAT(remarks[0].text, HasSubstr("its fastest motion is -1.5e+12/s"));
  EXPECT_EQ(outcome_of(values.set_text("integrator=radau", "the test")).status, RunStatus::completed);
}

// Its square is beyond the range of numbers, and so is the pole that would be named.
TEST(Causes, AFilterSoFastThatItsPoleCannotBeTold) {
  const RunSummary s = outcome_of_text(R"(time: {end: 1}
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
initial: {hinges: {axle: {rate: [1]}}}
loads: {lag: {type: filter, of: axle, hinge: axle, cutoff: 1e300}}
)");
  EXPECT_EQ(s.status, RunStatus::too_stiff) << s.message;
  EXPECT_LE(s.steps.accepted, std::size_t{1} << 18U) << "it stops at its first look";
}

/// A wheel that dry friction brings to rest at 2 s and holds there against a push.
std::string held_by_friction(const std::string& scale) {
  return R"(time: {end: 3}
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
initial: {hinges: {axle: {rate: [1]}}}
loads:
  friction: {type: hinge-friction, hinge: axle, effort: 1, rate_scale: )" +
         scale + R"(}
  push: {type: hinge-effort, hinge: axle, law: constant, value: 0.5}
)";
}

/// Two thirds of the time go by in a hundred steps, the last third in none: the pace is that of the later half.
TEST(Causes, DryFrictionThatHoldsAfterAMotionWithNextToNoScaleOfItsRate) {
  const RunSummary s = outcome_of_text(held_by_friction("1.0e-9"));
  EXPECT_EQ(s.status, RunStatus::too_stiff);
  EXPECT_LE(s.steps.accepted, std::size_t{1} << 24U);
  EXPECT_THAT(s.message, HasSubstr("damping of load 'friction' on axle"));
  SceneValues values = SceneValues::parse("format: withy/1\n" + held_by_friction("1.0e-9"), "planted.yaml");
  EXPECT_EQ(outcome_of(values.set_text("integrator=radau", "the test")).status, RunStatus::completed);
}

/// Steps go to and fro about rest beyond the scale of the rate, where friction has no derivative.
TEST(Causes, DryFrictionIsNamedWhereItsScaleIsBelowWhatTheStepsResolve) {
  const std::string head = "format: withy/1\nintegrator: {name: dopri5, rtol: 1e-6, atol: 1e-9}\n";
  const Prepared prepared = prepare(SceneValues::parse(head + held_by_friction("1.0e-12"), "planted.yaml"), plugins());
  State state = prepared.scene.initial;
  state.time = 2.01;
  for (const double rate : {0.0, 1e-9, -1e-9}) {
    state.y[prepared.model().layout().positions] = rate;
    const std::optional<TooStiff> found = too_stiff(prepared, state);
    ASSERT_TRUE(found) << rate;
    EXPECT_NEAR(number_after(found->text, "its fastest motion is "), -1e12, 1e9) << found->text;
    EXPECT_THAT(found->text, HasSubstr("damping of load 'friction' on axle")) << rate;
  }
  state.y[prepared.model().layout().positions] = 0.01;
  EXPECT_FALSE(too_stiff(prepared, state)) << "while it slides nothing is fast";
}

/// No steps that are allowed follow a load that goes to and fro 1e9 times a second for seconds, implicit ones as
/// little. Its period is counted in eight periods or more, to an eighth.
TEST(Causes, ALoadOrMotionThatIsFasterByItselfThanTheStepsAllowed) {
  const std::string bodies = R"(time: {end: 10}
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}, arm: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}
  pin: {type: revolute, axis: [0, 0, 1], parent: wheel, child: arm}
)";
  const std::string sine = bodies +
                           "loads:\n  slow: {type: hinge-effort, hinge: axle, law: sine, amplitude: 2, period: 5}\n"
                           "  buzz: {type: hinge-effort, hinge: pin, law: sine, amplitude: 1, period: 1.0e-9}\n";
  const RunSummary s = outcome_of_text(sine);
  EXPECT_EQ(s.status, RunStatus::too_stiff) << s.message;
  EXPECT_LE(s.steps.accepted, std::size_t{1} << 18U) << "it stops at its first look";
  EXPECT_NEAR(number_after(s.message, "load 'buzz' goes to and fro every "), 1e-9, 0.125e-9) << s.message;
  EXPECT_NEAR(number_after(s.message, "about "), 1e10, 0.2e10) << s.message;
  EXPECT_THAT(s.message, HasSubstr("What to do: give load 'buzz' (line 11 of the scene) the time that is meant"));
  const auto course = [&](const std::string& text) {
    const Prepared prepared = prepare(SceneValues::parse("format: withy/1\n" + text, "planted.yaml"), plugins());
    const std::optional<FastCourse> found = fast_course(prepared, prepared.scene.initial);
    return found ? found->text : "nothing";
  };
  EXPECT_THAT(course(bodies + "motions: {shake: {type: sine, hinge: axle, amplitude: 1, period: 1.0e-8}}\n"),
              HasSubstr("motion 'shake' goes to and fro every "));
  EXPECT_THAT(course(bodies + "loads: {hold: {type: pd-controller, law: constant, hinges: {axle: {stiffness: 1, "
                              "damping: 1}}, sample: 2.0e-8}}\n"),
              HasSubstr("load 'hold' is sampled every 2e-08 s"));
  // A hundred thousand periods are followed.
  EXPECT_EQ(
      course(bodies + "loads: {hum: {type: hinge-effort, hinge: pin, law: sine, amplitude: 1, period: 1.0e-4}}\n"),
      "nothing");
}

/// A boom at rest, held by a spring that is far too stiff for steps of 10 ms, and falling.
RunSummary held_by_spring(const std::string& stiffness, const std::string& integrator) {
  return outcome_of(SceneValues::parse(
      "format: withy/1\ntime: {end: 2}\ngravity: [0, -9.81, 0]\nintegrator: {name: " + integrator + R"(, step: 0.01}
bodies: {boom: {type: beam, length: 2, mass_per_length: 1, bending_y: {stiffness: 50, modes: 2}}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
loads: {spring: {type: hinge-spring, hinge: axle, stiffness: )" +
          stiffness + "}}\n",
      "planted.yaml"));
}

TEST(Causes, StepsThatAreHalvedSinceTheirIterationDoesNotConvergeAreCounted) {
  const RunSummary halved = held_by_spring("1.0e+14", "generalized-alpha");
  EXPECT_EQ(halved.status, RunStatus::completed);
  EXPECT_GT(halved.steps.rejected, 0U);
  EXPECT_EQ(number_after(halved.message, "The integrator: "), static_cast<double>(halved.steps.rejected));
  EXPECT_THAT(halved.message, HasSubstr("steps were halved where the iteration did not converge"));
  EXPECT_THAT(held_by_spring("1.0e+4", "generalized-alpha").message, Not(HasSubstr("halved")));
}

/// Two bodies that a spring holds together, falling about an axle: with 2.25 kg m² and a weight of 9.81 N at 0.5 m the
/// second, of 1 kg m², takes 2.18 N m, and the spring, at first without any, goes to and fro up to 4.36. Between states
/// the cubic through positions and rates that steps of 10 ms do not resolve is off by 1e-6 rad, times 1e14 N m/rad.
TEST(Causes, PeaksOfEffortsAreNotThoseOfAnInterpolationThatTheStepsDoNotResolve) {
  for (const char* integrator : {"gauss", "generalized-alpha"}) {
    for (const char* stiffness : {"1.0e+10", "1.0e+14"}) {
      const RunSummary s =
          outcome_of(SceneValues::parse(std::string("format: withy/1\ntime: {end: 2}\ngravity: [0, -9.81, 0]\n") +
                                            "integrator: {name: " + integrator + R"(, step: 0.01}
bodies:
  arm: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], center_of_mass: [0.5, 0, 0]}
  tip: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}
  joint: {type: revolute, axis: [0, 0, 1], parent: arm, child: tip}
initial: {hinges: {axle: {rate: [1]}}}
loads: {spring: {type: hinge-spring, hinge: joint, stiffness: )" +
                                            stiffness + "}}\n",
                                        "planted.yaml"));
      EXPECT_EQ(s.status, RunStatus::completed) << integrator;
      EXPECT_NEAR(s.peak_effort[1], 4.36, 0.15) << integrator << ' ' << stiffness;
    }
  }
}

/// A boom that is too stiff for steps of 1 ms, which `ruthless` leaves much out of; and one whose servo is too quick
/// for them, which no vibration tells.
TEST(Causes, StepsThatAreTooLongComeBeforeTheModel) {
  const auto of = [](const std::string& rest, const std::string& integrator) {
    SceneValues values = SceneValues::parse(R"(format: withy/1
time: {end: 1}
bodies:
  hub: {type: rigid, mass: 0.1, inertia: [1e-3, 1e-3, 1e-3, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 1, )" +
                                                rest,
                                            "planted.yaml");
    values.set_text("integrator=" + integrator, "the test");
    return outcome_of(values.choose_formulation("ruthless", "the test"));
  };
  const std::string fixed = "{name: rk4, step: 1e-3}";
  const std::string stiff = R"(bending_y: {stiffness: 2000, modes: 3}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
loads: {push: {type: hinge-effort, hinge: axle, value: 1}}
)";
  const std::string quick = R"(bending_y: {stiffness: 10, modes: 1}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  joint: {type: revolute, axis: [0, 0, 1], parent: hub, child: boom}
loads: {servo: {type: pid, hinge: axle, proportional: 100, derivative: 20, reference: 0.1}}
)";
  for (const std::string& scene : {stiff, quick}) {
    const RunSummary s = of(scene, fixed);
    EXPECT_EQ(s.status, RunStatus::diverged) << s.message;
    EXPECT_THAT(s.message, HasSubstr("s are too long for the integrator"));
    EXPECT_THAT(s.message, HasSubstr("What to do: take shorter steps"));
    EXPECT_THAT(s.message, Not(HasSubstr("--formulation")));
    // What it advises helps.
    EXPECT_EQ(of(scene, "{name: rk4, step: 5e-5}").status, RunStatus::completed);
    EXPECT_EQ(of(scene, "{name: radau, rtol: 1e-6, atol: 1e-9}").status, RunStatus::completed);
  }
}

/// A floating arm of two booms, whose fastest mode, 354.6 rad/s at rest, rk4 follows in steps of 2.832/354.6 = 8 ms.
RunSummary floating_arm(const std::string& step) {
  return outcome_of(SceneValues::parse("format: withy/1\ntime: {end: 0.5}\nintegrator: {name: rk4, step: " + step + R"(}
bodies:
  base: {type: rigid, mass: 50, inertia: [4, 4, 5, 0, 0, 0], frames: {mount: {position: [0.3, 0, 0]}}}
  upper: {type: beam, length: 1.2, mass_per_length: 1.5, bending_y: {stiffness: 90, modes: 2}, damping_ratio: 1 %}
  hub: {type: rigid, mass: 1.2, inertia: [0.002, 0.002, 0.003, 0, 0, 0]}
  fore: {type: beam, length: 0.9, mass_per_length: 1.1, bending_y: {stiffness: 40, modes: 2}, damping_ratio: 1 %}
  hand: {type: rigid, mass: 0.8, inertia: [0.001, 0.001, 0.0015, 0, 0, 0]}
hinges:
  float: {type: planar, parent: world, child: base}
  shoulder: {type: revolute, axis: [0, 0, 1], parent: base.mount, child: upper}
  elbow: {type: revolute, axis: [0, 0, 1], parent: upper.tip, child: hub}
  fore_root: {type: weld, parent: hub, child: fore}
  grip: {type: weld, parent: fore.tip, child: hand}
initial: {hinges: {elbow: {position: 60 deg}}}
loads:
  tau1: {type: hinge-effort, hinge: shoulder, law: sine, amplitude: 3, period: 2}
  tau2: {type: hinge-effort, hinge: elbow, law: sine, amplitude: -1, period: 2}
)",
                                       "planted.yaml"));
}

/// However far the steps throw the arm, to where M cannot be solved or is lost to rounding, it is the steps.
TEST(Causes, StepsThatAreTooLongAreNoFaultOfTheMassMatrix) {
  for (const char* step : {"0.2", "0.1", "0.05", "0.02", "0.012", "0.01"}) {
    const RunSummary s = floating_arm(step);
    EXPECT_EQ(s.status, RunStatus::diverged) << step << ": " << s.message;
    EXPECT_THAT(s.message, HasSubstr("s are too long for the integrator")) << step;
    EXPECT_THAT(s.message, HasSubstr("What to do: take shorter steps")) << step;
    EXPECT_THAT(s.message, Not(HasSubstr("however small"))) << step << ": none shorter was tried";
    EXPECT_THAT(s.message, Not(HasSubstr("of this formulation"))) << step;
  }
  EXPECT_EQ(floating_arm("0.008").status, RunStatus::completed);
}

/// A formulation whose M does become singular is named in steps that are given, as in those that are chosen.
TEST(Causes, AMassMatrixThatBecomesSingularIsNoFaultOfGivenSteps) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/two-link-slew.yaml");
  values.set_text("integrator={name: rk4, step: 1e-3}", "the test").set_text("loads.slew.time_scale=1.2", "the test");
  const RunSummary s = outcome_of(values.choose_formulation("consistent", "the test"));
  EXPECT_EQ(s.status, RunStatus::singular);
  EXPECT_THAT(s.message, Not(HasSubstr("too long")));
  EXPECT_THAT(s.message, HasSubstr("det M changed sign"));
}

/// A boom whose hub is driven in a plane, with modes out of it, and `more`.
CertifiedRun driven_in_a_plane(const std::string& integrator, const std::string& out_of_plane,
                               const std::string& more = "") {
  const SceneValues values =
      SceneValues::parse("format: withy/1\ntime: {end: 5}\nintegrator: {name: " + integrator + R"(}
bodies:
  hub: {type: rigid, mass: 5, inertia: [1, 1, 1, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 30, modes: 2})" +
                             out_of_plane + R"(}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
loads: {motor: {type: hinge-effort, hinge: axle, law: sine, amplitude: 3, period: 1}}
)" + more,
                         "planted.yaml");
  RunSettings settings;
  settings.look_beyond = false;
  settings.estimate = Estimate::never;
  return run(prepare(values, plugins()), plugins(), settings);
}

/// Without them the steps are the same, however fast they are.
TEST(Causes, ModesThatRestLimitNoSteps) {
  const std::string fine = "dopri5, rtol: 3e-6, atol: 3e-8";
  const CertifiedRun alone = driven_in_a_plane(fine, ""),
                     beside = driven_in_a_plane(fine, ", bending_z: {stiffness: 300, modes: 2}");
  ASSERT_EQ(beside.summary.steps.accepted, alone.summary.steps.accepted);
  const StepLimit &without = alone.certificate.steps, &with = beside.certificate.steps;
  EXPECT_GT(with.fastest * with.mean, *with.limit) << "it would be stability";
  EXPECT_EQ(with.resting, "boom.bending_z[2]");
  EXPECT_NEAR(with.moving, without.fastest, 1e-3 * without.fastest);
  EXPECT_EQ(with.cause(), "accuracy");
  EXPECT_EQ(without.cause(), "accuracy");
  EXPECT_EQ(without.resting, "");
  EXPECT_EQ(without.moving, without.fastest);
}

/// They are what the scene says near the limit of stability too, and no fewer modes would make them longer.
TEST(Causes, FixedStepsAreAsTheyAreGiven) {
  const StepLimit steps = driven_in_a_plane("rk4, step: 0.015", "").certificate.steps;
  EXPECT_NEAR(steps.mean, 0.015, 1e-4);
  EXPECT_GT(steps.product, 0.6 * *steps.limit);
  EXPECT_EQ(steps.cause(), "given");
  EXPECT_FALSE(steps.fewer);
  EXPECT_THAT(steps.unlimited, testing::IsEmpty());
}

/// A touch of 1e-13 is enough for unstable steps to grow from, and those of looser tolerances are cut by it.
TEST(Causes, ModesThatUnstableStepsLetGrowLimitThem) {
  const std::string loose = "dopri5, rtol: 1e-4, atol: 1e-4", stiff = ", bending_z: {stiffness: 3000, modes: 2}";
  const CertifiedRun rests = driven_in_a_plane(loose, stiff),
                     grows =
                         driven_in_a_plane(loose, stiff, "initial: {bodies: {boom: {modes: [0, 0, 1.0e-13, 0]}}}\n");
  EXPECT_EQ(rests.certificate.steps.resting, "boom.bending_z[2]");
  EXPECT_GT(grows.summary.steps.accepted, 2 * rests.summary.steps.accepted);
  const StepLimit& limited = grows.certificate.steps;
  EXPECT_EQ(limited.cause(), "stability");
  EXPECT_EQ(limited.resting, "");
  EXPECT_NEAR(limited.moving, limited.fastest, 1e-9 * limited.fastest);
  ASSERT_TRUE(limited.fewer);
  EXPECT_EQ(limited.fewer->mode, "boom.bending_z[2]");
}

/// Steps of a millisecond are short for a blade that its formulation lets fly apart.
TEST(Causes, StepsThatAreShortEnoughAreNoCause) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spin-up.yaml");
  values.set_text("integrator={name: rk4, step: 1e-3}", "the test");
  const RunSummary s = outcome_of(values.choose_formulation("inconsistent", "the test"));
  EXPECT_EQ(s.status, RunStatus::diverged);
  EXPECT_THAT(s.message, Not(HasSubstr("too long")));
  EXPECT_THAT(s.message, HasSubstr("What to do: use --formulation quadratic"));
}

}  // namespace
}  // namespace withy::study
