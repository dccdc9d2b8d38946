// Pictures of the modes of equal blades.
#include "withy/results/blade_branches.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "withy/results/modes_files.hpp"

namespace withy {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A value with the modes of branches 0, 1, …; an exponent of NaN stands for a branch that has none there.
study::ModesAt value(double at, const std::vector<std::complex<double>>& exponents) {
  study::BladeModes seen;
  seen.blades = {"a", "b", "c"};
  for (std::size_t i = 0; i < exponents.size(); ++i) {
    if (std::isnan(exponents[i].real())) continue;
    seen.modes.push_back({exponents[i], "mode" + std::to_string(i), 1, {}, true});
    seen.branches.push_back(i);
  }
  study::ModesAt point;
  point.value = at;
  point.turn.emplace();
  point.turn->blades = std::move(seen);
  return point;
}

study::ModesOf run_of(std::vector<study::ModesAt> points) {
  study::ModesOf run;
  run.formulation = "quadratic";
  run.points = std::move(points);
  return run;
}

std::vector<std::string> names_of(const study::ModesOf& run, std::size_t count) {
  std::vector<std::string> names;
  for (const BladeBranch& branch : blade_branches(run, count)) names.push_back(branch.name);
  return names;
}

const double none = std::numeric_limits<double>::quiet_NaN();

TEST(BladeBranches, WhatGrowsIsShownBeyondTheNumberAskedForAndWhatIsRigidIsNot) {
  using C = std::complex<double>;
  const study::ModesOf run = run_of({value(1, {0, {-1, 2}, {-1, 3}, 4}), value(2, {0, {-1, 2}, {-1, 3}, 5})});
  EXPECT_EQ(names_of(run, 1), (std::vector<std::string>{"mode1", "mode3"}));
  EXPECT_EQ(blade_branches(run, 1)[1].at[0]->exponent, C(4));
  EXPECT_EQ(names_of(run, 2), (std::vector<std::string>{"mode1", "mode2", "mode3"}));
}

TEST(BladeBranches, APictureOfWhatDivergesHasItsGrowth) {
  const study::Sweep sweep{"spin.shaft", {1, 2}};
  const auto picture = [&](double growth) {
    return blades_picture({run_of({value(1, {growth, {-1, 2}}), value(2, {growth, {-1, 2}})})}, "", sweep, 2);
  };
  EXPECT_THAT(picture(0.8), HasSubstr("growth [1/s]"));
  EXPECT_THAT(picture(-0.8), Not(HasSubstr("growth [1/s]")));
}

/// How many lines the picture draws of its curves.
std::size_t lines_in(const std::string& picture) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = picture.find("<polyline", at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST(BladeBranches, NoLineJoinsValuesOverOneThatHasNoMode) {
  const study::Sweep sweep{"loads.k.stiffness", {1, 2, 3, 4, 5}};
  const auto drawn = [&](double middle) {
    std::vector<study::ModesAt> points;
    for (const double x : sweep.values) points.push_back(value(x, {{0, x == 3 ? middle : x}}));
    if (std::isnan(middle)) points[2] = value(3, {none});
    return lines_in(blades_picture({run_of(std::move(points))}, "", sweep, 2));
  };
  EXPECT_EQ(drawn(none), drawn(3) + 1);
}

/// The line of one turn is |rate|: of rates of both signs it comes down to zero and rises.
TEST(BladeBranches, TheLineOfOneTurnFollowsRatesOfEitherSign) {
  const auto picture = [](const std::vector<double>& rates) {
    std::vector<study::ModesAt> points;
    for (const double x : rates) points.push_back(value(x, {{-0.1, 100}}));
    return blades_picture({run_of(std::move(points))}, "", {"spin.shaft", rates}, 2);
  };
  EXPECT_THAT(picture({0, -2, -4}), HasSubstr("once a turn"));
  EXPECT_THAT(picture({4, 2, 0}), HasSubstr("once a turn"));
  EXPECT_THAT(picture({-4, 0, 4}), HasSubstr("once a turn"));
  EXPECT_THAT(picture({-4, -2}), HasSubstr("once a turn"));
  EXPECT_THAT(picture({150, 300}), Not(HasSubstr("once a turn"))) << "it is above the picture";
  EXPECT_THAT(picture({30, 60}),
              testing::AllOf(HasSubstr("once a turn"), HasSubstr("3 times a turn"), Not(HasSubstr("6 times a turn"))));
}

}  // namespace
}  // namespace withy
