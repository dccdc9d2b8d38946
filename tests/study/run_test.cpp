// Runs as a host makes them: what they say of themselves.
#include "withy/study/run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/step_watch.hpp"
#include "withy/study/comparison.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/own_instants.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scene_runs.hpp"

namespace withy::study {
namespace {

using test::plugins;

TEST(StudyRun, OfAVariedSceneHasACertificateWithItsError) {
  SceneValues values = short_slew(1.2);
  const Prepared prepared = prepare(values.choose_formulation("ruthless", "the test"), plugins());
  const CertifiedRun result = run(prepared, plugins());
  ASSERT_EQ(result.summary.status, RunStatus::completed);
  EXPECT_EQ(result.certificate.formulation, "ruthless");
  EXPECT_EQ(result.certificate.against, "quadratic");
  ASSERT_TRUE(result.certificate.estimate);
  // Against the difference of two runs.
  const Comparison c = compare(short_slew(1.2), plugins(), {"ruthless"}, "quadratic",
                               [](const Prepared& p, const auto& output) { return simulate(p, plugins(), output); });
  const double truth = c.distances(c.runs[0]).tips.at("payload.tip");
  EXPECT_NEAR(result.certificate.estimate->distances.tips.at("payload.tip"), truth, 0.2 * truth);
}

TEST(StudyRun, OutputsDoNotDependOnWhatIsMeasuredBeside) {
  const Prepared prepared = prepare(short_slew(), plugins());
  std::vector<State> alone, beside;
  simulate(prepared, plugins(), [&](const State& s) { alone.push_back(s); });
  RunSettings settings;
  settings.estimate = Estimate::always;
  settings.output = [&](const State& s, std::size_t) { beside.push_back(s); };
  static_cast<void>(run(prepared, plugins(), settings));
  ASSERT_EQ(alone.size(), beside.size());
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(alone[i].y, beside[i].y);
}

/// A boom that hangs in its weight with a body on a hinge at its tip, bent at first.
CertifiedRun run_of_a_hanging_boom(const std::string& formulation, double tolerance) {
  SceneValues values = SceneValues::parse(R"(
format: withy/1
gravity: [0, -7, 0]
time: {end: 0.5}
bodies:
  boom: {type: beam, length: 2, mass_per_length: 1.2, bending_y: {stiffness: 60, modes: 2}}
  arm: {type: rigid, mass: 0.5, center_of_mass: [0.2, 0.1, 0], inertia: [0.05, 0.08, 0.07, 0, 0, 0]}
hinges:
  root: {type: revolute, axis: [0, 0, 1], parent: world, child: boom, offset: {position: [0.3, 0.2, 0.1]}}
  wrist: {type: revolute, axis: [0, 0, 1], parent: boom.tip, child: arm}
initial: {bodies: {boom: {modes: [0.05, 0]}}}
)",
                                          "boom");
  values.set("integrator",
             Value::map({{"name", Value(std::string("dop853"))}, {"rtol", Value(tolerance)}, {"atol", Value(1e-13)}}),
             "the test");
  RunSettings settings;
  settings.estimate = Estimate::never;
  return run(prepare(values.choose_formulation(formulation, "the test"), plugins()), plugins(), settings);
}

/// The potential of weight that a symmetric truncation has is of second order: with it its energy stays, and what
/// drifts is the integration's.
TEST(StudyRun, AHeavyTreesOwnEnergyInASymmetricTruncationDriftsByIntegrationAlone) {
  for (const char* formulation : {"symmetric", "symmetric-linear"}) {
    const CertifiedRun r = run_of_a_hanging_boom(formulation, 1e-11);
    ASSERT_EQ(r.summary.status, RunStatus::completed) << r.summary.message;
    EXPECT_LT(r.summary.energy_drift, 1e-10) << formulation;
    EXPECT_GT(r.summary.untruncated_drift, 1e-4) << formulation;
  }
}

/// A boom with a heavy body beside its axis, in space: bent, M0 + M1 loses the inertia of a motion.
CertifiedRun run_of_a_bent_boom(double bent, double rate, const std::string& formulation, double tolerance = 1e-8) {
  SceneValues values = SceneValues::parse(R"(
format: withy/1
time: {end: 1}
integrator: {name: dop853, atol: 1e-12}
bodies:
  boom: {type: beam, length: 2, mass_per_length: 1.2, bending_y: {stiffness: 60, modes: 2}, bending_z: {stiffness: 40, modes: 1}, torsion: {stiffness: 20, inertia: 0.02, modes: 1}}
  arm: {type: rigid, mass: 0.5, center_of_mass: [0.2, 0.1, 0], inertia: [0.05, 0.08, 0.07, 0, 0, 0]}
hinges:
  root: {type: spherical, parent: world, child: boom, offset: {position: [0.3, 0.2, 0.1]}}
  wrist: {type: revolute, axis: [0.2, 0.3, 1], parent: boom.tip, child: arm}
)",
                                          "boom");
  values.set("integrator.rtol", Value(tolerance), "the test");
  const std::string q = std::to_string(bent);
  values.set_text("initial={bodies: {boom: {modes: [" + q + ", 0, " + q + ", " + q + "], rates: [0, 0, " +
                  std::to_string(rate) + ", 0]}}}");
  RunSettings settings;
  settings.estimate = Estimate::never;
  return run(prepare(values.choose_formulation(formulation, "the test"), plugins()), plugins(), settings);
}

/// With its energy conserved the rate of a motion grows without bound as its inertia goes to zero, within a finite
/// time: steps shrink to nothing before the matrix is singular to working accuracy, and it is the reason all the same.
TEST(StudyRun, WhereAMotionsInertiaGoesToZeroTheMassMatrixIsTheReason) {
  const CertifiedRun r = run_of_a_bent_boom(0.03, 3, "symmetric");
  ASSERT_EQ(r.summary.status, RunStatus::singular) << r.summary.message;
  EXPECT_LT(r.summary.conditioning.condition, 1e13) << "not to working accuracy";
  EXPECT_NE(r.summary.message.find("is nearly singular"), std::string::npos) << r.summary.message;
  EXPECT_EQ(r.summary.message.find("not the reason"), std::string::npos) << r.summary.message;
  EXPECT_EQ(run_of_a_bent_boom(0.03, 3, "quadratic").summary.status, RunStatus::completed);
}

/// Near the instant at which nothing has inertia left the steps of a tight tolerance go on until time resolves no more,
/// 80,000 of them here: the run ends long before.
TEST(StudyRun, StepsThatComeToNothingWhereAMotionHasNoInertiaEndARun) {
  const CertifiedRun r = run_of_a_bent_boom(0.045, 0, "symmetric", 1e-12);
  ASSERT_EQ(r.summary.status, RunStatus::singular) << r.summary.message;
  EXPECT_LT(r.summary.steps.accepted, 20000U);
  EXPECT_NE(r.summary.message.find("the steps come to nothing"), std::string::npos) << r.summary.message;
}

TEST(StudyRun, AnIndefiniteMassMatrixIsTheReasonWhereItWasSoFromTheStart) {
  const CertifiedRun r = run_of_a_bent_boom(0.05, 0, "symmetric-linear");
  ASSERT_EQ(r.summary.status, RunStatus::step_underflow) << r.summary.message;
  EXPECT_NE(r.summary.message.find("is indefinite, as it was at the start"), std::string::npos) << r.summary.message;
  EXPECT_EQ(r.summary.message.find("not the reason"), std::string::npos) << r.summary.message;
}

/// The inconsistent blade softens as it spins: past its own fundamental frequency nothing holds it.
TEST(StudyRun, NamesWhatGrowsWhereABodySpinsPastItsFundamentalFrequency) {
  const CertifiedRun r = run_of("spin-up", {}, "inconsistent");
  ASSERT_EQ(r.summary.status, RunStatus::diverged) << r.summary.message;
  EXPECT_NE(r.summary.message.find("'blade' turns at"), std::string::npos) << r.summary.message;
  EXPECT_NE(r.summary.message.find("its stiffness is negative from there on"), std::string::npos);
  EXPECT_NE(r.summary.message.find("small motions grow by"), std::string::npos) << r.summary.message;
  EXPECT_NE(r.summary.message.find("blade.bending_y["), std::string::npos) << r.summary.message;
  EXPECT_LT(r.summary.final.time, r.summary.reached) << "the last state is none to be trusted";
  EXPECT_GT(r.summary.final.time, 0.5 * r.summary.reached);
}

/// A body of a file has no tip: the node that gives most stands for it.
TEST(StudyRun, OfABodyWithoutATipEndsWhereItsMostCompliantStationPassesItsLength) {
  const CertifiedRun r = run_of("spinning-boom", {}, "linear");
  ASSERT_EQ(r.summary.status, RunStatus::diverged) << r.summary.message;
  EXPECT_NE(r.summary.message.find("station 'TIP' of 'boom' is deflected by"), std::string::npos) << r.summary.message;
  EXPECT_NE(r.summary.message.find("'boom' turns at 1.0"), std::string::npos) << r.summary.message;
  EXPECT_LT(r.summary.reached, 2) << "before its spin-up is over";
  EXPECT_EQ(r.summary.validity.bodies.at(0).station, "TIP");
  const CertifiedRun sound = run_of("spinning-boom", {}, "quadratic");
  EXPECT_EQ(sound.summary.status, RunStatus::completed) << sound.summary.message;
  EXPECT_LT(sound.summary.peak_deflection_ratio.at("boom"), 0.03);
}

/// Behind the last state that can be trusted the arm turns ten million times as fast: no peak of the model's motion.
TEST(StudyRun, OfARunThatEndsBadlyPeaksAndValidityAreOfTheMotionThatCanBeTrusted) {
  const CertifiedRun bad = run_of("extended-slew", {}, "inconsistent");
  ASSERT_EQ(bad.summary.status, RunStatus::step_underflow) << bad.summary.message;
  ASSERT_LT(bad.summary.final.time, bad.summary.reached);
  EXPECT_NE(bad.summary.message.find("There 'link2' turns at"), std::string::npos) << bad.summary.message;
  EXPECT_NE(bad.summary.message.find("The mass matrix is not the reason"), std::string::npos) << bad.summary.message;
  const CertifiedRun until = run_of("extended-slew", {{"time.end", Value(bad.summary.final.time)}}, "inconsistent");
  for (const auto& [body, peak] : until.summary.peak_deflection)
    EXPECT_NEAR(bad.summary.peak_deflection.at(body)[1], peak[1], 1e-4 * peak[1]) << body;
  for (std::size_t i = 0; i < until.summary.peak_effort.size(); ++i)
    EXPECT_NEAR(bad.summary.peak_effort[i], until.summary.peak_effort[i], 1e-4 * until.summary.peak_effort[i]) << i;
  // The last trusted state is a sample: the certificate says no other than the message.
  for (std::size_t b = 0; b < until.summary.validity.bodies.size(); ++b) {
    const double ratio = until.summary.validity.bodies[b].rate_ratio;
    EXPECT_NEAR(bad.summary.validity.bodies[b].rate_ratio, ratio, 0.01 * ratio);
  }
  EXPECT_GT(bad.summary.validity.bodies[1].rate_ratio, 1) << bad.summary.message;
}

/// Nothing is estimated from a run that has no motion.
TEST(StudyRun, ARunOfWhichOnlyTheStartCanBeTrustedEstimatesNothing) {
  SceneValues values = scene("two-link-slew");
  values.set("integrator", Value::map({{"name", Value(std::string("rk4"))}, {"step", Value(1e300)}}), "the test");
  RunSettings settings;
  settings.estimate = Estimate::always;
  const CertifiedRun r = run(prepare(values, plugins()), plugins(), settings);
  EXPECT_EQ(r.summary.final.time, 0);
  EXPECT_FALSE(r.certificate.estimate);
  EXPECT_NE(r.certificate.without_estimate.find("no motion of this run can be trusted"), std::string::npos)
      << r.certificate.without_estimate;
}

/// A satellite at rest as a whole, whose boom swings: what truncation makes of its momenta is no 100 %.
TEST(StudyRun, MomentaThatStartAtZeroAreMeasuredByWhatTheEnergyCouldCarry) {
  const auto of = [](const std::string& formulation) {
    SceneValues values = SceneValues::parse(
        "format: withy/1\ntime: {end: 4}\nbodies:\n  bus: {type: rigid, mass: 3, inertia: [0.2, 0.2, 0.3, 0, 0, 0]}\n"
        "  boom: {type: beam, length: 2, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 2}}\nhinges:\n"
        "  float: {type: free, parent: world, child: bus}\n  root: {type: weld, parent: bus, child: boom}\n"
        "initial: {bodies: {boom: {modes: [0.1, 0]}}}\n",
        "satellite");
    return run(prepare(values.choose_formulation(formulation, "the test"), plugins()), plugins()).certificate.momentum;
  };
  const MomentumDrift cut = of("ruthless"), sound = of("quadratic");
  ASSERT_TRUE(cut.conserved && sound.conserved);
  for (const double drift : {cut.linear, cut.angular}) {
    EXPECT_LT(drift, 0.9);
    EXPECT_GT(drift, 1e-5);
  }
  EXPECT_LT(std::max(sound.linear, sound.angular), 1e-6);
}

/// 4 kg on a column that buckles under 2.5.
TEST(StudyRun, NamesBuckling) {
  const SceneValues column = SceneValues::parse(
      "format: withy/1\ngravity: [-9.81, 0, 0]\ntime: {end: 5}\nlimits: {deflection: 0.3}\nbodies:\n"
      "  column: {type: beam, length: 1, mass_per_length: 0.1, bending_y: {stiffness: 10, modes: 2}}\n"
      "  load: {type: rigid, mass: 4, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}\nhinges:\n"
      "  foot: {type: weld, parent: world, child: column}\n  top: {type: weld, parent: column.tip, child: load}\n"
      "initial: {bodies: {column: {modes: [0.01, 0]}}}\n",
      "column");
  const CertifiedRun r = run(prepare(column, plugins()), plugins());
  ASSERT_EQ(r.summary.status, RunStatus::diverged) << r.summary.message;
  EXPECT_NE(r.summary.message.find("'column' is compressed by 1."), std::string::npos) << r.summary.message;
  EXPECT_NE(r.summary.message.find("small motions grow by"), std::string::npos) << r.summary.message;
  EXPECT_NE(r.summary.message.find("column.bending_y[1]"), std::string::npos) << r.summary.message;
}

/// A torque that rises from 1 N m to a billion within a hundredth of a second, beside one that does nothing wild.
TEST(StudyRun, NamesALoadThatIsWild) {
  for (const double torque : {1e4, 1e9, 1e30}) {
    SceneValues values = SceneValues::parse(
        "format: withy/1\ntime: {end: 2}\nbodies:\n"
        "  arm: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 50, modes: 2}}\n"
        "  bob: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\nhinges:\n"
        "  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}\n"
        "  tip: {type: weld, parent: arm.tip, child: bob}\nloads:\n"
        "  calm: {type: hinge-spring, hinge: pivot, stiffness: 3, damping: 0.1}\n"
        "  motor: {type: hinge-effort, hinge: pivot, law: table, table: [[0, 0], [1, 1], [1.01, 1], [3, 1]]}\n",
        "wild");
    const auto row = [](double t, double x) { return Value::list({Value(t), Value(x)}); };
    values.set("loads.motor.table", Value::list({row(0, 0), row(1, 1), row(1.01, torque), row(3, torque)}), "the test");
    const CertifiedRun r = run(prepare(values, plugins()), plugins());
    EXPECT_TRUE(r.summary.status == RunStatus::diverged || r.summary.status == RunStatus::step_underflow);
    EXPECT_NEAR(r.summary.reached, 1, 0.01);
    EXPECT_NE(r.summary.message.find("Load 'motor' gives"), std::string::npos) << r.summary.message;
    EXPECT_NE(r.summary.message.find("times what bends 'arm' by its length"), std::string::npos) << r.summary.message;
    EXPECT_EQ(r.summary.message.find("'calm'"), std::string::npos) << r.summary.message;
    EXPECT_EQ(r.summary.message.find("stiffness is negative"), std::string::npos) << "quadratic stiffens";
  }
}

TEST(StudyRun, StepsThatAreTooLongAreNamedFirst) {
  const Value rk4 = Value::map({{"name", Value(std::string("rk4"))}, {"step", Value(1e300)}});
  const CertifiedRun r = run_of("two-link-slew", {{"integrator", rk4}}, "quadratic");
  EXPECT_EQ(r.summary.status, RunStatus::diverged) << "one step bends the arm beyond all measure";
  EXPECT_EQ(r.summary.message.find("Steps of"), 0U) << r.summary.message;
}

TEST(StudyRun, ARunWhoseEnergyDoesNotBalanceIsInaccurate) {
  const Value rk4 = Value::map({{"name", Value(std::string("rk4"))}, {"step", Value(1e300)}});
  const CertifiedRun r = run_of("pendulum", {{"integrator", rk4}}, "quadratic");
  EXPECT_EQ(r.summary.status, RunStatus::inaccurate) << r.summary.message;
  EXPECT_NE(r.summary.message.find("Energy and work do not balance"), std::string::npos) << r.summary.message;
}

/// No elastic mode is too fast for these steps, but what the controller does to a joint of little inertia is; and a
/// formulation that need not conserve energy is not judged by its balance alone.
TEST(StudyRun, StepsTooLongForAPoleThatALoadMakesAreInaccurateAndNamedFirst) {
  for (const auto& [formulation, step, status] :
       {std::tuple("ruthless", 0.5e-3, RunStatus::inaccurate), std::tuple("quadratic", 0.5e-3, RunStatus::inaccurate),
        std::tuple("ruthless", 0.1e-3, RunStatus::completed)}) {
    const Value rk4 = Value::map({{"name", Value(std::string("rk4"))}, {"step", Value(step)}});
    const CertifiedRun r = run_of("pd-arm", {{"integrator", rk4}}, formulation);
    EXPECT_EQ(r.summary.status, status) << formulation << ", " << step << ": " << r.summary.message;
    if (status == RunStatus::completed) continue;
    EXPECT_EQ(r.summary.message.find("Steps of 0.0005 s are too long"), 0U) << r.summary.message;
    EXPECT_NE(r.summary.message.find("damping of load 'control'"), std::string::npos) << r.summary.message;
    EXPECT_NE(r.summary.message.find("Energy and work do not balance"), std::string::npos) << r.summary.message;
  }
}

// Sound, out of balance, and past all measure: what is left out of a summary changes no motion, no status, no message.
TEST(StudyRun, OfWhichTheOutcomeAloneIsLookedAtEndsTheSameWay) {
  const Value one_step = Value::map({{"name", Value(std::string("rk4"))}, {"step", Value(1e300)}});
  for (const auto& [name, integrator] :
       {std::pair("spin-up", Value()), std::pair("pendulum", one_step), std::pair("two-link-slew", one_step)}) {
    SceneValues values = scene(name);
    if (integrator.kind() != Value::Kind::null) values.set("integrator", integrator, "the test");
    const Prepared p = prepare(values.choose_formulation("quadratic", "the test"), plugins());
    const auto run_with = [&](Attention attention) {
      return withy::simulate(p.model(), *p.equations, *p.scene.integrator, p.scene.initial, run_options(p.scene), {},
                             nullptr, attention);
    };
    const RunSummary whole = run_with(Attention::whole), outcome = run_with(Attention::outcome);
    EXPECT_EQ(outcome.status, whole.status) << name;
    EXPECT_EQ(outcome.message, whole.message) << name;
    EXPECT_EQ(outcome.final.y, whole.final.y) << name;
    EXPECT_EQ(outcome.peak_deflection, whole.peak_deflection) << name;
    EXPECT_EQ(outcome.energy_drift, whole.energy_drift) << name;
    EXPECT_TRUE(outcome.validity.bodies.empty()) << name;
    EXPECT_TRUE(outcome.peak_effort.empty() && outcome.peak_motion_effort.empty()) << name;
    EXPECT_EQ(whole.fastest_mode > 0, name != std::string("pendulum")) << "rigid, which has none";
    EXPECT_EQ(outcome.fastest_mode, whole.status == RunStatus::completed ? 0 : whole.fastest_mode) << name;
  }
}

TEST(StudyRun, SoundRunsOfEveryFormulationAreNotInaccurate) {
  for (const char* formulation : {"linear", "quadratic", "symmetric", "exact", "ruthless"}) {
    const CertifiedRun r = run_of("two-link-slew", {}, formulation);
    EXPECT_EQ(r.summary.status, RunStatus::completed) << formulation << ": " << r.summary.message;
  }
}

/// What acts is told apart from what is only dealt with as if it did, and that from what is looked for beside the run.
TEST(StudyRun, WhatKeepsModelsFromBeingComparedIsSaidAsItIs) {
  const auto said = [](const std::string& events) {
    SceneValues values = short_slew();
    values.set_text("events=" + events);
    const Prepared prepared = prepare(std::move(values), plugins());
    return has_switches(prepared.model()) ? own_instants(prepared.model()) : "";
  };
  const std::string leave_out = ", and is dealt with as those that act: leave it out (--set events.e=null)";
  EXPECT_EQ(said("{e: {at: 0.1}}"), "event 'e' does nothing to the motion but is at a time" + leave_out);
  EXPECT_EQ(said("{e: {at: 0.1, stop: true}}"), "event 'e' does nothing to the motion but is at a time" + leave_out);
  EXPECT_EQ(said("{e: {hinge: shoulder, value: 1, delay: 0.1}}"),
            "event 'e' does nothing to the motion but waits" + leave_out);
  EXPECT_EQ(said("{look: {at: 0.1}, e: {at: 0.2, do: {lock: shoulder}}}"), "event 'e' acts");
  EXPECT_EQ(said("{e: {hinge: shoulder, value: 1, do: {lock: shoulder}}}"),
            "event 'e' acts, at times of its own in every model");
  EXPECT_EQ(said("{e: {hinge: shoulder, value: 1}}"), "");
  EXPECT_EQ(said("{e: {signal: shoulder.rate, value: 0.1}}"), "") << "the column of a hinge is what `hinge` names";
  SceneValues chosen = short_slew();
  chosen.choose_formulation("auto", "the test").set_text("events={e: {at: 0.1}}");
  EXPECT_THROW(static_cast<void>(prepare(chosen, plugins())), InputError);
}

}  // namespace
}  // namespace withy::study
