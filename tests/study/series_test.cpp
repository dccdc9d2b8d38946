// Where series of runs with a mode more each lead to: limits of series that are known, and what they may be off by.
#include "withy/study/series.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

/// By how much a run with n modes is off.
using Error = std::function<double(int)>;

/// A made-up motion of all outputs of a scene that has numbers, vectors and orientations.
class MadeUp {
 public:
  MadeUp()
      : scene_(prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spacecraft.yaml"), plugins())),
        outputs_(Outputs::all(scene_.model())) {}

  [[nodiscard]] const Outputs& outputs() const { return outputs_; }

  /// Histories whose errors are `first` of one shape over time and `second` of another.
  [[nodiscard]] Readings run(double first, double second = 0) const {
    return run([=](double t) { return first * std::sin(3 * t) * t + second * std::cos(7 * t) * t; });
  }
  /// Histories that are off by so much at each time.
  [[nodiscard]] Readings run(const std::function<double(double)>& off_at) const {
    Readings r;
    for (int i = 0; i <= 40; ++i) {
      const double t = 0.05 * i, off = off_at(t);
      std::vector<double> values(outputs_.size());
      for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::cos(t + static_cast<double>(k)) + off;
      for (const Output& o : outputs_.list()) {
        if (o.shape != Output::Shape::orientation) continue;
        const Eigen::Quaterniond q(Eigen::AngleAxisd(0.8 * t + off, Eigen::Vector3d(1, 2, 2) / 3));
        values[o.at] = q.w(), values[o.at + 1] = q.x(), values[o.at + 2] = q.y(), values[o.at + 3] = q.z();
      }
      r.times.push_back(t);
      r.values.push_back(std::move(values));
    }
    return r;
  }

  /// The series from two modes to `modes`.
  [[nodiscard]] ModeSeries series(
      int modes, const Error& first, const Error& second = [](int) { return 0.0; }) const {
    ModeSeries all(outputs_, 1);
    for (int n = 2; n <= modes; ++n) all.add(n, run(first(n), second(n)));
    return all;
  }
  /// Greatest distance from the truth over what is told of it, among the outputs.
  [[nodiscard]] double over_told(const ModeSeries& series) const {
    const Distances off = distances(outputs_, series.limit(), run(0)).first;
    double most = 0;
    for (std::size_t k = 0; k < off.size(); ++k) most = std::max(most, off[k] / (series.own()[k] + 1e-9));
    return most;
  }
  /// Greatest distance of readings from the truth.
  [[nodiscard]] double off(const Readings& readings) const {
    const Distances all = distances(outputs_, readings, run(0)).first;
    return *std::max_element(all.begin(), all.end());
  }

 private:
  Prepared scene_;
  Outputs outputs_;
};

Error geometric(double ratio) {
  return [ratio](int n) { return 0.05 * std::pow(ratio, n); };
}
Error algebraic(double p) {
  return [p](int n) { return 0.05 * std::pow(n, -p); };
}

TEST(Tail, IsThatOfTheTwoLawsItStandsFor) {
  for (int n = 3; n <= 12; ++n) {
    for (const double p : {1.0, 2.0, 3.0, 6.0}) {
      const auto at = [p](int k) { return std::pow(k, -p); };
      const double step = at(n - 1) - at(n), ratio = step / (at(n - 2) - at(n - 1));
      EXPECT_NEAR(tail(n, ratio).algebraic, at(n) / step, 1e-9 * at(n) / step) << n << ' ' << p;
      EXPECT_NEAR(tail(n, ratio).geometric, ratio / (1 - ratio), 1e-9);
      EXPECT_GT(tail(n, ratio).algebraic, tail(n, ratio).geometric) << "more is left of what slows down";
    }
    EXPECT_NEAR(tail(n, 1).algebraic, n - 1, 1e-9) << "nothing is slower than 1/n";
    EXPECT_EQ(tail(n, 0).algebraic, 0);
    EXPECT_EQ(tail(n, -0.5).geometric, 0);
    EXPECT_EQ(tail(n, 1e-300).algebraic, 0);
  }
}

TEST(ModeSeries, ASeriesOfOneLawIsAtMostHalfAsFarOffAsItSaysAndNoFurtherThanItsLastRun) {
  const MadeUp made;
  const std::vector<Error> laws = {geometric(0.1), geometric(0.3), geometric(0.5), algebraic(1),
                                   algebraic(2),   algebraic(3),   algebraic(6)};
  for (std::size_t law = 0; law < laws.size(); ++law)
    for (int modes = 4; modes <= 10; ++modes) {
      const ModeSeries series = made.series(modes, laws[law]);
      EXPECT_TRUE(series.extrapolated());
      EXPECT_LE(made.over_told(series), 0.501) << law << ' ' << modes;
      const double last = made.off(made.run(laws[law](modes)));
      EXPECT_LT(made.off(series.limit()), 1.001 * last + 1e-9) << law << ' ' << modes;
    }
}

TEST(ModeSeries, WhatIsToldOfOneLawIsNotFarAbove) {
  const MadeUp made;
  for (const double p : {1.0, 2.0, 3.0}) {
    const ModeSeries series = made.series(8, algebraic(p));
    EXPECT_GT(made.over_told(series), 0.45) << "it is half of what the laws are apart";
  }
}

/// Two bodies, or bending and twist, converge each by its own law and at times of their own. A slow part that a fast
/// one hides is seen too small.
TEST(ModeSeries, ASumOfTwoSeriesIsAtMostThreeTimesAsFarOffAsItSays) {
  const MadeUp made;
  double most = 0;
  for (const double p : {1.0, 2.0, 3.0})
    for (const double ratio : {0.1, 0.3, 0.5})
      for (const double part : {-3.0, -0.5, 0.2, 1.0, 5.0})
        for (int modes = 4; modes <= 8; ++modes) {
          const Error fast = geometric(ratio);
          const ModeSeries series = made.series(modes, algebraic(p), [&](int n) { return part * fast(n); });
          most = std::max(most, made.over_told(series));
        }
  EXPECT_LT(most, 3);
}

/// As of an effort of a beam that is let go: every mode adds what vibrates at a frequency of its own. At the start all
/// of them add up, and at no other time: what steps have in common over time tells nothing, what is left of their sizes
/// is what is missing there.
TEST(ModeSeries, StepsThatAddUpAtOneTimeAloneAreKnownByTheirSizes) {
  constexpr int all_modes = 400;
  const MadeUp made;
  for (const double p : {1.0, 2.0, 3.0})
    for (const int step : {1, 2, 4}) {
      ModeSeries series(made.outputs(), 1);
      for (int modes = 4; modes <= 8 + 2 * step; modes += step) {
        const auto off = [&](double t) {
          double sum = 0;
          for (int n = modes + 1; n <= all_modes; ++n)
            sum += (algebraic(p)(n - 1) - algebraic(p)(n)) * std::cos(3.5 * n * n * t);
          return sum;
        };
        series.add(modes, made.run(off));
        if (series.size() < 4) continue;
        EXPECT_LE(made.over_told(series), 1.05) << modes << " by " << step << ", " << p;
      }
    }
}

/// Late in a series levels are several modes apart.
TEST(ModeSeries, OneThatLeapsIsKnownAsWell) {
  std::vector<int> all{2};
  while (all.back() < 24) all.push_back(all.back() + next_step(all.back()));
  EXPECT_EQ(all, (std::vector<int>{2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24}));
  const MadeUp made;
  for (const double p : {1.0, 2.0, 3.0}) {
    ModeSeries series(made.outputs(), 1);
    for (const int modes : all) {
      series.add(modes, made.run(algebraic(p)(modes)));
      if (modes < 4) continue;
      EXPECT_LE(made.over_told(series), 0.501) << modes << ' ' << p;
      EXPECT_GT(made.over_told(series), 0.2) << modes << ' ' << p;
    }
  }
}

/// A run that comes between two others makes two shorter steps of the last.
TEST(ModeSeries, OfAllStepsThatEndAtTheLastRunTheBestCounts) {
  const MadeUp made;
  const auto own = [&](const std::vector<int>& all) {
    ModeSeries series(made.outputs(), 1);
    for (const int modes : all) series.add(modes, made.run(geometric(0.3)(modes)));
    return *std::max_element(series.own().begin(), series.own().end());
  };
  EXPECT_LT(own({3, 4, 5, 6, 7, 8}), own({3, 4, 5, 6, 8}));
  EXPECT_GT(own({3, 5, 8}), 3 * own({4, 6, 8})) << "no two steps are alike: it may be the first of those of 1/n";
}

TEST(ModeSeries, OneThatGoesToAndFroIsTakenAsItIs) {
  const MadeUp made;
  const ModeSeries series = made.series(6, [](int n) { return 0.05 * std::pow(-0.6, n); });
  EXPECT_FALSE(series.extrapolated());
  EXPECT_LE(made.over_told(series), 1);
}

/// Even modes of a motion that is nearly symmetric change little: the odd one that follows is no sign of a series that
/// does not converge.
TEST(ModeSeries, AStepThatIsSmallByItsKindDoesNotMakeTheNextCountAsTheFirstOfASlowSeries) {
  const MadeUp made;
  const Error by_turns = [](int n) { return 0.05 * std::pow(0.3, n / 2) * (n % 2 == 0 ? 1 : 0.95); };
  for (int modes = 6; modes <= 9; ++modes) {
    const ModeSeries series = made.series(modes, by_turns);
    EXPECT_LE(made.over_told(series), 1) << modes;
    const double told = *std::max_element(series.own().begin(), series.own().end()),
                 before = made.off(made.run(by_turns(modes - 2)));
    EXPECT_LT(told, 9 * before) << modes << ": by what the last step alone has shrunk, fourteen times and more";
  }
}

/// One step has no ratio.
TEST(ModeSeries, OfTwoRunsTheOneThatIsLikelyWorstIsToldOf) {
  const MadeUp made;
  const ModeSeries series = made.series(3, algebraic(1));
  EXPECT_FALSE(series.extrapolated());
  EXPECT_NEAR(made.over_told(series), 1, 1e-2);
}

TEST(ModeSeries, OfRunsThatAreEqualNothingIsLeft) {
  const MadeUp made;
  const ModeSeries series = made.series(6, [](int) { return 0.0; });
  EXPECT_FALSE(series.extrapolated());
  for (const double own : series.own()) EXPECT_LT(own, 1e-12);
}

TEST(ModeSeries, WhatIsNoNumberIsInfinitelyFar) {
  const MadeUp made;
  const double none = std::nan("");
  const ModeSeries series = made.series(4, [&](int n) { return n == 4 ? none : 0.1; });
  for (std::size_t k = 0; k < series.own().size(); ++k)
    EXPECT_TRUE(std::isinf(series.own()[k])) << made.outputs().list()[k].label;
}

/// Modes of a plate come in kinds, one after the other: steps of each have nothing to do with those before.
TEST(ModeSeries, OfSeveralKindsTheLastStepOfEachCounts) {
  const MadeUp made;
  ModeSeries series(made.outputs(), 3);
  series.add(2, made.run(0.5));
  series.add(3, made.run(0.1));
  for (int n = 4; n <= 5; ++n) series.add(n, made.run(0.1));
  EXPECT_FALSE(series.extrapolated());
  EXPECT_NEAR(made.over_told(series), 0.25, 1e-2);
}

}  // namespace
}  // namespace withy::study
