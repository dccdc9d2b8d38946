// Modes of equal blades along a sweep of the rotor's rate.
#include "withy/study/blade_tracker.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "withy/study/modes.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;

constexpr double length = 2, offset = 0.4, blade_mass = 1, flap_spring = 36;

/// Three point masses on rods at a hub, each on a flap and a lag hinge.
std::string hinged_rotor(double lag_spring) {
  std::string frames, bodies, hinges, loads;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2 * std::numbers::pi * k / 3;
    frames += fmt::format("b{}: {{position: [{}, {}, 0], orientation: {{axis: [0, 0, 1], angle: {}}}}}, ", k,
                          offset * std::cos(angle), offset * std::sin(angle), angle);
    bodies += fmt::format(
        "  cuff{0}: {{type: rigid, mass: 0}}\n  rod{0}: {{type: rigid, mass: {1}, center_of_mass: [{2}, 0, 0]}}\n", k,
        blade_mass, length);
    hinges += fmt::format(
        "  flap{0}: {{type: revolute, axis: [0, 1, 0], parent: hub.b{0}, child: cuff{0}}}\n"
        "  lag{0}: {{type: revolute, axis: [0, 0, 1], parent: cuff{0}, child: rod{0}}}\n",
        k);
    loads += fmt::format(
        "  f{0}: {{type: hinge-spring, hinge: flap{0}, stiffness: {1}}}\n"
        "  l{0}: {{type: hinge-spring, hinge: lag{0}, stiffness: {2}}}\n",
        k, flap_spring, lag_spring);
  }
  return "bodies:\n  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {" + frames + "}}\n" + bodies +
         "hinges:\n  shaft: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n" + hinges + "loads:\n" +
         loads;
}

/// Frequencies of a hinged blade as it turns with the rotor (Johnson, Helicopter Theory, section 9-1).
double flapping(double rate) {
  return std::sqrt(flap_spring / (blade_mass * length * length) + rate * rate * (1 + offset / length));
}
double lagging(double lag_spring, double rate) {
  return std::sqrt(lag_spring / (blade_mass * length * length) + rate * rate * offset / length);
}

/// That each branch is one of the six motions of blades that flap and lag, at every rate but zero.
void expect_closed_forms(double lag_spring, const std::vector<double>& rates) {
  const Prepared prepared = scene_of(hinged_rotor(lag_spring), {});
  const Sweep sweep{"spin.shaft", rates};
  TurningWish wish;
  wish.blades = true;
  const ModesOf run = sweep_modes(prepared.values, plugins(), {}, {}, sweep, false, wish, {});
  std::map<std::size_t, std::map<double, double>> seen;  // of each branch its frequencies over the rate
  std::size_t turning = 0;
  for (const ModesAt& at : run.points) {
    ASSERT_EQ(at.problem, "");
    if (at.value == 0) continue;
    ++turning;
    ASSERT_TRUE(at.turn && at.turn->blades) << at.turn->blade_problem;
    ASSERT_EQ(at.turn->blades->modes.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i)
      seen[at.turn->blades->branches[i]][at.value] = at.turn->blades->modes[i].exponent.imag();
  }
  ASSERT_EQ(seen.size(), 6U);
  const auto lag = [&](double rate) { return lagging(lag_spring, rate); };
  const std::vector<std::function<double(double)>> forms = {
      flapping, [](double r) { return flapping(r) + r; }, [](double r) { return flapping(r) - r; },
      lag,      [&](double r) { return lag(r) + r; },     [&](double r) { return std::abs(lag(r) - r); }};
  for (const auto& form : forms) {
    const auto is_form = [&](const auto& branch) {
      return branch.second.size() == turning && std::all_of(branch.second.begin(), branch.second.end(), [&](auto& at) {
               return std::abs(at.second - form(at.first)) < 1e-5;
             });
    };
    EXPECT_EQ(std::count_if(seen.begin(), seen.end(), is_form), 1) << "form " << &form - forms.data();
  }
}

/// Flapping and lagging cross, and from 8.94 rad/s on the backward lagging is slower than the rotor and seen forward:
/// each branch remains the motion that it is.
TEST(BladeTracker, BranchesOfAHingedRotorAreTheirClosedFormsThroughAllCrossings) {
  expect_closed_forms(256, {0, 1, 2, 3.5, 5, 6, 7, 7.3, 7.6, 8.5, 9.5, 10, 11, 13});
}

/// Both are forward from the start on, and at the second rate the slower one is nearest to where the faster one was.
TEST(BladeTracker, PatternsGainTheRotorsRateInTheFirstStep) { expect_closed_forms(1, {2, 4, 6, 8}); }

/// λ² + λ + k = 0 of one coordinate.
BladeModes one_coordinate(double k) {
  BladeModes found;
  found.masses = Eigen::VectorXd::Ones(1);
  const std::complex<double> root = std::sqrt(std::complex<double>(0.25 - k));
  for (const std::complex<double> exponent : {-0.5 + root, -0.5 - root}) {
    if (exponent.imag() < 0) continue;
    found.modes.push_back({exponent, "flap", 1, {}, true});
    found.shapes.emplace_back(Eigen::VectorXcd::Ones(1));
    found.waves.push_back(0);
  }
  return found;
}

TEST(BladeTracker, APairThatBecomesTwoRealExponentsGoesOnAndABranchBegins) {
  BladeTracker tracker;
  std::vector<std::vector<std::size_t>> branches;
  for (const double k : {1.0, 0.5, 0.2, -0.5, -1.0, 0.2, 0.5}) {
    BladeModes found = one_coordinate(k);
    tracker.follow(static_cast<double>(branches.size()), found);
    branches.push_back(found.branches);
  }
  EXPECT_EQ(branches[0], std::vector<std::size_t>{0});
  EXPECT_EQ(branches[1], std::vector<std::size_t>{0});
  for (const std::size_t at : {2, 3, 4, 5}) {
    std::vector<std::size_t> both = branches[at];
    std::sort(both.begin(), both.end());
    EXPECT_EQ(both, (std::vector<std::size_t>{0, 1})) << at;
  }
  EXPECT_EQ(branches[3], branches[4]) << "what grows is one branch";
  ASSERT_EQ(branches[6].size(), 1U);
  EXPECT_LT(branches[6][0], 2U);
}

TEST(BladeTracker, WhatIsLikeNothingBeforeBegins) {
  BladeTracker tracker;
  BladeModes before = one_coordinate(1), after = one_coordinate(1);
  before.masses = after.masses = Eigen::VectorXd::Ones(2);
  before.shapes[0] = Eigen::Vector2cd(1, 0);
  after.shapes[0] = Eigen::Vector2cd(0, 1);
  after.modes[0].exponent = {0, 40};
  tracker.follow(1, before);
  tracker.follow(2, after);
  EXPECT_NE(before.branches, after.branches);
}

}  // namespace
}  // namespace withy::study
