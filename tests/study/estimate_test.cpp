// The estimate that every run makes of its error: what it costs by counts, and how it stands beside that at any cost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "withy/core/simulation/coarse_steps.hpp"
#include "withy/study/coarse_track.hpp"
#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

struct Estimated {
  Prepared prepared;
  Beyond beyond;
  RunSummary summary;

  static Prepared of(const std::string& scene, const std::string& formulation) {
    SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/" + scene + ".yaml");
    return prepare(values.choose_formulation(formulation, "the test"), plugins());
  }
  static RunSettings without_estimate() {
    RunSettings settings;
    settings.estimate = Estimate::never;
    return settings;
  }
  Estimated(const std::string& scene, const std::string& formulation)
      : prepared(of(scene, formulation)),
        beyond(*next_model_up(prepared, plugins())),
        summary(run(prepared, plugins(), without_estimate()).summary) {}
  [[nodiscard]] EstimateOutcome at(Price price) const {
    return estimate_error(prepared.scene, *prepared.equations, beyond, summary, plugins(), price, {});
  }
};

/// Every distance is within a factor of that at any cost, or no less where it is a bound.
void expect_near(const ErrorEstimate& cheap, const ErrorEstimate& dear, double factor) {
  const auto expect = [&](const std::map<std::string, double>& a, const std::map<std::string, double>& b) {
    for (const auto& [name, real] : b) {
      if (real < 1e-6) continue;
      EXPECT_GE(a.at(name), real / factor) << name;
      if (cheap.at_most.count(name) > 0) continue;
      EXPECT_LE(a.at(name), real * factor) << name;
    }
  };
  expect(cheap.distances.hinges, dear.distances.hinges);
  expect(cheap.distances.tips, dear.distances.tips);
  expect(cheap.distances.deflections, dear.distances.deflections);
}

class EstimatedScenes : public testing::TestWithParam<const char*> {};

// Evaluations of both models were measured to take at most nine of a run: a hundredth of them is less than a tenth of
// it.
TEST_P(EstimatedScenes, say_their_error_for_few_evaluations) {
  const Estimated e(GetParam(), "ruthless");
  const EstimateOutcome cheap = e.at(Price::tenth), again = e.at(Price::tenth), dear = e.at(Price::any);
  ASSERT_TRUE(cheap.estimate && again.estimate && dear.estimate) << cheap.why_not;
  EXPECT_LE(cheap.estimate->evaluations, e.summary.steps.evaluations / 20);
  EXPECT_LE(2 * cheap.estimate->evaluations, dear.estimate->evaluations);
  EXPECT_EQ(cheap.estimate->distances.tips, again.estimate->distances.tips) << "the same input, the same bits";
  EXPECT_EQ(cheap.estimate->distances.until, e.summary.final.time);
  expect_near(*cheap.estimate, *dear.estimate, 1.35);
}
INSTANTIATE_TEST_SUITE_P(Measured, EstimatedScenes,
                         testing::Values("two-link-slew", "driven-arm", "beam-on-base", "screw", "spacecraft", "pd-arm",
                                         "spin-up"),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

struct StrictScene {
  const char *scene, *formulation;
};
void PrintTo(const StrictScene& s, std::ostream* out) { *out << s.scene << ", " << s.formulation; }
class EstimatedStrictScenes : public testing::TestWithParam<StrictScene> {};

// Mass matrices that come near to being singular, as in the two arms, or become it. Coarse runs in these equations
// themselves come to another end (arms), or were off by a factor of 5.8 (extended slew).
TEST_P(EstimatedStrictScenes, say_their_error_wherever_their_mass_matrix_leads) {
  const Estimated e(GetParam().scene, GetParam().formulation);
  const EstimateOutcome cheap = e.at(Price::tenth), dear = e.at(Price::any);
  ASSERT_TRUE(cheap.estimate && dear.estimate) << cheap.why_not;
  EXPECT_LE(cheap.estimate->evaluations, std::max<std::size_t>(e.summary.steps.evaluations / 20, 250));
  EXPECT_EQ(cheap.estimate->distances.until, e.summary.final.time);
  expect_near(*cheap.estimate, *dear.estimate, 2.2);
}
INSTANTIATE_TEST_SUITE_P(Measured, EstimatedStrictScenes,
                         testing::Values(StrictScene{"two-link-slew", "consistent"},
                                         StrictScene{"driven-arm", "consistent"},
                                         StrictScene{"driven-arm", "inconsistent"},
                                         StrictScene{"extended-slew", "inconsistent"},
                                         StrictScene{"spacecraft", "consistent"}),
                         [](const auto& parameter) {
                           std::string name = std::string(parameter.param.scene) + "_" + parameter.param.formulation;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// Torques that jump again and again: coarse steps in `linear` leave the run by 15 % of a range, and their tip comes
// back to it at the end. What they say of tips is 62 times the truth.
TEST(Estimate, is_a_bound_where_its_run_leaves_the_run_on_the_way) {
  const Estimated e("least-time-slew", "linear");
  const EstimateOutcome cheap = e.at(Price::tenth), dear = e.at(Price::any);
  ASSERT_TRUE(cheap.estimate && dear.estimate);
  EXPECT_GT(cheap.estimate->off, 0.1);
  EXPECT_THAT(cheap.estimate->at_most, testing::IsSupersetOf({"link1.tip", "link2.tip", "payload.tip"}));
  expect_near(*cheap.estimate, *dear.estimate, 1.5);
}

// An arm whose middle link vibrates faster than coarse steps follow. What they leave of it passes through next to
// nothing at the end of the run: 0.025 mm were said to be the most, and two runs at 1e-10 are 0.0564 mm apart.
TEST(Estimate, is_a_bound_whatever_a_vibration_is_at_the_instant_of_the_end) {
  const std::string node = "{type: rigid, mass: 0.964, inertia: [0.01929, 0.02122, 0.02507, 0, 0, 0]}\n";
  const Prepared p = prepare(SceneValues::parse(R"(format: withy/1
formulation: consistent
time: {end: 1.55, output: 0.02}
integrator: {name: dopri5, rtol: 1e-6, atol: 1e-8}
bodies:
  hub: {type: rigid, mass: 5.79, inertia: [1, 1.2, 0.72, 0, 0, 0], frames: {rim: {position: [0.1, 0, 0]}}}
  a0:
    type: beam
    length: 0.724
    mass_per_length: 0.5152
    bending_y: {stiffness: 170.9, modes: 2}
    bending_z: {stiffness: 283.2, modes: 2}
  a1: {type: beam, length: 0.833, mass_per_length: 1.0669, damping_ratio: 0.01, bending_y: {stiffness: 499.8, modes: 2}}
  a2: {type: beam, length: 0.844, mass_per_length: 0.448, damping_ratio: 0.01, bending_y: {stiffness: 144.7, modes: 2}}
  n0: )" + node + "  n1: " + node + "  n2: " + node +
                                                    R"(hinges:
  base: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  h0: {type: weld, parent: hub.rim, child: a0}
  w0: {type: weld, parent: a0.tip, child: n0}
  h1: {type: universal, parent: n0, child: a1, first_axis: [0, 0, 1], second_axis: [0, 1, 0]}
  w1: {type: weld, parent: a1.tip, child: n1}
  h2: {type: revolute, parent: n1, child: a2, axis: [0, 0, 1]}
  w2: {type: weld, parent: a2.tip, child: n2}
loads:
  motor: {type: hinge-effort, hinge: base, law: sine, amplitude: 12.93, period: 1.95}
  s10: {type: hinge-spring, hinge: h1, component: 0, stiffness: 18.16, damping: 0.05}
  s11: {type: hinge-spring, hinge: h1, component: 1, stiffness: 12.62, damping: 0.05}
  s2: {type: hinge-spring, hinge: h2, stiffness: 9.77, free_position: 0.24, damping: 0.05}
)",
                                                "arm.yaml"),
                             plugins());
  const Certificate c = run(p, plugins(), RunSettings()).certificate;
  ASSERT_TRUE(c.estimate) << c.without_estimate;
  EXPECT_THAT(c.estimate->at_most, testing::Contains("a1.tip.deflection"));
  EXPECT_GE(c.estimate->distances.deflections.at("a1.tip.deflection"), 5.64e-5);
  EXPECT_LE(c.estimate->distances.deflections.at("a1.tip.deflection"), 10 * 5.64e-5);
}

// Efforts and deflections of fast vibrations: at outputs ten seconds apart none of them is seen.
TEST(Estimate, does_not_depend_on_what_a_scene_writes_to_its_results) {
  const auto at_any_price = [](double output) {
    SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/driven-arm.yaml");
    values.set("time.output", Value(output), "the test").choose_formulation("linear", "the test");
    RunSettings settings;
    settings.estimate = Estimate::always;
    return run(prepare(values, plugins()), plugins(), settings).certificate;
  };
  const Certificate often = at_any_price(0.01), rarely = at_any_price(10);
  ASSERT_TRUE(often.estimate && rarely.estimate && often.more_modes.more && rarely.more_modes.more);
  EXPECT_GT(often.estimate->distances.deflections.at("link1.tip.deflection"), 5e-3);
  EXPECT_GT(often.more_modes.more->distances.deflections.at("link2.tip.deflection"), 5e-3);
  EXPECT_EQ(often.estimate->distances.deflections, rarely.estimate->distances.deflections);
  EXPECT_EQ(often.estimate->distances.tips, rarely.estimate->distances.tips);
  EXPECT_EQ(often.estimate->distances.hinges, rarely.estimate->distances.hinges);
  EXPECT_EQ(often.more_modes.more->distances.deflections, rarely.more_modes.more->distances.deflections);
}

// The tip of a beam with its first mode at 0.06, which `linear` knows no foreshortening of: all the error is at the
// start, for the beam comes to rest.
TEST(Estimate, holds_what_two_formulations_differ_by_at_the_start) {
  const Prepared p = prepare(SceneValues::parse(R"(
format: withy/1
formulation: linear
bodies:
  beam: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 3, modes: 2}, damping_ratio: 1}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: beam}
motions:
  turn: {hinge: axle, type: quintic, to: 0.2, duration: 4}
initial: {bodies: {beam: {modes: [0.06, 0]}}}
time: {end: 8, output: 0.5}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-12}
)",
                                                "bent"),
                             plugins());
  const Beyond beyond = *next_model_up(p, plugins());
  const int tip = p.model().bodies()[0].frame("tip");
  const std::vector<double>& y = p.scene.initial.y;
  const double shorter = -beyond.equations->deflection(y, 0, tip)[0];
  EXPECT_GT(shorter, 8e-3);
  ASSERT_EQ(p.equations->deflection(y, 0, tip)[0], 0);
  for (const Estimate price : {Estimate::automatic, Estimate::always}) {
    RunSettings settings;
    settings.estimate = price;
    const Certificate c = run(p, plugins(), settings).certificate;
    ASSERT_TRUE(c.estimate);
    EXPECT_NEAR(c.estimate->distances.deflections.at("beam.tip.deflection"), shorter, 1e-3 * shorter);
  }
}

// Cubics are met exactly, at both ends and between them; beyond there is nothing.
TEST(CoarseTrack, goes_through_its_states_as_a_cubic) {
  const Prepared p = Estimated::of("two-link-slew", "quadratic");
  CoarseTrack track(*p.equations);
  const auto cubic = [&](double t) {
    return State{t, std::vector<double>(p.equations->size(), 1 + t * (2 - t * (3 + t)))};
  };
  for (const double t : {0.0, 0.1, 0.3, 0.4, 0.7, 1.0}) track.keep(cubic(t));
  for (const double t : {0.0, 0.05, 0.1, 0.35, 0.5, 0.9, 1.0}) {
    const std::optional<State> s = track.at(t);
    ASSERT_TRUE(s) << t;
    EXPECT_NEAR(s->y.front(), cubic(t).y.front(), 1e-14) << t;
  }
  EXPECT_FALSE(track.at(1.01) || track.at(-0.01));
}

// Coarse steps would lose the motion: no number is given, and how one is to be had is.
TEST(Estimate, is_refused_where_its_share_does_not_follow_the_motion) {
  const Estimated e("commanded-arm", "linear");
  const EstimateOutcome cheap = e.at(Price::tenth);
  EXPECT_FALSE(cheap.estimate);
  EXPECT_THAT(cheap.why_not, testing::HasSubstr("`--estimate always`"));
  EXPECT_TRUE(e.at(Price::any).estimate);
}

// The order on a tree with curved motion, and that fast vibrations do not limit the step.
TEST(CoarseSteps, are_of_second_order_and_stable_however_stiff) {
  const Prepared p = Estimated::of("beam-on-base", "quadratic");
  const auto end_of = [&](double step) {
    const auto stepper = CoarseSteps(step).start(*p.equations, p.scene.initial);
    while (stepper->state().time < 0.25) EXPECT_EQ(stepper->step(0.25).outcome, StepResult::Outcome::ok);
    return stepper->state().y;
  };
  const auto apart = [](const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0;
    for (std::size_t i = 0; i < 7; ++i) most = std::max(most, std::abs(a[i] - b[i]));  // of the base
    return most;
  };
  const std::vector<double> exact = end_of(0.25 / 4096);
  const double coarse = apart(end_of(0.25 / 128), exact), fine = apart(end_of(0.25 / 256), exact);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.4);

  // Ends that are given are kept, and what follows the last of them is one step.
  const auto given = CoarseSteps(std::vector{0.01, 0.03, 0.2}).start(*p.equations, p.scene.initial);
  for (const double end : {0.01, 0.03, 0.2, 0.25}) {
    ASSERT_EQ(given->step(0.25).outcome, StepResult::Outcome::ok);
    EXPECT_EQ(given->state().time, end);
  }

  SceneValues stiff = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/beam-on-base.yaml");
  stiff.set("bodies.boom.bending_y.stiffness", Value(1e9), "the test");
  const Prepared q = prepare(stiff.choose_formulation("quadratic", "the test"), plugins());
  const auto stepper = CoarseSteps(0.01).start(*q.equations, q.scene.initial);
  while (stepper->state().time < 1) ASSERT_EQ(stepper->step(1).outcome, StepResult::Outcome::ok);
  for (const double y : stepper->state().y) EXPECT_LT(std::abs(y), 100);
}

// A double pendulum that turns over: two runs of it, whatever their tolerances, part within some swings, and two
// formulations as far. Of its first second an error is known.
TEST(Estimate, at_any_cost_is_none_where_another_run_of_the_same_equations_ends_elsewhere) {
  const auto pendulum = [](double end) {
    SceneValues values = SceneValues::parse(R"(
format: withy/1
formulation: quadratic
gravity: [0, -9.81, 0]
integrator: {name: dopri5, rtol: 1e-7, atol: 1e-9}
time: {end: 1, output: 0.05}
bodies:
  a: {type: beam, length: 1, mass_per_length: 0.8, bending_y: {stiffness: 200, modes: 1, family: clamped-free}}
  b: {type: beam, length: 1, mass_per_length: 0.8, bending_y: {stiffness: 200, modes: 1, family: clamped-free}}
  c: {type: rigid, mass: 1, inertia: [0.02, 0.02, 0.02, 0, 0, 0]}
hinges:
  h: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  g: {type: revolute, axis: [0, 0, 1], parent: a.tip, child: b}
  w: {type: weld, parent: b.tip, child: c}
initial: {hinges: {h: {position: ["80 deg"]}, g: {position: ["40 deg"]}}}
)",
                                            "pendulum.yaml");
    RunSettings settings;
    settings.estimate = Estimate::always;
    return run(prepare(values.set("time.end", Value(end), "the test"), plugins()), plugins(), settings).certificate;
  };
  const Certificate brief = pendulum(1);
  ASSERT_TRUE(brief.estimate) << brief.without_estimate;
  EXPECT_LT(brief.estimate->distances.hinges.at("h"), 0.1);
  const Certificate sensitive = pendulum(25);
  EXPECT_FALSE(sensitive.estimate);
  EXPECT_THAT(sensitive.without_estimate, testing::HasSubstr("not known: the motion is sensitive"));
}

/// What the coarse runs of a tenth of the cost tell, against what runs at any cost do. At most three times as much, or
/// only as a bound, or nothing.
void expect_right_or_unsaid(const std::string& text) {
  const auto of = [&](Estimate asked) {
    RunSettings settings;
    settings.estimate = asked;
    const Prepared prepared =
        prepare(SceneValues::parse(text, "hit.yaml").choose_formulation("linear", "the test"), plugins());
    return run(prepared, plugins(), settings).certificate;
  };
  const Certificate told = of(Estimate::automatic), truth = of(Estimate::always);
  ASSERT_TRUE(truth.estimate) << truth.without_estimate;
  if (!told.estimate) return;
  const auto compare = [&](const std::map<std::string, double>& a, const std::map<std::string, double>& b) {
    for (const auto& [name, value] : a) {
      if (told.estimate->at_most.count(name) > 0) continue;
      EXPECT_LE(value, 3 * b.at(name)) << name;
    }
  };
  compare(told.estimate->distances.hinges, truth.estimate->distances.hinges);
  compare(told.estimate->distances.tips, truth.estimate->distances.tips);
}

// In coarse steps without error control the other model enters the stop in mid-step and is thrown, ours is not: 1500
// degrees were told of 2.5.
/// Its steps are longer than stretching allows others, and its evaluations fewer than they need.
TEST(Estimate, AtAnyCostGoesToTheEndOfARunWhoseIntegratorNoVibrationLimits) {
  const Prepared prepared = prepare(SceneValues::parse(R"(format: withy/1
formulation: quadratic
integrator: {name: radau, rtol: 1e-6, atol: 1e-8}
time: {end: 3}
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  blade: {type: beam, length: 10, mass_per_length: 1.2, bending_y: {stiffness: 1.4e4, modes: 1},
          extension: {stiffness: 2.8e9, modes: 2}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: blade}
motions: {turn: {type: spin-up, hinge: axle, rate: 2, duration: 3}}
)",
                                                       "blade.yaml"),
                                    plugins());
  RunSettings settings;
  settings.estimate = Estimate::always;
  const CertifiedRun dear = run(prepared, plugins(), settings);
  ASSERT_TRUE(dear.certificate.estimate) << dear.certificate.without_estimate;
  const ErrorEstimate& estimate = *dear.certificate.estimate;
  EXPECT_EQ(estimate.distances.until, estimate.end);
  EXPECT_GT(estimate.evaluations, dear.summary.steps.evaluations) << "those of the run do not do";
  // What the rows of two runs, in quadratic and in exact, differ by every 0.01 s.
  const double off = 0.04496;
  EXPECT_NEAR(estimate.distances.deflections.at("blade.tip.deflection"), off, 0.05 * off);
}

TEST(Estimate, OfAnArmThatFallsOnAStopIsNotThatOfAModelThatCoarseStepsThrow) {
  for (const char* lower : {"-1.0", "-0.7", "-0.4"})
    expect_right_or_unsaid(std::string(R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-7, atol: 1e-9}
time: {end: 2, output: 0.02}
gravity: [0, -9.81, 0]
bodies:
  hub: {type: rigid, mass: 0.5, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
  b: {type: beam, length: 1, mass_per_length: 0.5, damping_ratio: 0.005, bending_y: {stiffness: 25, modes: 3}}
  bob: {type: rigid, mass: 0.2, inertia: [0.0002, 0.0002, 0.0002, 0, 0, 0]}
hinges:
  h: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  w: {type: weld, parent: hub, child: b}
  r: {type: weld, parent: b.tip, child: bob}
loads:
  stop: {type: hinge-limit, hinge: h, lower: )") +
                           lower + ", stiffness: 3000, dissipation: 0.3, onset: 0.005}\n");
}

}  // namespace
}  // namespace withy::study
