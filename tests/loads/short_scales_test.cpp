/// \file
/// Derivatives of loads that have none of their own, at lengths far below and above a metre.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "withy/core/plugin/refined_difference.hpp"
#include "withy/core/tangents/tangent_dynamics.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy {
namespace {

using test::LoadedScene;
using Number = Eigen::Matrix<double, 1, 1>;

Tangents tangents_of(const LoadedScene& s) {
  const TangentDynamics dynamics(s.scene.model, s.scene.formulation->terms());
  const auto speeds = static_cast<Eigen::Index>(s.scene.model->layout().speeds);
  return dynamics.tangents(0, s.scene.initial.y, Eigen::VectorXd::Zero(speeds));
}

/// A block that slides across the line of a spring of length d, slack at 0.4 d: its stiffness is 0.6 k whatever d.
TEST(ShortScales, SpringsOfAnyLengthHaveTheirStiffness) {
  for (double d = 1; d > 1e-7; d /= 10) {
    const LoadedScene s(
        "format: withy/1\ntime: {end: 1}\nbodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}\n"
        "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}\n" +
        fmt::format("loads: {{stay: {{type: spring-damper, frame: block, anchor: [0, {}, 0], stiffness: 1000, "
                    "damping: 3, free_length: {}}}}}\n",
                    d, 0.4 * d));
    EXPECT_NEAR(tangents_of(s).by_position(0, 0), 600, 600e-8) << d;
  }
}

/// A force −k x³/d² along x, at x = d, by a formula of a distance, which has no derivatives: its slope is −3 k.
TEST(ShortScales, FormulasOfSignalsOfAnyLengthHaveTheirSlope) {
  for (double d = 1; d > 1e-7; d /= 10) {
    const LoadedScene s(
        "format: withy/1\ntime: {end: 1}\nbodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}\n"
        "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}\n"
        "outputs: {far: {type: distance, to: block}}\n" +
        fmt::format("loads: {{law: {{type: expression, hinge: slide, value: -30 * far * far * far / {} ^ 2}}}}\n"
                    "initial: {{hinges: {{slide: {{position: [{}]}}}}}}\n",
                    d, d));
    EXPECT_NEAR(tangents_of(s).by_position(0, 0), 90, 90e-8) << d;
  }
}

/// A body on a slide or a turn far out, on a spring that is slack there, by a formula: k = 10 at any distance.
TEST(FarAway, SpringsHaveTheirStiffness) {
  const auto stiffness = [](const std::string& position, const std::string& law) {
    const LoadedScene s(
        "format: withy/1\ntime: {end: 1}\nbodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
        "hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}\n" +
        fmt::format("initial: {{hinges: {{h: {{position: [{}]}}}}}}\n"
                    "loads: {{stay: {{type: expression, hinge: h, value: \"{}\"}}}}\n",
                    position, law));
    return tangents_of(s).by_position(0, 0);
  };
  for (const char* place : {"1000", "3e7", "4.5e7", "1e8", "3.844e8", "1e9", "1e10", "1e12"})
    EXPECT_NEAR(stiffness(place, fmt::format("-10 * (h - {})", place)), 10, 1e-10) << place;
  // What rounds inside has stairs of 2 µrad there.
  EXPECT_NEAR(stiffness("0.001", "-10 * ((h + 1e10) - 1e10)"), 10, 0.05);
}

constexpr double first_step = 0x1p-10;  ///< of a millimetre: the power of two that is nearest

TEST(RefinedDifference, HasTheNumbersOfItsFirstStepWhereAShorterOneGivesTheSame) {
  const auto f = [](double x) { return Number(std::sin(1 + x)); };
  EXPECT_EQ(refined_difference(f, 1e-3)(0), central_difference(f, first_step)(0));
}

/// Steps that are powers of two add to places, and multiply with slopes, without rounding.
TEST(RefinedDifference, OfWhatIsLinearIsExact) {
  for (const double slope : {1.0, 3.0, 0.7, -0.25, 315000.0, 1.0 / 3})
    EXPECT_EQ(refined_difference([&](double x) { return Number(slope * x); }, 1e-3)(0), slope);
  for (const double value : {1.0, -5.0})
    EXPECT_EQ(refined_difference([&](double x) { return Number(value + 3 * x); }, 1e-3)(0), 3) << value;
}

/// Of a contact or a latch of short reach, which long steps do not meet.
TEST(RefinedDifference, SeesWhatActsNearbyAlone) {
  for (double reach = 1e-2; reach > 1e-8; reach /= 3) {
    const auto f = [&](double x) { return Number(-200 * x * std::exp(-std::pow(x / reach, 2))); };
    EXPECT_NEAR(refined_difference(f, 1e-3)(0), -200, 1e-5) << reach;
    const auto beside = [&](double x) -> Eigen::Matrix<double, 1, 2> { return {f(x)(0), 3 * x}; };
    EXPECT_NEAR(refined_difference(beside, 1e-3)(0), -200, 1e-5) << reach;
    EXPECT_NEAR(refined_difference(beside, 1e-3)(1), 3, 1e-10) << reach;
  }
}

/// Cogging, phases that are wrapped and gratings have round pitches, of which steps of a millimetre are a whole number.
TEST(RefinedDifference, SeesWhatRepeatsInRoundPitches) {
  const double turn = 2 * std::numbers::pi;
  for (const double pitch : {2e-3, 1e-3, 5e-4, 3e-4, 2.5e-4, 2e-4, 1.25e-4, 1e-4, 5e-5, 2.5e-5, 1e-5}) {
    for (const double phase : {0.0, 0.13, -0.31}) {
      const auto wave = [&](double x) { return Number(pitch / turn * std::sin(turn * (x / pitch + phase))); };
      EXPECT_NEAR(refined_difference(wave, 1e-3)(0), std::cos(turn * phase), 1e-8) << pitch << ", " << phase;
      const auto wrapped = [&](double x) { return Number(pitch * std::remainder(x / pitch + phase, 1.0)); };
      EXPECT_NEAR(refined_difference(wrapped, 1e-3)(0), 1, 1e-8) << pitch << ", " << phase;
      const auto beside = [&](double x) { return Number(0.7 * x + wrapped(x)(0)); };
      EXPECT_NEAR(refined_difference(beside, 1e-3)(0), 1.7, 1e-8) << pitch << ", " << phase;
    }
  }
}

TEST(RefinedDifference, FindsTheSlopeBesideAKinkAndThatOfAShortScale) {
  EXPECT_NEAR(refined_difference([](double x) { return Number(std::abs(x + 1e-6)); }, 1e-3)(0), 1, 1e-9);
  EXPECT_NEAR(refined_difference([](double x) { return Number(std::tanh(x / 1e-6)); }, 1e-3)(0), 1e6, 1e-2);
}

TEST(RefinedDifference, DoesNotBelieveWhatStairsOfRoundingHaveBetweenThem) {
  for (const double far : {1e9, 1e10, 1e11}) {
    const double tread = far * 2.3e-16;
    const auto alone = [&](double x) { return Number(-10 * ((x + 0.3e-3 + far) - far)); };
    EXPECT_NEAR(refined_difference(alone, 1e-3)(0), -10, 20 * tread / 1e-3) << far;
    const auto beside = [&](double x) { return Number(alone(x)(0) - 0.5 * x); };
    EXPECT_NEAR(refined_difference(beside, 1e-3)(0), -10.5, 20 * tread / 1e-3) << far;
    EXPECT_EQ(refined_difference([&](double x) { return Number(-10 * ((far + x) - far)); }, 1e-3, far)(0), -10)
        << "a place that is known to be far";
  }
}

TEST(RefinedDifference, FindsNoSlopeInADeadZoneBehindALimitAndBesideAJump) {
  for (const double w : {3e-3, 1e-4, 1e-6, 1e-8}) {
    const auto dead = [&](double x) { return Number(x - std::clamp(x, -w, w)); };
    EXPECT_EQ(refined_difference(dead, 1e-3)(0), 0) << w;
    EXPECT_EQ(refined_difference([&](double x) { return Number(std::min(x, -w)); }, 1e-3)(0), 0) << w;
    EXPECT_EQ(refined_difference([&](double x) { return Number(x > w ? 1.0 : 0.0); }, 1e-3)(0), 0) << w;
  }
}

TEST(RefinedDifference, TellsAJumpAsItsFirstStepHasIt) {
  const auto f = [](double x) { return Number(x < 0 ? -1.0 : 1.0); };
  EXPECT_EQ(refined_difference(f, 1e-3)(0), central_difference(f, first_step)(0));
}

}  // namespace
}  // namespace withy
