// Singular configurations of closed loops are seen wherever in a step they lie and however many loops are in one, and
// steps that turn far are no singularity.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <regex>
#include <sstream>
#include <string>

#include "four_bar.hpp"

namespace withy::test {
namespace {

/// A parallelogram of cranks of 1 m that are 2 m apart, at z = `place`, turning at 2 rad/s from an angle in degrees.
struct Parallelogram {
  std::string bodies, hinges, constraints, initial, guess;
  Parallelogram(int place, const std::string& angle) {
    const std::string i = std::to_string(place);
    const std::string link = ": {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0], frames: {p: {position: [";
    bodies = "  c" + i + link + "1, 0, 0]}}}\n  k" + i + link + "2, 0, 0]}}}\n  r" + i + link + "1, 0, 0]}}}\n";
    const std::string turns = ": {type: revolute, axis: [0, 0, 1], parent: ";
    hinges = "  m" + i + turns + "world, child: c" + i + ", offset: {position: [0, 0, " + i + "]}}\n  e" + i + turns +
             "c" + i + ".p, child: k" + i + "}\n  q" + i + turns + "world, child: r" + i +
             ", offset: {position: [2, 0, " + i + "]}}\n";
    constraints = "  l" + i + ": {type: hinge, hinge: revolute, axis: [0, 0, 1], a: k" + i + ".p, b: r" + i + ".p}\n";
    initial = "    m" + i + ": {position: " + angle + " deg, rate: 2}\n";
    guess = "      e" + i + ": {position: -" + angle + " deg}\n      q" + i + ": {position: " + angle + " deg}\n";
  }
};

std::string scene_of(const Parallelogram& first, const Parallelogram& second) {
  return "format: withy/1\ngravity: [0, 0, 0]\ntime: {end: 4}\nbodies:\n" + first.bodies + second.bodies + "hinges:\n" +
         first.hinges + second.hinges + "constraints:\n" + first.constraints + second.constraints +
         "initial:\n  hinges:\n" + first.initial + second.initial + "  guess:\n    hinges:\n" + first.guess +
         second.guess;
}

TEST(SingularLoops, AreSeenWhereTwoPassOneAtTheSameTime) {
  const Made made(scene_of({0, "90"}, {1, "90"}));
  const RunSummary summary = run(made, 4);
  EXPECT_EQ(summary.status, RunStatus::singular);
  // Links lie in one line at 180 degrees, 90 degrees on at 2 rad/s; the interval told is no wider than a step over
  // 4096.
  std::smatch told;
  ASSERT_TRUE(std::regex_search(summary.message, told, std::regex("between t = ([0-9.]+) and ([0-9.]+) s")))
      << summary.message;
  EXPECT_NEAR(std::stod(told[1]), std::numbers::pi / 4, 1e-3);
  EXPECT_NEAR(std::stod(told[2]), std::numbers::pi / 4, 1e-3);
  // The last state is one before.
  EXPECT_LT(summary.final.time, std::numbers::pi / 4);
}

TEST(SingularLoops, AreSeenWhereARunBeginsInOne) {
  const Made made(scene_of({0, "180"}, {1, "90"}));
  const RunSummary summary = run(made, 0.4);
  EXPECT_EQ(summary.status, RunStatus::singular);
  EXPECT_THAT(summary.message, testing::HasSubstr("begins in a singular configuration"));
}

TEST(SingularLoops, AreSeenWhereARunBeginsInOneAtRest) {
  std::string scene = scene_of({0, "180"}, {1, "90"});
  for (std::size_t at; (at = scene.find(", rate: 2")) != std::string::npos;) scene.erase(at, 9);
  const Made made(scene + "loads: {motor: {type: hinge-effort, hinge: m0, law: constant, value: 1}}\n");
  const RunSummary summary = run(made, 0.4);
  EXPECT_EQ(summary.status, RunStatus::singular);
  EXPECT_THAT(summary.message, testing::HasSubstr("begins in a singular configuration"));
}

TEST(SingularLoops, AreNotSlotsThatTurnFarInAStep) {
  const Made made(R"(format: withy/1
gravity: [0, 0, 0]
time: {end: 20}
bodies:
  arm: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  puck: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}
  plane: {type: planar, parent: world, child: puck}
constraints:
  slot: {type: hinge, hinge: prismatic, axis: [1, 0, 0], a: arm, b: puck}
motions:
  turn: {type: constant-rate, hinge: axle, rate: 3}
loads:
  x: {type: hinge-spring, hinge: plane, component: 1, stiffness: 25, damping: 20}
  y: {type: hinge-spring, hinge: plane, component: 2, stiffness: 25, damping: 20}
)");
  const RunSummary summary = run(made, 20);
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
  EXPECT_GT(summary.steps.largest_step * 3, std::numbers::pi / 2);
}

/// A slider-crank in line, whose slider is at 2 r cos A, or stays over the crank's pivot whatever A is: at a right
/// angle it may go on either way. With a rod that is a little longer it has one way alone.
std::string slider_crank(const std::string& rod, const std::string& integrator, const std::string& rate) {
  return "format: withy/1\ngravity: [0, 0, 0]\ntime: {end: 1}\nintegrator: " + integrator + R"(
bodies:
  crank: {type: rigid, mass: 1, center_of_mass: [0.25, 0, 0], inertia: [0.001, 0.02, 0.02, 0, 0, 0], frames: {pin: {position: [0.5, 0, 0]}}}
  rod: {type: rigid, mass: 1, center_of_mass: [0.25, 0, 0], inertia: [0.001, 0.02, 0.02, 0, 0, 0], frames: {pin: {position: [)" +
         rod + R"(, 0, 0]}}}
  slider: {type: rigid, mass: 0.5, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  crank: {type: revolute, axis: [0, 0, 1], parent: world, child: crank}
  elbow: {type: revolute, axis: [0, 0, 1], parent: crank.pin, child: rod}
  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: slider}
constraints: {pin: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: rod.pin, b: slider}}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 1, free_position: 0.5}}
initial: {hinges: {crank: {position: 0.3, rate: )" +
         rate + "}}}\n";
}

TEST(SingularLoops, AreSeenWhereWaysForkHoweverShortTheSteps) {
  for (const char* integrator :
       {"{name: dopri5, rtol: 1e-4, atol: 1e-6}", "{name: dopri5, rtol: 1e-8, atol: 1e-10}",
        "{name: dopri5, rtol: 1e-10, atol: 1e-12}", "{name: dopri5, rtol: 1e-8, atol: 1e-10, max_step: 0.003}",
        "{name: dop853, rtol: 1e-10, atol: 1e-12}", "{name: radau, rtol: 1e-8, atol: 1e-10}",
        "{name: rk4, step: 1e-3}"})
    for (const char* rate : {"4", "3.3", "5"}) {
      const Made made(slider_crank("0.5", integrator, rate));
      const RunSummary summary = run(made, 1);
      EXPECT_EQ(summary.status, RunStatus::singular) << integrator << ", " << rate << ": " << summary.message;
    }
}

TEST(SingularLoops, AreNotWaysThatPassAForkNearBy) {
  for (const char* integrator : {"{name: dopri5, rtol: 1e-6, atol: 1e-8}", "{name: dopri5, rtol: 1e-10, atol: 1e-12}",
                                 "{name: radau, rtol: 1e-8, atol: 1e-10}"})
    for (const char* rod : {"0.55", "0.501", "0.5001"}) {
      const Made made(slider_crank(rod, integrator, "4"));
      const RunSummary summary = run(made, 1);
      EXPECT_EQ(summary.status, RunStatus::completed) << integrator << ", " << rod << ": " << summary.message;
    }
}

/// It turns evenly, so that the third step of dop853 goes round by more than a whole turn, after which all is as it
/// was.
TEST(SingularLoops, AreSeenInStepsOfMoreThanATurn) {
  const Made made(scene_of({0, "57"}, {1, "57"}) + "integrator: {name: dop853, rtol: 1e-6, atol: 1e-8}\n");
  const RunSummary summary = run(made, 4);
  EXPECT_EQ(summary.status, RunStatus::singular) << summary.message;
  std::smatch told;
  ASSERT_TRUE(std::regex_search(summary.message, told, std::regex("between t = ([0-9.]+) and ([0-9.]+) s")))
      << summary.message;
  EXPECT_NEAR(std::stod(told[1]), (std::numbers::pi - 57 * std::numbers::pi / 180) / 2, 2e-3);
}

/// A four-bar of rods with its crank at 1 rad, turning at `rate`: ground pivots at 0 and `ground`, lengths in `size` m.
std::string four_bar_of(double crank, double coupler, double rocker, double ground, double rate, double size,
                        const std::string& integrator) {
  const double x = std::cos(1.0) * crank, y = std::sin(1.0) * crank, dx = ground - x, d = std::hypot(dx, y);
  const double along = (d * d + coupler * coupler - rocker * rocker) / (2 * d),
               aside = std::sqrt(coupler * coupler - along * along);
  const double qx = x + (along * dx + aside * y) / d, qy = y + (-along * y + aside * dx) / d;
  const auto text = [](double number) {
    std::ostringstream out;
    out << std::setprecision(17) << number;
    return out.str();
  };
  const auto rod = [&](double length) {
    const double l = length * size, inertia = l * l / 12;
    return "{type: rigid, mass: 1, center_of_mass: [" + text(l / 2) + ", 0, 0], inertia: [" + text(inertia / 40) +
           ", " + text(inertia) + ", " + text(inertia) + ", 0, 0, 0], frames: {p: {position: [" + text(l) +
           ", 0, 0]}}}\n";
  };
  return "format: withy/1\ngravity: [0, 0, 0]\ntime: {end: 2}\nintegrator: " + integrator +
         "\nbodies:\n  a: " + rod(crank) + "  b: " + rod(coupler) + "  c: " + rod(rocker) + R"(hinges:
  A: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  B: {type: revolute, axis: [0, 0, 1], parent: a.p, child: b}
  C: {type: revolute, axis: [0, 0, 1], parent: world, child: c, offset: {position: [)" +
         text(ground * size) + R"(, 0, 0]}}
constraints: {l: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: b.p, b: c.p}}
initial: {hinges: {A: {position: 1, rate: )" +
         text(rate) + "}}, guess: {hinges: {B: {position: " + text(std::atan2(qy - y, qx - x) - 1) +
         "}, C: {position: " + text(std::atan2(qy, qx - ground)) + "}}}}\n";
}

/// A parallelogram, and two kites: one folds its crank onto the ground, one lies in a line. A ten-thousandth or a
/// hundred-thousandth of a link more there is one way alone.
TEST(SingularLoops, OfFourBarsAreThereWhereWaysForkAndNotBesideItInAnySize) {
  struct Lengths {
    double crank, coupler, rocker, ground, rate;
  };
  const auto four_bars = [](double more) {
    return std::array{Lengths{1, 2, 1, 2 * (1 + more), 2}, Lengths{1, 1.5, 1.5, 1 + more, -2},
                      Lengths{1, 1 + more, 1.6, 1.6, 2}};
  };
  for (const double size : {1e-3, 1.0, 100.0})
    for (const char* name : {"dopri5", "dop853", "radau"})
      for (const double rtol : {1e-6, 1e-9}) {
        std::ostringstream integrator;
        integrator << "{name: " << name << ", rtol: " << rtol << ", atol: " << 0.01 * rtol * std::min(size, 1.0) << "}";
        for (const double more : {0.0, 1e-4, 1e-5})
          for (const Lengths& l : four_bars(more)) {
            const Made made(four_bar_of(l.crank, l.coupler, l.rocker, l.ground, l.rate, size, integrator.str()));
            const RunSummary summary = run(made, 2);
            EXPECT_EQ(summary.status, more == 0 ? RunStatus::singular : RunStatus::completed)
                << size << ", " << integrator.str() << ", " << l.coupler << ", " << more << ": " << summary.message;
          }
      }
}

}  // namespace
}  // namespace withy::test
