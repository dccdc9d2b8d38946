// Singular configurations of closed loops are seen wherever in a step they lie and however many loops are in one, and
// steps that turn far are no singularity.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <numbers>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

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

/// The same on a hub of 50 kg at a hinge of its own.
std::string on_hub(std::string text, const std::string& hinge) {
  text = replaced(text, "parent: world, child: a", "parent: h, child: a");
  text = replaced(text, "parent: world, child: c", "parent: h, child: c");
  text = replaced(text, "bodies:\n", "bodies:\n  h: {type: rigid, mass: 50, inertia: [5, 5, 5, 0, 0, 0]}\n");
  return replaced(text, "hinges:\n", "hinges:\n  H: {" + hinge + ", parent: world, child: h}\n");
}

/// What carries a loop moves it as a whole and opens no way: its column of J is the gap that is left, or rounding.
TEST(SingularLoops, OfWhatIsCarriedAreThoseOfWhatHangsOnTheWorld) {
  for (const char* hub : {"type: revolute, axis: [0, 0, 1]", "type: free", "type: spherical",
                          "type: planar, normal: [0, 0, 1], along: [1, 0, 0]"})
    for (const char* name : {"dopri5", "dop853", "radau"})
      for (const double rtol : {1e-4, 1e-6, 1e-9})
        for (const double more : {0.0, 1e-4}) {
          std::ostringstream integrator;
          integrator << "{name: " << name << ", rtol: " << rtol << ", atol: " << 0.01 * rtol << "}";
          for (const double coupler : {2.0, 1.6}) {
            // A parallelogram; a four-bar whose crank turns round and whose other links never are in line with it.
            const std::string bar = coupler == 2 ? four_bar_of(1, 2, 1, 2 * (1 + more), 2, 1, integrator.str())
                                                 : four_bar_of(0.6, coupler, 1.5, 1.7, 2, 1, integrator.str());
            const Made made(on_hub(bar, hub));
            const RunSummary summary = run(made, 2);
            EXPECT_EQ(summary.status, coupler == 2 && more == 0 ? RunStatus::singular : RunStatus::completed)
                << hub << ", " << integrator.str() << ", " << coupler << ", " << more << ": " << summary.message;
          }
        }
}

/// A four-bar with more bodies and hinges; `ground` carries it.
std::string four_bar_beside(const std::string& bodies, const std::string& hinges, const std::string& ground) {
  std::string text = four_bar(rigid_coupler, "{name: dop853, rtol: 1e-6, atol: 1e-6}");
  text = replaced(text, "parent: world, child: crank", "parent: " + ground + ", child: crank");
  text = replaced(text, "parent: world, child: rocker", "parent: " + ground + ", child: rocker");
  return replaced(text, "hinges:\n", bodies + "hinges:\n" + hinges);
}

/// How far the loops of a scene say that its hinges turn in a tenth of a second at a rate of `hinge`, all else at rest;
/// where it has one coordinate that turns as far.
double turned_by(const Made& made, const std::string& hinge, double rate) {
  constexpr double seconds = 0.1;
  const Layout& layout = made.scene.model->layout();
  const Slot& slot = *layout.hinge(hinge);
  std::vector<double> before = made.scene.initial.y;
  std::fill_n(before.begin() + static_cast<std::ptrdiff_t>(layout.positions), layout.speeds, 0.0);
  std::fill_n(before.begin() + static_cast<std::ptrdiff_t>(layout.positions + slot.speed), slot.speeds, rate);
  std::vector<double> after = before;
  if (slot.positions == 1) after[slot.position] += rate * seconds;
  return loops_of(*made.equations).turned(before, after, seconds);
}

std::vector<double> rows_at(const Made& made, const std::vector<double>& y) {
  const ClosedLoops& loops = loops_of(*made.equations);
  std::vector<double> gaps(loops.closing_equations()), rates(gaps.size()),
      J(gaps.size() * made.scene.model->layout().speeds);
  Work work = made.equations->make_work();
  loops.see(y, gaps, rates, J, work);
  return J;
}

constexpr const char* wheel_of_loops = ": {type: rigid, mass: 0.2, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}\n";

/// Steps are looked into by what the closing equations depend on: rotors may turn as fast as they like.
TEST(SingularLoops, AreNotLookedForWhereRotorsTurn) {
  const Made made(four_bar_beside(std::string("  rotor") + wheel_of_loops + "  flywheel" + wheel_of_loops,
                                  "  spin: {type: revolute, axis: [0, 0, 1], parent: world, child: rotor}\n"
                                  "  axle: {type: revolute, axis: [1, 0, 1], parent: coupler.tip, child: flywheel}\n",
                                  "world"));
  for (const char* rotor : {"spin", "axle"}) {
    EXPECT_EQ(turned_by(made, rotor, 3e5), 0) << rotor;
    std::vector<double> y = made.scene.initial.y;
    y[made.scene.model->layout().hinge(rotor)->position] += 2;
    EXPECT_EQ(rows_at(made, y), rows_at(made, made.scene.initial.y)) << rotor;
  }
  for (const char* link : {"motor", "elbow", "pivot"}) EXPECT_NEAR(turned_by(made, link, 30), 3, 1e-12) << link;
  const RunSummary summary = run(made, 0.2);
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
}

TEST(SingularLoops, AreNotLookedForWhereACraftSpinsThatCarriesAllOfALoop) {
  for (const char* hinge : {"free", "spherical", "revolute, axis: [0, 1, 1]"}) {
    const Made made(four_bar_beside("  craft: {type: rigid, mass: 9, inertia: [4, 5, 6, 0, 0, 0]}\n",
                                    std::string("  float: {type: ") + hinge + ", parent: world, child: craft}\n",
                                    "craft"));
    EXPECT_EQ(turned_by(made, "float", 3e5), 0) << hinge;
    EXPECT_NEAR(turned_by(made, "pivot", 30), 3, 1e-12) << hinge;
  }
}

/// What carries one loop may be a link of another.
TEST(SingularLoops, AreLookedForWhereACraftTurnsThatAConstraintHoldsToo) {
  std::string text =
      four_bar_beside("  craft: {type: rigid, mass: 9, inertia: [4, 5, 6, 0, 0, 0]}\n",
                      "  float: {type: revolute, axis: [0, 0, 1], parent: world, child: craft}\n", "craft");
  text = replaced(text, "constraints:\n",
                  "constraints:\n  held: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: world, b: craft}\n");
  EXPECT_NEAR(turned_by(Made(text), "float", 30), 3, 1e-12);
}

}  // namespace
}  // namespace withy::test
