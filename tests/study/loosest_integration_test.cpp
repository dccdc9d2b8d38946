// How levels of a reference are integrated: what integration adds, which integrator costs least, what runs are worth.
#include "withy/study/loosest_integration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "withy/study/accuracy.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/probe.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

Prepared until(const char* scene, double end) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/" + scene);
  return prepare(values.set("time.end", Value(end), "the test"), plugins());
}

/// An integrator whose error is a multiple of its tolerance.
class RoughIntegrator {
 public:
  explicit RoughIntegrator(double error) : error_(error) {}
  std::optional<LevelIntegration> loosest(double allowed, double tightest = 1e-9) {
    const auto run = [&](double tolerance) {
      asked.push_back(tolerance);
      Reference r{.point = {}, .readings = {}, .ranges = {}, .scales = {}, .own = {}, .walk = {}};
      r.point.tolerance = tolerance;
      r.walk.evaluations = 100 * asked.size();
      r.readings.times = {0.0};
      r.readings.values = {std::vector<double>(outputs_.size(), 1 + error_ * tolerance)};
      return tolerance < ends_below ? std::nullopt : std::optional(r);
    };
    const auto little = [&](const Reference& r) { return *std::max_element(r.own.begin(), r.own.end()) <= allowed; };
    return loosest_integration({outputs_, run, little, 1e-3, tightest});
  }
  std::vector<double> asked;
  double ends_below = 0;

 private:
  double error_;
  Prepared scene_ = until("two-link-slew.yaml", 0.5);
  Outputs outputs_ = Outputs::all(scene_.model());
};

TEST(LevelIntegration, TheToleranceIsTheLoosestPowerOfTenAtWhichADigitLessChangesLittle) {
  RoughIntegrator of(2);
  const auto found = of.loosest(1e-4);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->tolerance, 1e-5) << "a candidate's, to the last bit; vectors are off by √3 of each number";
  EXPECT_EQ(of.asked, (std::vector<double>{1e-3, 1e-4, 1e-5, 1e-6}));
  EXPECT_EQ(found->evaluations, (std::map<int, double>{{0, 300}})) << "of the run with that tolerance";
  EXPECT_EQ(RoughIntegrator(0).loosest(1e-4)->tolerance, 1e-3);
}

TEST(LevelIntegration, WhereNoToleranceWillDoThereIsNone) {
  EXPECT_FALSE(RoughIntegrator(1e9).loosest(1e-4));
  EXPECT_FALSE(RoughIntegrator(2).loosest(1e-4, 1e-4));
  RoughIntegrator stops(2);
  stops.ends_below = 1e-5;
  EXPECT_FALSE(stops.loosest(1e-4)) << "a run does not end";
}

TEST(LevelIntegration, EvaluationsGoOnLikeThePowerOfTheModesThatTheLastTwoRunsTell) {
  LevelIntegration of{"dop853", 1e-4, {}, {}};
  EXPECT_EQ(of.expected(5), 0) << "nothing was seen";
  of.evaluations[2] = 1000;
  EXPECT_EQ(of.expected(6), 1000);
  of.evaluations[3] = 2250;
  EXPECT_EQ(of.expected(2), 1000) << "as it was";
  EXPECT_NEAR(of.expected(6), 9000, 1e-9);
  of.evaluations[4] = 2250;
  EXPECT_EQ(of.expected(6), 2250);
  EXPECT_NEAR(of.expected(3), 2250, 1e-9);
  of.evaluations[5] = 2000;
  EXPECT_EQ(of.expected(6), 2000) << "more modes are not expected to take less";
}

/// A motion that goes in fast modes is as dear to resolve with implicit steps.
TEST(LevelIntegration, WhatGrowsLessWithModesTakesThePlaceOfWhatBeganCheaper) {
  const LevelIntegration explicitly{"dop853", 1e-4, {}, {{2, 1000}, {3, 2250}}};
  const LevelIntegration as_steeply{"imex", 1e-5, {}, {{2, 2000}, {3, 4500}}}, flatly{"imex", 1e-5, {}, {{2, 2000}}};
  EXPECT_EQ(cheapest_with({explicitly, as_steeply}, 100, 8).integrator, "dop853");
  EXPECT_EQ(cheapest_with({explicitly, flatly}, 100, 2).integrator, "dop853");
  EXPECT_EQ(cheapest_with({explicitly, flatly}, 100, 8).integrator, "imex");
}

TEST(LevelIntegration, ExplicitStepsAreAsManyAsTheFastestModeAsks) {
  const std::vector<LevelIntegration> both{{"dop853", 1e-4, {}, {{2, 1000}}}, {"imex", 1e-5, {}, {{2, 2000}}}};
  EXPECT_EQ(cheapest_with(both, 1000, 2).integrator, "dop853");
  EXPECT_EQ(cheapest_with(both, 2500, 2).integrator, "imex");
  EXPECT_EQ(cheapest_with({both.front()}, 2500, 2).integrator, "dop853");
}

TEST(LevelIntegration, StepsThatSolveEquationsAreTakenWhereTheyAreLessThanHalfAsMany) {
  const LevelIntegration explicitly{"dop853", 1e-4, {}, {{2, 1000}}};
  EXPECT_EQ(cheapest_with({explicitly, {"radau", 1e-4, {}, {{2, 600}}}}, 100, 2).integrator, "dop853");
  EXPECT_EQ(cheapest_with({explicitly, {"radau", 1e-4, {}, {{2, 400}}}}, 100, 2).integrator, "radau");
}

/// Its elbow has a damper between light bodies: the more modes, the faster it lets go of what they do at the hinge.
/// Neither the fastest mode nor what is folded into implicit steps tells of that.
TEST(LevelIntegration, WhatADamperMakesStiffIsIntegratedWithStepsThatSolveForAll) {
  const Prepared scene = until("commanded-arm.yaml", 2);
  const Outputs outputs = Outputs::all(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  ReferenceGoal goal;
  goal.first = {"", "clamped-loaded", 2, "dop853", 1e-5, {}, {}};
  goal.levels = 4;
  goal.finer = 1;
  goal.integration = [](const Reference& r) { return relative_error(r.own, r.scales) / 1e-4; };
  goal.enough = [](const Reference& r) { return r.point.modes >= 5; };
  const ReferenceFound found = find_reference(at, plugins(), outputs, goal, {});
  ASSERT_TRUE(found.reference);
  EXPECT_EQ(found.reference->point.integrator, "radau");
}

/// The manipulator's booms vibrate fast in polynomials, and its motions are slow.
TEST(LevelIntegration, FastModesThatLimitExplicitStepsAreIntegratedImplicitlyAndAsExactly) {
  const Prepared scene = until("gallery/manipulator.yaml", 2);
  const Outputs outputs = Outputs::all(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  constexpr double allowed = 1e-3;
  ReferenceGoal goal;
  goal.first = {"", "orthogonal-polynomials", 2, "dop853", 1e-4, {}, {}};
  goal.finer = 1;
  goal.integration = [](const Reference& r) { return relative_error(r.own, r.scales) / allowed; };
  const ReferenceFound found = find_reference(at, plugins(), outputs, goal, {});
  ASSERT_TRUE(found.reference);
  EXPECT_EQ(found.reference->point.integrator, "imex");
  ReferenceGoal again;
  again.first = found.reference->point;
  again.first.modes = 2;
  again.first.integrator = "dop853", again.first.tolerance = 1e-9;
  again.finer = 1;
  const Reference tight = *find_reference(at, plugins(), outputs, again, {}).reference;
  EXPECT_EQ(tight.point.modes, found.reference->point.modes);
  const double off = relative_error(distances(outputs, found.reference->readings, tight.readings).first, tight.scales);
  EXPECT_LT(off, 2 * allowed) << found.reference->text();
  EXPECT_LT(found.reference->walk.evaluations, tight.walk.evaluations / 2);
}

/// At the start of a beam that is let go all its modes count in the effort of the motion, and fast ones ring at a
/// tolerance that two modes are content with.
TEST(LevelIntegration, WhatItAddsToALevelWithManyModesIsToldOrMadeLess) {
  const Prepared scene = until("gallery/spinning-beam.yaml", 1);
  const Outputs outputs = Outputs::all(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  constexpr double allowed = 2e-4;
  const auto found = [&](double most) {
    ReferenceGoal goal;
    goal.first = {"", "", 2, "dop853", 1e-4, {}, {}};
    goal.levels = 14;
    goal.finer = 1;
    goal.leaps = true;
    goal.integration = [](const Reference& r) { return relative_error(r.own, r.scales) / allowed; };
    goal.steady = [](const Reference&) { return true; };
    goal.enough = [=](const Reference& r) { return r.point.modes >= 12 && relative_error(r.own, r.scales) <= most; };
    return *find_reference(at, plugins(), outputs, goal, {}).reference;
  };
  const auto run = [&](const Point& point, double tolerance) {
    const ModelAt& model = evaluator.model(point);
    OutputReader reader(outputs, model.prepared->model(), *model.prepared->equations);
    Readings readings;
    const auto keep = [&](const State& s) {
      readings.times.push_back(s.time);
      readings.values.push_back(reader.read(s));
      return true;
    };
    walk(*model.prepared, *make_integrator(plugins(), point.integrator, tolerance), {keep, {}, {}});
    return readings;
  };
  const auto added_to = [&](const Reference& r) {
    return relative_error(distances(outputs, run(r.point, r.point.tolerance), run(r.point, 1e-9)).first, r.scales);
  };
  const Reference told = found(1);
  EXPECT_GT(added_to(told), 3 * allowed) << "more than to two modes";
  EXPECT_LE(added_to(told), relative_error(told.own, told.scales));
  const Reference less = found(3e-3);
  EXPECT_LT(less.point.tolerance, told.point.tolerance);
  EXPECT_LE(added_to(less), relative_error(less.own, less.scales)) << less.text();
}

TEST(Evaluator, ARunOfAReferenceIsTheProbeThatRunningItAgainIs) {
  const Prepared scene = until("two-link-slew.yaml", 0.5);
  const Outputs outputs = Outputs::all(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  ReferenceGoal goal;
  goal.first = {"", "orthogonal-polynomials", 2, "dop853", 1e-6, {}, {}};
  goal.levels = 3;
  goal.enough = [](const Reference& r) { return r.point.modes >= 4; };
  const ReferenceFound found = find_reference(at, plugins(), outputs, goal, {});
  ASSERT_TRUE(found.reference);
  EXPECT_GE(found.runs.size(), 3U);
  Distances limits = found.reference->scales;
  for (double& limit : limits) limit *= 0.05;
  const Yardstick yardstick{*found.reference, limits};
  for (const Reference& run : found.runs) {
    const Probe judged = evaluator.judge(run, yardstick), anew = evaluator.run(run.point, yardstick);
    EXPECT_EQ(judged.distances, anew.distances) << run.point.text();
    EXPECT_EQ(judged.use, anew.use);
    EXPECT_EQ(judged.outcome, anew.outcome);
    EXPECT_EQ(judged.walk.evaluations, anew.walk.evaluations);
  }
}

}  // namespace
}  // namespace withy::study
