// Extremes and means of outputs over runs, against closed forms, whatever the rows of results.
#include "withy/core/simulation/output_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "withy/core/simulation/run_times.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy {
namespace {

/// x = 0.3 cos(ω t), ω² = 15.
std::string swinging_block(const std::string& more = "") {
  return R"(format: withy/1
time: {end: 7.3, output: 1}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs:
  place: {type: hinge, hinge: slide, statistics: true}
  square: {type: expression, value: 2 * place.position ^ 2 - 0.1}
  twice: {type: expression, value: 2 * square, statistics: true}
initial: {hinges: {slide: {position: [0.3]}}}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 30}
)" + more;
}

std::vector<OutputStatistics> statistics_of(const test::LoadedScene& s, const RunOptions& options = {}) {
  StatisticsWatch watch(s.scene.outputs, {"place", "twice"}, *s.equations, discontinuities(*s.scene.model),
                        StepParts(*s.scene.model, s.scene.initial.time, *s.scene.end));
  RunOptions all = options;
  all.end = end_of_run(s.scene);
  all.output = s.scene.output;
  const RunSummary summary =
      simulate(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, all, {}, &watch);
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
  return watch.results();
}

TEST(OutputStatistics, AreThoseOfTheClosedFormBetweenOutputsToo) {
  const test::LoadedScene s(swinging_block());
  const std::vector<OutputStatistics> all = statistics_of(s);
  ASSERT_EQ(all.size(), 4U);
  const double w = std::sqrt(15.0), T = 7.3;
  const OutputStatistics &x = all[0], &v = all[1], &a = all[2], &twice = all[3];
  EXPECT_EQ(x.name, "place.position");
  EXPECT_EQ(x.unit, "m");
  EXPECT_NEAR(x.greatest, 0.3, 1e-9);
  EXPECT_NEAR(x.least, -0.3, 1e-9);
  EXPECT_NEAR(std::cos(w * x.least_at), -1, 1e-6);
  EXPECT_NEAR(v.greatest, 0.3 * w, 1e-8);
  EXPECT_NEAR(std::sin(w * v.greatest_at), -1, 1e-6);
  EXPECT_NEAR(a.greatest, 0.3 * w * w, 1e-7);
  EXPECT_NEAR(x.integral, 0.3 * std::sin(w * T) / w, 1e-8);
  EXPECT_NEAR(x.mean(), x.integral / T, 1e-12);
  EXPECT_NEAR(x.rms(), 0.3 * std::sqrt(0.5 + std::sin(2 * w * T) / (4 * w * T)), 1e-8);
  EXPECT_NEAR(twice.greatest, 4 * 0.09 - 0.2, 1e-8);
  EXPECT_NEAR(twice.least, -0.2, 1e-8);
  EXPECT_DOUBLE_EQ(x.span, T);
}

TEST(OutputStatistics, DoNotDependOnTheRowsAndChangeNothing) {
  const test::LoadedScene coarse(swinging_block()), fine(swinging_block(), {"time.output=0.01"});
  const std::vector<OutputStatistics> a = statistics_of(coarse), b = statistics_of(fine);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].least, b[i].least);
    EXPECT_EQ(a[i].greatest_at, b[i].greatest_at);
    EXPECT_EQ(a[i].integral, b[i].integral);
  }
}

// What is no number in some steps, or never one, says so of itself alone.
TEST(OutputStatistics, OfOneThatIsNoNumberLeaveTheOthersAsTheyAre) {
  const test::LoadedScene s(swinging_block(), {"outputs.half={type: expression, value: sqrt(place.position)}",
                                               "outputs.never={type: expression, value: sqrt(place.position - 5)}"});
  StatisticsWatch watch(s.scene.outputs, {"place", "half", "never"}, *s.equations, discontinuities(*s.scene.model),
                        StepParts(*s.scene.model, s.scene.initial.time, *s.scene.end));
  RunOptions options;
  options.end = end_of_run(s.scene);
  options.output = s.scene.output;
  EXPECT_EQ(simulate(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options, {}, &watch).status,
            RunStatus::completed);
  const std::vector<OutputStatistics> alone = statistics_of(test::LoadedScene(swinging_block()));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(watch.results()[i].least, alone[i].least);
    EXPECT_EQ(watch.results()[i].greatest, alone[i].greatest);
    EXPECT_EQ(watch.results()[i].integral, alone[i].integral);
    EXPECT_EQ(watch.results()[i].span, alone[i].span);
  }
  const OutputStatistics &half = watch.results()[3], &never = watch.results()[4];
  EXPECT_NEAR(half.greatest, std::sqrt(0.3), 1e-9);
  EXPECT_GE(half.least, 0);
  EXPECT_NEAR(half.span, 7.3 / 2, 0.5);
  EXPECT_TRUE(std::isnan(never.least) && std::isnan(never.greatest) && std::isnan(never.mean()) &&
              std::isnan(never.rms()));
}

// An effort that is held jumps at the samples: what is on either side of one counts.
TEST(OutputStatistics, SeeBothSidesOfJumps) {
  const test::LoadedScene s(
      swinging_block("  push: {type: noise, hinge: slide, deviation: 5, seed: 2, sample: 0.05}\n"),
      {"time.output=0.05", "time.end=2"});
  double greatest = 0;
  SensorReader reader(s.scene.outputs, *s.equations);
  std::vector<double> row(reader.columns().size());
  StatisticsWatch watch(s.scene.outputs, {"place", "twice"}, *s.equations, discontinuities(*s.scene.model),
                        StepParts(*s.scene.model, s.scene.initial.time, *s.scene.end));
  RunOptions options;
  options.end = 2;
  options.output = 0.05;
  simulate(
      *s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options,
      [&](const State& state) {
        if (reader.read(state, row)) greatest = std::max(greatest, row[2]);
      },
      &watch);
  EXPECT_GE(watch.results()[2].greatest, greatest);
  EXPECT_GT(watch.results()[2].greatest, 4.5);
}

TEST(OutputStatistics, GoThroughACheckpointBitByBit) {
  const test::LoadedScene s(swinging_block());
  const std::vector<OutputStatistics> whole = statistics_of(s);
  Checkpoint kept;
  int asked = 0;
  RunOptions first;
  first.checkpoint_due = [&] { return ++asked == 20; };
  first.checkpoint = [&](const Checkpoint& c) { kept = c; };
  statistics_of(s, first);
  ASSERT_GT(kept.state.time, 0.1);
  RunOptions second;
  second.resume = &kept;
  const std::vector<OutputStatistics> resumed = statistics_of(s, second);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(whole[i].greatest, resumed[i].greatest);
    EXPECT_EQ(whole[i].least_at, resumed[i].least_at);
    EXPECT_EQ(whole[i].square, resumed[i].square);
  }
}

/// A step that ends where an effort jumps is of the effort before: the work is what the power makes over time.
TEST(OutputStatistics, OfWhatJumpsAreThoseOfBothSides) {
  const test::LoadedScene s(R"(format: withy/1
time: {end: 1.2, output: 1}
integrator: {name: dop853, rtol: 1e-9, atol: 1e-11}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs:
  drive: {type: effort, hinge: slide}
  power: {type: power}
loads:
  push: {type: hinge-effort, hinge: slide, law: steps, table: [[0, 1], [0.35, 5], [0.9, -3]]}
)");
  StatisticsWatch watch(s.scene.outputs, {"drive", "power"}, *s.equations, discontinuities(*s.scene.model),
                        StepParts(*s.scene.model, s.scene.initial.time, *s.scene.end));
  RunOptions options;
  options.end = end_of_run(s.scene);
  options.output = s.scene.output;
  const RunSummary summary =
      simulate(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options, {}, &watch);
  ASSERT_EQ(summary.status, RunStatus::completed) << summary.message;
  const std::vector<OutputStatistics> all = watch.results();
  EXPECT_NEAR(all[0].integral, 0.35 + 5 * 0.55 - 3 * 0.3, 1e-12);
  EXPECT_EQ(all[0].greatest, 5);
  EXPECT_EQ(all[0].least, -3);
  const double speed = all[0].integral / 2;
  EXPECT_NEAR(all[1].integral, speed * speed, 1e-9) << "½ m v² of m = 2";
}

}  // namespace
}  // namespace withy
