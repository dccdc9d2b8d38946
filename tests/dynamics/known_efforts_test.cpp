/// \file
/// What cases in lanes have found of efforts that are functions of time alone: known to those that come later.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "withy/core/equations/lane_efforts.hpp"

namespace withy::test {
namespace {

using equations::KnownEfforts;

class KnownEffortsOfALaw : public testing::Test {
 protected:
  /// What a case gets at these times, and how often it had to find it itself.
  struct Seen {
    std::vector<double> values;
    int found = 0;
  };
  Seen a_case_at(const std::vector<double>& times) {
    Seen seen;
    std::size_t next = 0;
    for (const double t : times) {
      seen.values.push_back(efforts_.at(t, next, [&] {
        ++seen.found;
        return law(t);
      }));
    }
    return seen;
  }
  static double law(double t) { return 3 * t * t - 1; }
  static std::vector<double> of_law(const std::vector<double>& times) {
    std::vector<double> values;
    for (const double t : times) values.push_back(law(t));
    return values;
  }
  std::shared_ptr<const int> of_ = std::make_shared<const int>(0);
  KnownEfforts efforts_{of_};
};

TEST_F(KnownEffortsOfALaw, a_case_at_the_times_of_another_finds_none_itself) {
  const std::vector<double> times = {0, 0.5, 1, 1.5, 2};
  EXPECT_EQ(a_case_at(times).found, 5);
  const Seen later = a_case_at(times);
  EXPECT_EQ(later.found, 0);
  EXPECT_EQ(later.values, of_law(times));
}

TEST_F(KnownEffortsOfALaw, a_case_that_goes_on_longer_finds_the_rest) {
  a_case_at({0, 0.5, 1});
  const std::vector<double> times = {0, 0.5, 1, 1.5, 2};
  const Seen longer = a_case_at(times);
  EXPECT_EQ(longer.found, 2);
  EXPECT_EQ(longer.values, of_law(times));
  EXPECT_EQ(a_case_at(times).found, 0);
}

TEST_F(KnownEffortsOfALaw, a_case_that_begins_late_finds_the_first_and_then_knows) {
  a_case_at({0, 0.5, 1, 1.5, 2});
  const Seen late = a_case_at({1, 1.5, 2});
  EXPECT_EQ(late.found, 1);
  EXPECT_EQ(late.values, of_law({1, 1.5, 2}));
}

TEST_F(KnownEffortsOfALaw, a_case_at_other_times_has_the_efforts_of_those_and_changes_none_for_others) {
  const std::vector<double> times = {0, 0.5, 1, 1.5, 2}, others = {0, 0.4, 0.5, 0.9, 1, 3};
  a_case_at(times);
  EXPECT_EQ(a_case_at(others).values, of_law(others));
  const Seen again = a_case_at(times);
  EXPECT_EQ(again.found, 0);
  EXPECT_EQ(again.values, of_law(times));
}

TEST_F(KnownEffortsOfALaw, more_times_than_are_kept_have_their_efforts_too) {
  std::vector<double> times;
  for (int i = 0; i < 40000; ++i) times.push_back(1e-3 * i);
  EXPECT_EQ(a_case_at(times).values, of_law(times));
  const Seen again = a_case_at(times);
  EXPECT_LT(again.found, 40000);
  EXPECT_GT(again.found, 0);
  EXPECT_EQ(again.values, of_law(times));
}

/// A law's place in memory may be another's after it: who keeps what it gave keeps the law.
TEST_F(KnownEffortsOfALaw, the_law_lives_as_long_as_what_is_known_of_it) {
  const std::weak_ptr<const int> law = of_;
  of_.reset();
  EXPECT_FALSE(law.expired());
}

}  // namespace
}  // namespace withy::test
