// Advice as a host asks for it. Costs are counted (counted_time.hpp): what is chosen is the same on any machine.
#include "withy/study/advice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "withy/study/accuracy.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/run.hpp"
#include "withy/study/trade.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using testing::HasSubstr;
using testing::Not;

using test::plugins;

TEST(StudyAdvice, IsTheSameScenesRunOfItsChanges) {
  SceneValues values = scene("spin-up");
  const Prepared prepared = prepare(values.set("time.end", Value(2.0), "the test"), plugins());
  const Outputs outputs(prepared.model());
  const Candidates candidates =
      candidates_for(prepared, plugins(), {{"ruthless", "quadratic"}, {""}, {1, 2}, {"dopri5"}, {1e-3, 1e-5}, {}});
  Evaluator evaluator(prepared, plugins(), outputs, {});
  std::vector<std::string> findings;
  const Advice advice = advise(evaluator, candidates, Accuracy::parse("5%"),
                               [&](const std::string& finding) { findings.push_back(finding); });
  ASSERT_TRUE(advice.choice) << advice.trouble;
  // What the search may cost, how exact the reference is, then models, of which a later one costs less: what is chosen
  // is the last one, or one of those that are nearly as cheap.
  ASSERT_GE(findings.size(), 3U);
  EXPECT_THAT(findings[0], HasSubstr("the search takes 10 s of CPU time at most"));
  EXPECT_THAT(findings[1], HasSubstr("reference so far: "));
  EXPECT_THAT(findings[1], HasSubstr(" times the accuracy asked, least well in "));
  std::size_t holding = 0;
  for (const std::string& finding : findings) holding += finding.starts_with("so far: ") ? 1 : 0;
  EXPECT_GE(holding, 1U);
  EXPECT_TRUE(findings.back().starts_with("so far: ") || findings.back().find(" does not hold: ") != std::string::npos);
  EXPECT_EQ(advice.confirmed.status, RunStatus::completed);
  EXPECT_LE(advice.yardstick->use_with_own(advice.choice->distances), 1);
  SceneValues advised = values;
  for (const Change& change : new_changes(prepared.scene, advice.choice->point, plugins()))
    advised.set_text(change.text());
  const RunSummary again = simulate(prepare(advised, plugins()), plugins(), {});
  EXPECT_EQ(again.steps.evaluations, advice.confirmed.steps.evaluations);
  EXPECT_EQ(again.final.y, advice.confirmed.final.y);
}

/// Runs of a chain part by all they go through: the finest are a part of the accuracy off that leaves little to others.
TEST(StudyAdvice, WhereTheReferenceIsKnownToNearlyTheAccuracyARunThatIsNearItIsAdvised) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/rigid-chain.yaml");
  const Prepared chain = prepare(values.set("time.end", Value(5.5), "the test"), plugins());
  const Outputs outputs(chain.model());
  const auto asked = [&](double share, double tolerance) {
    Evaluator evaluator(chain, plugins(), outputs, {});
    return advise(evaluator, candidates_for(chain, plugins(), {{}, {}, {}, {"dop853"}, {tolerance}, {}}),
                  Accuracy{share, {}, {}});
  };
  const Advice closest = asked(1e-14, 1e-12);
  ASSERT_TRUE(closest.nearest);
  const double known = relative_error(closest.nearest->own, closest.nearest->scales), share = known / 0.85;
  const Advice advice = asked(share, 1e-12);
  ASSERT_TRUE(advice.choice) << advice.trouble;
  EXPECT_GT(advice.yardstick->own_use(), 0.7) << "or it is known well";
  EXPECT_TRUE(advice.trouble.empty() && !advice.nearest);
  const Advice none = asked(share, 1e-3);
  EXPECT_FALSE(none.choice || none.yardstick);
  EXPECT_THAT(none.trouble, HasSubstr("no reference is exact enough to measure against"));
}

// A narrow plate without Poisson's effect is a beam, of which `exact` says that `quadratic` is off by 47 % of the
// deflection's range here; a plate has no exact kinematics, and no number of modes makes `quadratic` the truth.
TEST(StudyAdvice, WhereBodiesBendBeyondWhatTheReferenceIsGoodForThereIsNone) {
  const Prepared strip = prepare(SceneValues::parse(R"(format: withy/1
time: {end: 1, output: 0.01}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
  strip: {type: plate, length: 1, width: 0.05, mass_per_area: 2, stiffness: 20, poisson_ratio: 0, modes: 3, functions_across: 1, damping_ratio: 0.01}
hinges:
  axle: {type: revolute, axis: [0, 1, 0], parent: world, child: hub}
  root: {type: weld, parent: hub, child: strip}
motions: {slew: {hinge: axle, type: quintic, to: 90 deg, duration: 0.8}}
)",
                                                    "strip.yaml"),
                                 plugins());
  const Outputs outputs(strip.model());
  Evaluator evaluator(strip, plugins(), outputs, {});
  const Advice advice =
      advise(evaluator, candidates_for(strip, plugins(), usual_axes()), Accuracy::parse("2%"), {}, {});
  EXPECT_FALSE(advice.choice);
  EXPECT_THAT(advice.trouble, HasSubstr("of a body's length ('strip') are beyond what quadratic is good for"));
  EXPECT_THAT(advice.trouble, HasSubstr("no kinematics is offered that is better. What to do: make 'strip' a beam"));
}

/// What is bent is a beam, which has exact kinematics; the plate at its tip, edgewise, is not bent, and has none.
TEST(StudyAdvice, WhatKeepsABentBeamFromExactKinematicsIsNamed) {
  const Prepared boom = prepare(SceneValues::parse(R"(format: withy/1
time: {end: 1, output: 0.02}
bodies:
  hub: {type: rigid, mass: 5, inertia: [1, 1, 1, 0, 0, 0]}
  boom: {type: beam, length: 1.5, mass_per_length: 1, bending_y: {stiffness: 30, modes: 2, family: orthogonal-polynomials}}
  panel: {type: plate, length: 0.5, width: 0.4, mass_per_area: 1, stiffness: 20, poisson_ratio: 0.3, modes: 2}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
  end: {type: weld, parent: boom.tip, child: panel}
loads: {motor: {type: hinge-effort, hinge: axle, law: sine, amplitude: 8, period: 1.5}}
)",
                                                   "boom.yaml"),
                                plugins());
  const Outputs outputs(boom.model());
  Evaluator evaluator(boom, plugins(), outputs, {});
  const Advice advice = advise(evaluator, candidates_for(boom, plugins(), usual_axes()), Accuracy::parse("1%"), {}, {});
  EXPECT_FALSE(advice.choice);
  EXPECT_THAT(advice.trouble, HasSubstr("of a body's length ('boom') are beyond what quadratic is good for"));
  EXPECT_THAT(advice.trouble, HasSubstr("for 'panel' that is better; 'boom' has 'exact'"));
  EXPECT_THAT(advice.trouble, HasSubstr("make 'boom' one in segments"));
  EXPECT_THAT(advice.trouble, Not(HasSubstr("make 'boom' a beam")));
}

TEST(StudyAdvice, WhatThereWasNoTimeForIsAdvisedWhereItIsGivenMore) {
  const Prepared slew = prepare(short_slew(), plugins());
  const Outputs outputs(slew.model());
  const Candidates candidates = candidates_for(slew, plugins(), usual_axes());
  const auto within = [&](std::optional<double> seconds) {
    Evaluator evaluator(slew, plugins(), outputs, {});
    return advise(evaluator, candidates, Accuracy::parse("0.1%"), {}, seconds);
  };
  const Advice whole = within({});
  ASSERT_TRUE(whole.choice) << whole.trouble;
  EXPECT_EQ(whole.limit_seconds, 10);
  const double enough = 1.5 * whole.cpu_seconds, little = 0.05 * whole.cpu_seconds;
  EXPECT_TRUE(within(enough).choice);
  const Advice cut = within(little);
  EXPECT_FALSE(cut.choice);
  EXPECT_EQ(cut.limit_seconds, little);
  EXPECT_LE(cut.cpu_seconds, 1.5 * little) << "counted as evaluations: it ends where its time does";
  EXPECT_THAT(cut.trouble, HasSubstr("give the search more time (--seconds "));
  EXPECT_THROW(within(0), OptionError);
  EXPECT_THROW(within(std::numeric_limits<double>::infinity()), OptionError);
}

/// Where nothing moves no error shows: any model would hold any accuracy, at no cost.
TEST(StudyAdvice, IsRefusedOfARunThatEndsWhereItBegins) {
  SceneValues values = short_slew();
  const Prepared slew = prepare(values.set("time.end", Value(0.0), "the test"), plugins());
  const Outputs outputs(slew.model());
  Evaluator evaluator(slew, plugins(), outputs, {});
  const Candidates candidates = candidates_for(slew, plugins(), usual_axes());
  EXPECT_THROW(advise(evaluator, candidates, Accuracy::parse("1%")), InputError);
  TradeStudy trade(slew, plugins(), {{"linear", "", 1, "dopri5", 1e-4, {}}}, {});
  EXPECT_THROW(trade.run(), InputError);
}

/// Three modes hold 0.1 % on the screw with less left over than the reference may be off by when it is first good
/// enough.
TEST(StudyAdvice, WhatCostsLessAndWouldHoldWithABetterKnownReferenceGetsOne) {
  const Prepared screw = prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/screw.yaml"), plugins());
  const Outputs outputs(screw.model());
  Evaluator evaluator(screw, plugins(), outputs, {});
  const Advice advice = advise(
      evaluator, candidates_for(screw, plugins(), {{"exact"}, {""}, {1, 2, 3, 4}, {"dop853"}, {1e-2, 1e-3, 1e-4}, {}}),
      Accuracy::parse("0.1%"));
  ASSERT_TRUE(advice.choice) << advice.trouble;
  EXPECT_EQ(advice.choice->point.modes, 3);
  EXPECT_LE(advice.yardstick->use_with_own(advice.choice->distances), 1);
}

/// The boom's fast modes, not its motion, limit explicit steps, but at the loosest tolerance these leave too much in
/// them.
TEST(StudyAdvice, ImplicitStepsAreTriedWhereAnExactRunTakesWhatStabilityAsks) {
  const Prepared boom =
      prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spinning-boom.yaml"), plugins());
  const Outputs outputs(boom.model());
  Evaluator evaluator(boom, plugins(), outputs, {});
  Axes axes = usual_axes();
  axes.formulations = {"consistent"};
  const Advice advice = advise(evaluator, candidates_for(boom, plugins(), std::move(axes)), Accuracy::parse("1%"));
  ASSERT_TRUE(advice.choice) << advice.trouble;
  EXPECT_EQ(advice.choice->point.integrator, "radau");
}

/// The cheapest formulation is off by more than a twelfth of the ranges and by less than three fifths.
TEST(StudyAdvice, AskedForLessIsAModelThatLeavesOutMore) {
  const Prepared arm = prepare(scene("driven-arm"), plugins());
  const Outputs outputs(arm.model());
  Axes axes = usual_axes();
  axes.modes = {1, 2};
  const Candidates candidates = candidates_for(arm, plugins(), std::move(axes));
  const auto formulation = [&](const char* accuracy) {
    Evaluator evaluator(arm, plugins(), outputs, {});
    const Advice advice = advise(evaluator, candidates, Accuracy::parse(accuracy));
    return advice.choice ? advice.choice->point.formulation : advice.trouble;
  };
  EXPECT_EQ(formulation("60%"), "ruthless");
  const std::string of_more = formulation("8%");
  EXPECT_TRUE(of_more == "quadratic" || of_more == "consistent" || of_more == "exact") << of_more;
}

/// A blade that spins up needs stiffening, an idle mast with many coordinates nothing at all.
TEST(StudyAdvice, ABodyThatNeedsLessIsRuthlessAlone) {
  std::ifstream file(std::string(WITHY_SOURCES) + "/scenes/spin-up.yaml");
  std::string text(std::istreambuf_iterator<char>(file), {});
  text.insert(
      text.find("hinges:"),
      "  mast: {type: beam, length: 3.0, mass_per_length: 0.5, bending_y: {stiffness: 900, modes: 2}, bending_z: "
      "{stiffness: 900, modes: 2}, torsion: {stiffness: 300, inertia: 0.01, modes: 2}}\n\n");
  text.insert(text.find("motions:"), "  foot: {type: weld, parent: world, child: mast}\n\n");
  const Prepared masted = prepare(SceneValues::parse(text, "masted"), plugins());
  const Outputs outputs(masted.model(), {"blade.tip"});
  Evaluator evaluator(masted, plugins(), outputs, {});
  Axes axes = usual_axes();
  axes.formulations = {"ruthless", "quadratic"};
  axes.families = {"clamped-free"};
  axes.modes = {2};
  axes.integrators = {"dop853"};
  const Advice advice = advise(evaluator, candidates_for(masted, plugins(), std::move(axes)), Accuracy::parse("20mm"));
  ASSERT_TRUE(advice.choice) << advice.trouble;
  EXPECT_EQ(advice.choice->point.formulation, "quadratic");
  EXPECT_THAT(advice.choice->point.bodies, testing::ElementsAre(testing::Pair("mast", "ruthless")));
}

/// A torque that rises from 3 s on turns a hub past 0.02 rad at 3.18 s, where an event ends the run; the 8 s of the
/// scene would turn it many times as far. Measured is what the run does.
TEST(StudyAdvice, EndsWhereAnEventEndsTheRun) {
  const Prepared prepared = prepare(SceneValues::parse(R"(
format: withy/1
integrator: {name: dopri5, rtol: 1e-7, atol: 1e-9}
time: {end: 8, output: 0.01}
bodies:
  hub: {type: rigid, mass: 8, inertia: [1, 1, 2, 0, 0, 0]}
  l: {type: beam, length: 2.5, mass_per_length: 0.6, bending_y: {stiffness: 60, modes: 2, family: clamped-free}, damping_ratio: 0.008}
  p: {type: rigid, mass: 0.5, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  h: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  r: {type: weld, parent: hub, child: l}
  t: {type: weld, parent: l.tip, child: p}
loads:
  e: {type: hinge-effort, hinge: h, law: table, table: [[0, 0], [0.4, 0.2], [0.5, 0], [3, 0], [5, 40], [7, 0]]}
  k: {type: hinge-spring, hinge: h, stiffness: 2, damping: 0.5}
events: {st: {hinge: h, value: 0.02, direction: up, stop: true}}
)",
                                                       "stopped.yaml"),
                                    plugins());
  const Outputs outputs(prepared.model());
  const Candidates candidates =
      candidates_for(prepared, plugins(), {{"ruthless", "quadratic"}, {""}, {1, 2}, {"dopri5"}, {1e-3, 1e-5}, {}});
  Evaluator evaluator(prepared, plugins(), outputs, {});
  std::vector<std::string> findings;
  const Advice advice = advise(evaluator, candidates, Accuracy::parse("5%"),
                               [&](const std::string& finding) { findings.push_back(finding); });
  ASSERT_TRUE(advice.choice) << advice.trouble;
  EXPECT_THAT(advice.until, HasSubstr("event 'st' ends the run at 3.176 s"));
  EXPECT_EQ(findings.front(), advice.until);
  EXPECT_NEAR(advice.choice->walk.time, simulate(prepared, plugins(), {}).reached, 1e-9);
  std::size_t hinges = 0;
  for (std::size_t i = 0; i < outputs.list().size(); ++i)
    if (outputs.list()[i].name == "h") {
      ++hinges;
      EXPECT_NEAR(advice.yardstick->reference.ranges[i], 0.02, 2e-4) << "where the event is";
    }
  EXPECT_EQ(hinges, 1U);
}

}  // namespace
}  // namespace withy::study
