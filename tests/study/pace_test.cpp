// What the rest of a run will cost, by what it has cost so far.
#include "withy/study/pace.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace withy::study {
namespace {

/// A run of 10 s whose first tenth costs ten times as much a second as the rest: 1 s of CPU time for that, 0.9 for all
/// else.
double cost_of_slow_start(double gone) { return gone < 1 ? gone : 1 + 0.1 * (gone - 1); }

TEST(Pace, ASlowStartIsNotTakenForTheWholeRun) {
  Pace pace;
  for (double gone = 0; gone <= 1; gone += 0.01) pace.note(gone, cost_of_slow_start(gone));
  EXPECT_NEAR(pace.rest(10), 9, 0.2) << "nothing else was seen";
  double gone = 1;
  for (; cost_of_slow_start(gone) < 1.5; gone += 0.01) pace.note(gone, cost_of_slow_start(gone));
  EXPECT_NEAR(pace.rest(10), cost_of_slow_start(10) - cost_of_slow_start(gone), 0.3);
  for (; gone <= 10; gone += 0.01) pace.note(gone, cost_of_slow_start(gone));
  EXPECT_NEAR(pace.rest(10), 0, 0.01);
}

TEST(Pace, ARunThatGetsSlowerIsSeenToBeTooCostlyLater) {
  Pace pace;
  const auto cost = [](double gone) { return gone < 5 ? 0.01 * gone : 0.05 + 2 * (gone - 5); };
  double cut = 0;
  for (double gone = 0; gone <= 10 && cut == 0; gone += 0.01) {
    pace.note(gone, cost(gone));
    if (!may_go_on(cost(gone), pace.rest(10), 1)) cut = gone;
  }
  EXPECT_GT(cut, 5);
  EXPECT_LT(cost(cut), 0.2) << "not the whole second is spent on it";
}

TEST(Pace, NothingIsJudgedBeforeItHasShownItsPaceAndNothingGoesBeyondWhatIsLeft) {
  EXPECT_TRUE(may_go_on(0.09, std::numeric_limits<double>::infinity(), 1));
  EXPECT_FALSE(may_go_on(0.11, 0.9, 1));
  EXPECT_TRUE(may_go_on(0.11, 0.88, 1));
  EXPECT_FALSE(may_go_on(0.01, 0, 0.005));
}

TEST(Pace, ANewRunBeginsAnew) {
  Pace pace;
  EXPECT_EQ(pace.rest(1), 0) << "nothing is known";
  pace.note(1, 5);
  pace.note(0.5, 0.05);
  EXPECT_NEAR(pace.rest(1), 0.05, 1e-15);
  pace.note(0.5, 0.06);
  EXPECT_NEAR(pace.rest(1), 0.06, 1e-15);
}

/// As a run with more modes is, which costs three times as much all along.
TEST(Pace, ARunIsTakenToBeLikeTheLastThatEnded) {
  Pace pace;
  for (double gone = 0; gone <= 10; gone += 0.01) pace.note(gone, cost_of_slow_start(gone));
  pace.end();
  double gone = 0;
  for (; gone < 0.5; gone += 0.01) pace.note(gone, 3 * cost_of_slow_start(gone));
  EXPECT_NEAR(pace.rest(10), 3 * (1.9 - 0.5), 0.2) << "though it has seen a slow start alone";
  pace.note(0.1, 0.05);  // it was cut there, and another has begun
  EXPECT_NEAR(pace.rest(10), 0.5 * 1.9 - 0.05, 0.01) << "one that did not end shows nothing";
}

TEST(Pace, WhereARunCostNothingSoFarThatEndedItsOwnPaceCounts) {
  Pace pace;
  pace.note(0, 0);
  pace.note(5, 0);
  pace.note(10, 1);
  pace.end();
  pace.note(0, 0);
  pace.note(1, 0.1);
  EXPECT_NEAR(pace.rest(10), 0.9, 1e-12);
}

}  // namespace
}  // namespace withy::study
