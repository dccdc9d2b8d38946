// How levels of a reference are integrated: what integration adds, which integrator costs least, what runs are worth.
#include "withy/study/level_integration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "withy/study/accuracy.hpp"
#include "withy/study/probe.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

Prepared arm(const char* scene, double end) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/" + scene);
  return prepare(values.set("time.end", Value(end), "the test"), plugins());
}

/// An integrator whose error is a multiple of its tolerance.
class MadeUp {
 public:
  explicit MadeUp(double error) : error_(error) {}
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
  Prepared scene_ = arm("two-link-slew.yaml", 0.5);
  Outputs outputs_ = Outputs::all(scene_.model());
};

TEST(LevelIntegration, TheToleranceIsTheLoosestPowerOfTenAtWhichADigitLessChangesLittle) {
  MadeUp of(2);
  const auto found = of.loosest(1e-4);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->tolerance, 1e-5) << "a candidate's, to the last bit; vectors are off by √3 of each number";
  EXPECT_EQ(of.asked, (std::vector<double>{1e-3, 1e-4, 1e-5, 1e-6}));
  EXPECT_EQ(found->evaluations, 300) << "of the run with that tolerance";
  EXPECT_EQ(MadeUp(0).loosest(1e-4)->tolerance, 1e-3);
}

TEST(LevelIntegration, WhereNoToleranceWillDoThereIsNone) {
  EXPECT_FALSE(MadeUp(1e9).loosest(1e-4));
  EXPECT_FALSE(MadeUp(2).loosest(1e-4, 1e-4));
  MadeUp stops(2);
  stops.ends_below = 1e-5;
  EXPECT_FALSE(stops.loosest(1e-4)) << "a run does not end";
}

TEST(LevelGrowth, IsThatOfTheRunWithTheMostModesUpToThese) {
  const LevelIntegration with{"dop853", 1e-4, {}, 1000};
  LevelGrowth growth;
  EXPECT_EQ(growth.expected(5), 1) << "nothing was seen";
  growth.note(3, with, 2000, 100);
  growth.note(5, with, 6000, 300);
  EXPECT_EQ(growth.expected(2), 1);
  EXPECT_EQ(growth.expected(4), 2);
  EXPECT_EQ(growth.expected(6), 6);
  growth.note(6, with, 500, 0);
  EXPECT_EQ(growth.expected(6), 1) << "no level is expected to take less than the coarsest";
}

TEST(LevelGrowth, StepsThatStabilityLimitsTellNoMoreThanThatItIsLess) {
  const LevelIntegration explicitly{"dop853", 1e-4, {}, 1000}, implicitly{"imex", 1e-4, {}, 3000};
  LevelGrowth growth;
  growth.note(3, explicitly, 2000, 500);
  growth.note(4, explicitly, 8000, 5000);
  EXPECT_EQ(growth.expected(4), 4) << "between 2 and 8";
  growth.note(4, implicitly, 9000, 5000);
  EXPECT_EQ(growth.expected(4), 3) << "stability does not limit implicit steps: they tell";
  growth.note(4, explicitly, 8000, 5000);
  EXPECT_EQ(growth.expected(4), 3);
}

/// The motion goes in fast modes: implicit steps, which resolve it as well, would grow by as much.
TEST(LevelIntegration, WhereLevelsGrowWithTheirModesExplicitStepsGoOn) {
  const std::vector<LevelIntegration> both{{"dop853", 1e-4, {}, 1000}, {"imex", 1e-5, {}, 2000}};
  EXPECT_EQ(cheapest_with(both, 3000, 1).integrator, "imex");
  EXPECT_EQ(cheapest_with(both, 3000, 4).integrator, "dop853");
  std::vector<LevelIntegration> loose = both;
  loose.front().at_stability = true;
  EXPECT_EQ(cheapest_with(loose, 3000, 4).integrator, "imex") << "its tolerance was never what limited its steps";
}

TEST(LevelIntegration, ExplicitStepsAreAsManyAsTheFastestModeAsks) {
  const std::vector<LevelIntegration> both{{"dop853", 1e-4, {}, 1000}, {"imex", 1e-5, {}, 2000}};
  EXPECT_EQ(cheapest_with(both, 1000, 1).integrator, "dop853");
  EXPECT_EQ(cheapest_with(both, 2500, 1).integrator, "imex");
  EXPECT_EQ(cheapest_with({both.front()}, 2500, 1).integrator, "dop853");
}

/// The manipulator's booms vibrate fast in polynomials, and its motions are slow.
TEST(LevelIntegration, FastModesThatLimitExplicitStepsAreIntegratedImplicitlyAndAsExactly) {
  const Prepared scene = arm("gallery/manipulator.yaml", 2);
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

TEST(Evaluator, ARunOfAReferenceIsTheProbeThatRunningItAgainIs) {
  const Prepared scene = arm("two-link-slew.yaml", 0.5);
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
