/// \file
/// Loops that are closed where a run begins: at the pose that their hinge stands for, in scenes of any size.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <utility>

#include "four_bar.hpp"

namespace withy::test {
namespace {

/// What a user is told of a scene that is refused; empty where it is good.
std::string refusal(const std::string& scene) {
  try {
    const Made unused(scene);
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

/// A box on a tree's hinge, held by a constraint whose F is turned.
std::string held_box(const std::string& carried_by, const std::string& held_by, const std::string& axis, double angle) {
  return R"(format: withy/1
time: {end: 1}
bodies:
  box: {type: rigid, mass: 2, inertia: [1, 2, 2.5, 0, 0, 0], center_of_mass: [0.1, 0, 0], frames: {f: {position: [0.2, 0, 0]}}}
hinges:
  carrier: {type: )" +
         carried_by + R"(, parent: world, child: box}
constraints:
  hold: {type: hinge, hinge: )" +
         held_by + R"(, a: world, b: box.f, offset: {position: [0.2, 0, 0], orientation: {axis: )" + axis +
         ", angle: \"" + std::to_string(angle) + " deg\"}}}\n";
}

// The equations of three directions have more solutions than the hinge's pose: half turns, and turns by 120° about the
// diagonals, from or to which Newton's method may go.
TEST(LoopAssembly, AHingeThatHoldsAllDirectionsIsClosedAtItsPoseWhereverItBegins) {
  struct Axis {
    const char* text;
    Vector3 axis;
  };
  for (const Axis& a :
       {Axis{"[1, 1, 1]", {1, 1, 1}}, Axis{"[1, -1, -1]", {1, -1, -1}}, Axis{"[1, 1, 0.9]", {1, 1, 0.9}},
        Axis{"[1, 0.2, 0.3]", {1, 0.2, 0.3}}, Axis{"[0, 0, 1]", {0, 0, 1}}}) {
    for (const double angle : {-120.0, -100.0, 40.0, 90.0, 119.0, 120.0, 170.0, 180.0}) {
      for (const char* hinge : {"weld", "prismatic, axis: [0.2, 1, 0.3]"}) {
        SCOPED_TRACE(std::string(hinge) + " about " + a.text + " by " + std::to_string(angle));
        const Made made(held_box("free", hinge, a.text, angle));
        const Slot& slot = *made.scene.model->layout().hinge("carrier");
        const double* x = &made.scene.initial.y[slot.position];
        const Eigen::Quaterniond is(x[0], x[1], x[2], x[3]);
        const Eigen::Quaterniond wanted(Eigen::AngleAxisd(angle * M_PI / 180, a.axis.normalized()));
        EXPECT_LT(is.angularDistance(wanted), 1e-7);
        Work work = made.equations->make_work();
        EXPECT_TRUE(loops_of(*made.equations).right_way_round(made.scene.initial.y, 0, work));
        if (std::string(hinge) == "weld") {
          EXPECT_LT((Vector3(x[4], x[5], x[6]) + is * Vector3(0.2, 0, 0) - Vector3(0.2, 0, 0)).norm(), 1e-9);
        }
      }
    }
  }
}

// The equations of an axis have its opposite for a solution too, which Newton's method goes to from beyond a right
// angle.
TEST(LoopAssembly, AHingeThatHoldsAnAxisIsClosedAlongItWhereverItBegins) {
  const Vector3 held = Vector3(0.2, 1, 0.3).normalized();
  const std::pair<const char*, Vector3> turned_about[] = {{"[1, 1, 1]", {1, 1, 1}},
                                                          {"[1, -1, -1]", {1, -1, -1}},
                                                          {"[1, 0.2, 0.3]", {1, 0.2, 0.3}},
                                                          {"[0, 0, 1]", {0, 0, 1}}};
  for (const auto& [text, axis] : turned_about) {
    for (const double angle : {-170.0, -120.0, -100.0, 40.0, 90.0, 119.0, 150.0, 180.0}) {
      for (const char* hinge : {"revolute, axis: [0.2, 1, 0.3]", "cylindrical, axis: [0.2, 1, 0.3]"}) {
        SCOPED_TRACE(std::string(hinge) + " about " + text + " by " + std::to_string(angle));
        const Made made(held_box("free", hinge, text, angle));
        const Slot& slot = *made.scene.model->layout().hinge("carrier");
        const double* x = &made.scene.initial.y[slot.position];
        const Vector3 is = Eigen::Quaterniond(x[0], x[1], x[2], x[3]) * held;
        const Vector3 wanted = Eigen::AngleAxisd(angle * M_PI / 180, axis.normalized()) * held;
        EXPECT_LT((is - wanted).norm(), 1e-7);
      }
    }
  }
}

/// Six links in space, each with a hinge at the tip of the one before, whose end a hinge in the world holds. They are
/// closed at angles that the guess is off by about `off` [rad].
std::string chain_in_space(unsigned seed, double off) {
  std::mt19937 random(seed);
  const auto one = [&] { return std::generate_canonical<double, 53>(random) - 0.5; };
  const auto vector = [&] { return Vector3(one(), one(), one()); };
  const auto list = [](const auto& v) {
    std::ostringstream text;
    text.precision(17);
    for (Eigen::Index i = 0; i < v.size(); ++i) text << (i > 0 ? ", " : "[") << v[i];
    return text.str() + "]";
  };
  std::string bodies, hinges, guess;
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Vector3 p = Vector3::Zero();
  for (int i = 0; i < 6; ++i) {
    const std::string k = std::to_string(i);
    const Vector3 axis = vector(), tip = 2 * vector();
    const double angle = 2 * one();
    R = R * Eigen::AngleAxisd(angle, axis.normalized());
    p += R * tip;
    bodies += "  b" + k + ": {type: rigid, mass: 1, center_of_mass: " + list(Vector3(tip / 2)) +
              ", inertia: [0.1, 0.12, 0.15, 0, 0, 0], frames: {tip: {position: " + list(tip) + "}}}\n";
    hinges += "  h" + k + ": {type: revolute, axis: " + list(axis) +
              ", parent: " + (i > 0 ? "b" + std::to_string(i - 1) + ".tip" : "world") + ", child: b" + k + "}\n";
    guess += (i > 0 ? ", h" : "h") + k + ": {position: [" + std::to_string(angle + 4 * off * one()) + "]}";
  }
  const Eigen::Vector4d q(R.w(), R.x(), R.y(), R.z());
  return "format: withy/1\ntime: {end: 1}\nintegrator: dopri5\nbodies:\n" + bodies + "hinges:\n" + hinges +
         "constraints:\n  end: {type: hinge, hinge: revolute, axis: " + list(vector()) +
         ", a: world, b: b5.tip, offset: {position: " + list(p) + ", orientation: " + list(q) +
         "}}\ninitial: {guess: {hinges: {" + guess + "}}}\n";
}

TEST(LoopAssembly, ChainsInSpaceCloseFromMostGuesses) {
  const auto closed = [](double off) {
    int all = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) all += refusal(chain_in_space(seed, off)).empty() ? 1 : 0;
    return all;
  };
  EXPECT_EQ(closed(0.2), 40);
  EXPECT_GE(closed(0.8), 36);
}

TEST(LoopAssembly, AHingeThatCannotTurnToItsPoseIsRefused) {
  for (const double angle : {120.0, -120.0, 180.0}) {
    const std::string said = refusal(held_box("prismatic, axis: [1, 0, 0]", "weld", "[1, 1, 1]", angle));
    EXPECT_THAT(said, testing::HasSubstr("/constraints/hold: the loop c")) << angle;
  }
  EXPECT_THAT(refusal(held_box("prismatic, axis: [1, 0, 0]", "weld", "[1, 1, 1]", -120)),
              testing::HasSubstr("turned over by half or a third of a turn"));
}

/// Lengths and what goes with their square, as texts of any size.
struct Scaled {
  double size;
  [[nodiscard]] std::string number(double value) const {
    std::ostringstream text;
    text.precision(17);
    text << value;
    return text.str();
  }
  [[nodiscard]] std::string along_x(double x) const { return "[" + number(size * x) + ", 0, 0]"; }
  [[nodiscard]] std::string inertia(double each) const {
    const std::string one = number(size * size * each);
    return "[" + one + ", " + one + ", " + one + ", 0, 0, 0]";
  }
  [[nodiscard]] std::string body(const char* name, double mass, double length) const {
    return std::string("  ") + name + ": {type: rigid, mass: " + number(mass) +
           ", center_of_mass: " + along_x(length / 2) + ", inertia: " + inertia(0.1) +
           ", frames: {tip: {position: " + along_x(length) + "}}}\n";
  }
};

/// A crank of 0.3, a rod of 1 and a slider, times `size`; the crank's angle is given, elbow and slide are guessed.
std::string crank_slider(double size, double elbow, double slide) {
  const Scaled s{size};
  return "format: withy/1\ntime: {end: 1}\nintegrator: dopri5\nbodies:\n" + s.body("crank", 2, 0.3) +
         s.body("rod", 3, 1) + "  slider: {type: rigid, mass: 2}\n" + R"(hinges:
  motor: {type: revolute, axis: [0, 0, 1], parent: world, child: crank}
  elbow: {type: revolute, axis: [0, 0, 1], parent: crank.tip, child: rod}
  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: slider}
constraints:
  loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: rod.tip, b: slider}
initial: {hinges: {motor: {position: [0.7]}}, guess: {hinges: {elbow: {position: [)" +
         s.number(elbow) + "]}, slide: {position: [" + s.number(size * slide) + "]}}}}\n";
}

TEST(LoopAssembly, MechanismsOfAnySizeCloseFromTheSameGuess) {
  // The rod's end is on the x axis: 0.3 sin 0.7 + sin (0.7 + elbow) = 0.
  const double elbow = -std::asin(0.3 * std::sin(0.7)) - 0.7;
  const double slide = 0.3 * std::cos(0.7) + std::cos(0.7 + elbow);
  for (const double size : {1e-6, 1e-3, 1.0, 50.0, 1e3, 1e6}) {
    for (const auto& guess : {std::pair(-0.9, 1.2), std::pair(-0.9, 0.9)}) {
      SCOPED_TRACE(size);
      const Made made(crank_slider(size, guess.first, guess.second));
      const Layout& layout = made.scene.model->layout();
      EXPECT_EQ(made.scene.initial.y[layout.hinge("motor")->position], 0.7);
      EXPECT_NEAR(made.scene.initial.y[layout.hinge("elbow")->position], elbow, 1e-9);
      EXPECT_NEAR(made.scene.initial.y[layout.hinge("slide")->position], slide * size, 1e-9 * size);
    }
  }
}

TEST(LoopAssembly, WhatIsNotFoundIsNotSaidToBeImpossible) {
  EXPECT_THAT(refusal(held_box("prismatic, axis: [1, 0, 0]", "weld", "[1, 1, 1]", 60)),
              testing::HasSubstr("no way to close it was found"));
}

/// The linkage of four_bar, times `size`; `elbow` is given or guessed.
std::string given_linkage(double size, double motor, double elbow, bool elbow_given, double pivot) {
  const Scaled s{size};
  const std::string of_elbow = "elbow: {position: [" + s.number(elbow) + "]}";
  return "format: withy/1\ntime: {end: 1}\nintegrator: dopri5\nbodies:\n" + s.body("crank", 1.2, 0.3) +
         s.body("coupler", 0.54, 1) + s.body("rocker", 2, 0.8) + R"(hinges:
  motor: {type: revolute, axis: [0, 0, 1], parent: world, child: crank}
  elbow: {type: revolute, axis: [0, 0, 1], parent: crank.tip, child: coupler}
  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: rocker, offset: {position: )" +
         s.along_x(0.9) + R"(}}
constraints:
  loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: coupler.tip, b: rocker.tip}
initial: {hinges: {motor: {position: [)" +
         s.number(motor) + "]}, pivot: {position: [" + s.number(pivot) + "]}" +
         (elbow_given ? ", " + of_elbow + "}}\n" : "}, guess: {hinges: {" + of_elbow + "}}}\n");
}

// Given values that are rounded are moved, others are not, whatever the size: neither by degrees in small mechanisms.
TEST(LoopAssembly, GivenCoordinatesMoveForGapsOfAThousandthOfTheSizeAtMost) {
  const double motor = M_PI / 2;
  const Linkage::Place place = Linkage::place(motor);
  const double elbow = place.coupler - motor;
  for (const double size : {1e-6, 1e-3, 1e-2, 1.0, 1e4}) {
    SCOPED_TRACE(size);
    EXPECT_THAT(refusal(given_linkage(size, motor, -1.05, false, 1.7)), testing::HasSubstr("cannot be closed"));
    EXPECT_THAT(refusal(given_linkage(size, motor, elbow, true, place.rocker + 5e-3)),
                testing::HasSubstr("cannot be closed"));
    if (size > 1) continue;  // 1 mm is the most in any case
    const Made made(given_linkage(size, motor, elbow, true, place.rocker + 3e-4));
    const Layout& layout = made.scene.model->layout();
    EXPECT_NEAR(made.scene.initial.y[layout.hinge("motor")->position], motor, 2e-3);
    EXPECT_NEAR(made.scene.initial.y[layout.hinge("pivot")->position], place.rocker, 2e-3);
    Work work = made.equations->make_work();
    std::vector<double> y = made.scene.initial.y;
    EXPECT_LT(loops_of(*made.equations).close(y, work).gap, 1e-12 * size);
  }
}

}  // namespace
}  // namespace withy::test
