// Outputs by hand: what single sensors show of states that are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "withy/tests/loads/shown_outputs.hpp"

namespace withy {
namespace {

using test::Shown;

/// At the start of a scene whose bodies are called a and b.
Shown at_start(const std::string& hinges, const std::string& outputs, const std::string& more = "") {
  return Shown(
      "format: withy/1\ntime: {end: 0.01, output: 0.01}\nbodies:\n"
      "  a: {type: rigid, mass: 2, inertia: [0.2, 0.2, 0.2, 0, 0, 0], frames: {turned: {orientation: {xyz: "
      "[0, \"90 deg\", 0]}}, both: {orientation: {xyz: [0.4, \"90 deg\", 0.3]}}}}\n"
      "  b: {type: rigid, mass: 2, inertia: [0.2, 0.2, 0.2, 0, 0, 0]}\nhinges:\n" +
      hinges + "outputs:\n" + outputs + more);
}

const std::string crossed =
    "  one: {type: revolute, axis: [1, 0, 0], parent: world, child: a}\n"
    "  two: {type: revolute, axis: [0, 0, 1], parent: world, child: b}\n";

// a turns by 0.5 about x, b by 0.8 about z: of the direction (1, 1, 0) of each.
TEST(ShownSensors, AnAngleIsThatOfADirectionInEachOfTheFrames) {
  const Shown s = at_start(crossed, "  seen: {type: angle, from: a, to: b, axis: [2, 2, 0]}\n",
                           "initial: {hinges: {one: {position: [0.5]}, two: {position: [0.8]}}}\n");
  const double c = std::cos(0.8), n = std::sin(0.8);
  EXPECT_NEAR(s["seen"].front(), std::acos((c - n + std::cos(0.5) * (n + c)) / 2), 1e-14);
}

TEST(ShownSensors, ADistanceOfNothingGrowsWithTheSpeed) {
  const Shown s = at_start(
      "  one: {type: prismatic, axis: [1, 0, 0], parent: world, child: a}\n"
      "  two: {type: prismatic, axis: [0, 1, 0], parent: world, child: b}\n",
      "  seen: {type: distance, from: a, to: b}\n", "initial: {hinges: {one: {rate: [3]}, two: {rate: [4]}}}\n");
  EXPECT_EQ(s["seen"].front(), 0);
  EXPECT_NEAR(s["seen.rate"].front(), 5, 1e-14);
}

// (0.2 + 0.5) 2²/2 with the rotor, 0.2 · 2²/2 of the body by itself.
TEST(ShownSensors, TheEnergyOfAllIsThatOfRotorsToo) {
  const Shown s = at_start(
      "  one: {type: revolute, axis: [1, 0, 0], parent: world, child: a, reflected_inertia: 0.5}\n"
      "  two: {type: weld, parent: world, child: b}\n",
      "  whole: {type: energy}\n  body: {type: energy, of: a}\n", "initial: {hinges: {one: {rate: [2]}}}\n");
  EXPECT_NEAR(s["whole.kinetic"].front(), 1.4, 1e-14);
  EXPECT_NEAR(s["body.kinetic"].front(), 0.4, 1e-14);
}

// The frame's −x is the axle: 0.6 N m on 0.2 kg m², at 2 rad/s.
TEST(ShownSensors, AFrameSeesItselfInItsOwnAxes) {
  const Shown s = at_start(
      "  one: {type: revolute, axis: [0, 0, 1], parent: world, child: a}\n"
      "  two: {type: weld, parent: world, child: b}\n",
      "  own: {type: frame, of: a.turned, in: own}\n  seen: {type: frame, of: a.both}\n",
      "loads: {drive: {type: hinge-effort, hinge: one, value: 0.6}}\ninitial: {hinges: {one: {rate: [2]}}}\n");
  EXPECT_NEAR(s["own.wx"].front(), -2, 1e-14);
  EXPECT_NEAR(s["own.alphax"].front(), -3, 1e-13);
  EXPECT_NEAR(s["own.alphaz"].front(), 0, 1e-13);
  // Where the second angle is a right one the others add up: 0.4 + 0.3.
  EXPECT_NEAR(s["seen.rx"].front(), 0.7, 1e-12);
  EXPECT_NEAR(s["seen.ry"].front(), std::numbers::pi / 2, 1e-7);
  EXPECT_EQ(s["seen.rz"].front(), 0);
}

TEST(ShownSensors, AccelerationsOfAHingeHaveTheNamesOfThoseOfAFrame) {
  const Shown s =
      at_start("  one: {type: free, parent: world, child: a}\n  two: {type: weld, parent: world, child: b}\n",
               "  seen: {type: hinge, hinge: one, show: acceleration}\n");
  std::vector<std::string> columns;
  for (const Column& c : s.columns) columns.push_back(c.name + '[' + c.unit + ']');
  EXPECT_THAT(columns, testing::ElementsAre("seen.alphax[rad/s^2]", "seen.alphay[rad/s^2]", "seen.alphaz[rad/s^2]",
                                            "seen.ax[m/s^2]", "seen.ay[m/s^2]", "seen.az[m/s^2]"));
}

// 0.2 kg m² · 2 rad/s² · 3 rad/s go into the body: of them 0.6 N m · 3 rad/s are a load's, and the rest the motion's.
TEST(ShownSensors, PowerIsOfLoadsAndMotionsTogetherOrOfOne) {
  const Shown s = at_start(
      "  one: {type: revolute, axis: [1, 0, 0], parent: world, child: a}\n"
      "  two: {type: weld, parent: world, child: b}\n",
      "  all: {type: power}\n  of_motion: {type: power, of: motion}\n  of_drive: {type: power, of: drive}\n",
      "loads: {drive: {type: hinge-effort, hinge: one, value: 0.6}}\n"
      "motions: {turn: {type: expression, hinge: one, value: 3*t + t^2}}\n");
  EXPECT_NEAR(s["all"].front(), 1.2, 1e-14);
  EXPECT_NEAR(s["of_drive"].front(), 1.8, 1e-14);
  EXPECT_NEAR(s["of_motion"].front(), -0.6, 1e-14);
}

// What falls feels neither weight nor fields, and what is held feels them the other way.
TEST(ShownSensors, AnAccelerometerThatFallsShowsNothing) {
  const Shown s =
      at_start("  one: {type: free, parent: world, child: a}\n  two: {type: weld, parent: world, child: b}\n",
               "  falls: {type: accelerometer, of: a}\n  stands: {type: accelerometer, of: b}\n",
               "gravity: [0, 0, -9]\nloads: {base: {type: base-excitation, law: constant, value: [2, 0, 0]}}\n");
  for (const char* axis : {"x", "y", "z"}) EXPECT_NEAR(s[std::string("falls.") + axis].front(), 0, 1e-14);
  EXPECT_NEAR(s["stands.x"].front(), 2, 1e-14);
  EXPECT_NEAR(s["stands.z"].front(), 9, 1e-14);
}

}  // namespace
}  // namespace withy
