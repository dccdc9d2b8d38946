#include "withy/study/crossing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace withy::study {
namespace {

TEST(FindCrossing, IsWhereAnErrorThatGrowsByPowersPassesTheLimit) {
  const auto quartic = [](double v) { return v * v * v * v; };
  for (const auto& values : {std::vector<double>{0, 0.5, 1}, std::vector<double>{0, -0.5, -1}}) {
    const Crossing c = find_crossing(quartic, values, 0.01, 1e-6);
    ASSERT_EQ(c.kind, Crossing::Kind::passes);
    EXPECT_NEAR(c.value, std::copysign(std::pow(0.01, 0.25), values[1]), 1e-6);
    EXPECT_FALSE(c.fails);
  }
}

TEST(FindCrossing, IsTheFirstOfThoseThatTheValuesTellApart) {
  const auto wave = [](double v) { return std::pow(std::sin(v), 2); };
  const Crossing c = find_crossing(wave, {0, 1, 2, 3, 4, 5}, 0.25, 1e-6);
  EXPECT_NEAR(c.value, std::asin(0.5), 1e-5);
}

TEST(FindCrossing, SaysWhereAModelFailsBeforeItsErrorPasses) {
  const auto fails = [](double v) { return v < 0.7 ? 1e-3 * v : std::numeric_limits<double>::infinity(); };
  const Crossing c = find_crossing(fails, {0, 0.25, 0.5, 0.75, 1}, 0.01, 1e-6);
  ASSERT_EQ(c.kind, Crossing::Kind::passes);
  EXPECT_NEAR(c.value, 0.7, 1e-6);
  EXPECT_TRUE(c.fails);
  // It fails in the end, but is inexact long before.
  const auto late = [](double v) { return v < 0.9 ? v * v : std::numeric_limits<double>::infinity(); };
  const Crossing d = find_crossing(late, {0, 1}, 0.01, 1e-6);
  EXPECT_NEAR(d.value, 0.1, 1e-6);
  EXPECT_FALSE(d.fails);
}

TEST(FindCrossing, HoldsOrExceedsFromTheBeginning) {
  const auto line = [](double v) { return v; };
  EXPECT_EQ(find_crossing(line, {0, 1}, 2, 1e-6).kind, Crossing::Kind::holds);
  EXPECT_EQ(find_crossing(line, {1, 2}, 0.5, 1e-6).kind, Crossing::Kind::exceeds);
  const auto none = [](double) { return std::numeric_limits<double>::quiet_NaN(); };
  const Crossing c = find_crossing(none, {1, 2}, 0.5, 1e-6);
  EXPECT_EQ(c.kind, Crossing::Kind::exceeds);
  EXPECT_TRUE(c.fails);
}

}  // namespace
}  // namespace withy::study
