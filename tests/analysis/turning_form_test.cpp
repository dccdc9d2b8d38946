/// \file
/// Turns in which much goes round often: between the instants that are looked at nothing hides.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "blade.hpp"
#include "withy/core/analysis/between_instants.hpp"
#include "withy/core/analysis/multiblade.hpp"

namespace withy::test {
namespace {

/// Two kilograms on a spring, 9 rad/s, that carry a shaft; a load acts along y with the shaft's angle s.
struct CarriedShaft {
  AnalysedScene scene;
  Held held;
  CarriedShaft(const std::string& load, double rate)
      : scene(R"(format: withy/1
time: {end: 1}
gravity: [0, 0, 0]
bodies:
  m: {type: rigid, mass: 1}
  r: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  y: {type: prismatic, axis: [0, 1, 0], parent: world, child: m}
  s: {type: revolute, axis: [1, 0, 0], parent: m, child: r}
loads:
  k: {type: hinge-spring, hinge: y, stiffness: 162}
  p: {type: expression, hinge: y, value: ")" +
                  load + "\"}\n",
              "quadratic"),
        held(hold(scene, {"s"})) {
    scene.spin("s", rate);
  }
  [[nodiscard]] TurningForm form() const {
    return turning_form(*scene.dynamics, scene.state, held, turning(*scene.scene.model, scene.state));
  }
  [[nodiscard]] double growth() const {
    const TurningForm f = form();
    return floquet(f.A, f.masses).modes[0].exponent.real();
  }
  [[nodiscard]] TurnCheck check() const { return check_turn(*scene.dynamics, scene.state, held); }
};

std::string cosine_load(const std::string& amplitude, int n, const std::string& factor = "") {
  return amplitude + "*cos(" + std::to_string(n) + "*s)" + factor;
}

/// ÿ + (81 − 30 cos 18t) y = 0 grows at 0.830016195/s (Runge–Kutta, 8000 steps a period), however many of its periods
/// make a turn of the shaft.
TEST(Harmonics, of_any_number_in_a_turn_grow_as_they_do_by_themselves) {
  for (const int n : {1, 7, 9, 10, 11, 15, 16, 22, 45, 150})
    EXPECT_NEAR(CarriedShaft(cosine_load("60", n, "*y"), 18.0 / n).growth(), 0.830016195, 1e-6) << n;
}

/// The eleven angles of the check were all the same to the eleventh harmonic.
TEST(Harmonics, of_any_number_are_seen_to_change_the_equations) {
  for (const int n : {1, 11, 22, 121, 1001}) {
    const TurnCheck parametric = CarriedShaft(cosine_load("60", n, "*y"), 2).check(),
                    pushed = CarriedShaft(cosine_load("50", n), 2).check();
    EXPECT_TRUE(parametric.periodic()) << n;
    EXPECT_GT(parametric.change, 0.01) << n;
    EXPECT_FALSE(pushed.steady) << n;
  }
  EXPECT_FALSE(CarriedShaft("-10*y", 2).check().periodic());
}

/// 2ÿ + 162y = 50 cos 2nt moves by ±25/(81 − 4n²): twice that from the start, also where no instant that was looked at
/// is at the other end. A parabola has the peak to 4e-5.
TEST(Turn, is_measured_between_its_instants_too) {
  for (const int n : {1, 2, 3, 12, 15, 30}) {
    const CarriedShaft c(cosine_load("50", n), 2);
    const TurningForm form = c.form();
    EXPECT_FALSE(form.turn.constant) << n;
    const double by = std::abs(50.0 / (81 - 4.0 * n * n));
    EXPECT_NEAR(greatest_excursions(form.turn)[c.scene.layout().hinge("y")->position], by, 4e-5 * by) << n;
  }
}

/// Where the greatest count does not show what happens, nothing is said of stability.
TEST(Harmonics, that_no_count_of_instants_shows_are_not_called_stable) {
  try {
    (void)CarriedShaft(cosine_load("60", 600, "*y"), 18.0 / 600).form();
    ADD_FAILURE() << "accepted";
  } catch (const std::domain_error& e) {
    EXPECT_NE(std::string(e.what()).find("whether small motions grow is not known"), std::string::npos) << e.what();
  }
}

/// A kink leaves what no count shows to rounding: the exponents are then known as well as the polynomial through the
/// instants is, and no better.
TEST(Harmonics, of_a_kink_widen_the_resolution) {
  const TurningForm form = CarriedShaft("60*abs(cos(3*s))*y", 2).form();
  const FloquetAnalysis f = floquet(form.A, form.masses);
  EXPECT_GT(form.A.unseen(), 1e-5);
  EXPECT_LT(form.A.unseen(), 1e-2);
  EXPECT_GE(f.resolution, form.A.unseen());
}

/// A shaft that is stiffer one way than the other, on bearings that are too: two masses, and a balanced wheel beside it
/// that has nothing to do with it.
std::string geared_shaft() {
  return R"(format: withy/1
time: {end: 1}
gravity: [0, 0, 0]
bodies:
  h1: {type: rigid, mass: 0.4}
  h2: {type: rigid, mass: 1.6}
  shaft: {type: rigid, mass: 0, inertia: [1, 0.5, 0.5, 0, 0, 0]}
  d1: {type: rigid, mass: 0.3}
  d2: {type: rigid, mass: 2.0, inertia: [0.2, 0.1, 0.1, 0, 0, 0]}
  idle: {type: rigid, mass: 0, inertia: [1, 0.5, 0.5, 0, 0, 0]}
hinges:
  hy: {type: prismatic, axis: [0, 1, 0], parent: world, child: h1}
  hz: {type: prismatic, axis: [0, 0, 1], parent: h1, child: h2}
  spin: {type: revolute, axis: [1, 0, 0], parent: h2, child: shaft}
  dy: {type: prismatic, axis: [0, 1, 0], parent: shaft, child: d1}
  dz: {type: prismatic, axis: [0, 0, 1], parent: d1, child: d2}
  spin2: {type: revolute, axis: [1, 0, 0], parent: h2, child: idle}
loads:
  khy: {type: hinge-spring, hinge: hy, stiffness: 300, damping: 1}
  khz: {type: hinge-spring, hinge: hz, stiffness: 500, damping: 0.5}
  kdy: {type: hinge-spring, hinge: dy, stiffness: 100, damping: 0.4}
  kdz: {type: hinge-spring, hinge: dz, stiffness: 160, damping: 0.4}
)";
}

/// The turn is ten times as long with a wheel at 9 : 10. In coordinates that do not turn, integrated by Runge–Kutta,
/// the shaft has −0.0285486191/s at 7.5 rad/s and 0.0241700553/s at 11 rad/s, whatever the wheel does.
TEST(Shaft, has_the_exponents_that_it_has_beside_a_wheel_that_turns_otherwise) {
  struct Rates {
    double shaft, wheel, growth;
  };
  for (const Rates& r :
       {Rates{7.5, 7.5, -0.0285486191}, Rates{7.5, 6.75, -0.0285486191}, Rates{11, 9.9, 0.0241700553}}) {
    AnalysedScene c(geared_shaft(), "quadratic");
    const Held held = hold(c, {"spin", "spin2"});
    c.spin("spin", r.shaft), c.spin("spin2", r.wheel);
    const TurningForm form = turning_form(*c.dynamics, c.state, held, turning(*c.scene.model, c.state));
    const FloquetAnalysis f = floquet(form.A, form.masses);
    EXPECT_NEAR(f.modes[0].exponent.real(), r.growth, 1e-7) << r.shaft << ' ' << r.wheel;
    EXPECT_EQ(f.stable(), r.growth < 0) << r.shaft << ' ' << r.wheel;
  }
}

/// Two vibrations of one frequency that only rounding couples are one of each coordinate, and no mixtures that are both
/// named for the same one.
TEST(ConstantModes, of_one_frequency_are_each_of_one_part) {
  for (const double rounding : {1e-15, 2e-15, 4e-15, 1e-14}) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(4, 4);
    A.topRightCorner(2, 2).setIdentity();
    A.bottomLeftCorner(2, 2) << -9, rounding, rounding, -9;
    const std::vector<CharacteristicMode> modes = constant_modes(A, Eigen::Vector2d::Ones());
    ASSERT_EQ(modes.size(), 2U);
    EXPECT_NE(modes[0].dominant, modes[1].dominant);
    for (const CharacteristicMode& mode : modes) {
      EXPECT_NEAR(mode.exponent.imag(), 3, 1e-14);
      EXPECT_EQ(std::abs(mode.shape[1 - mode.dominant]), 0);
    }
  }
}

/// Of stiffnesses that are far below one, as micrometres have them.
TEST(Blades, AreAlikeByTheirStiffnessWhateverItsSize) {
  std::string bodies =
      "format: withy/1\ntime: {end: 1}\nbodies:\n  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\n";
  std::string hinges = "hinges:\n  shaft: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n";
  for (const std::string name : {"a", "b", "c", "d"}) {
    bodies += "  " + name + ": {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: " +
              (name == "d" ? "2e-12" : "1e-12") + ", modes: 1}}\n";
    hinges += "  of_" + name + ": {type: weld, parent: hub, child: " + name + "}\n";
  }
  const AnalysedScene scene(bodies + hinges, "quadratic");
  const std::vector<Blades> found = equal_branches(*scene.scene.model, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].names, (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_THROW(equal_branches(*scene.scene.model, {"a", "b", "d"}), std::invalid_argument);
}

}  // namespace
}  // namespace withy::test
