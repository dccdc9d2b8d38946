/// \file
/// The fastest pole of all that acts, and what makes it.
#include "withy/core/analysis/fastest_pole.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "blade.hpp"

namespace withy::test {
namespace {

/// Two links whose joints have no inertia of their own, and a servo that is stiff.
const char* const servo_arm = R"(format: withy/1
gravity: [0, 0, -9.81]
time: {end: 1}
bodies:
  upper:
    {type: beam, length: 1, mass_per_length: 2, bending_y: {stiffness: 800, modes: 2, family: craig-bampton},
     bending_z: {stiffness: 800, modes: 2, family: craig-bampton}, damping_ratio: 0.01}
  motor: {type: rigid, mass: 4, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  shoulder: {type: revolute, axis: [0, 1, 0], parent: world, child: upper}
  wrist: {type: weld, parent: upper.tip, child: motor}
loads:
  servo: {type: hinge-spring, hinge: shoulder, stiffness: 4000, damping: 300}
)";

double greatest_of_jacobian(const AnalysedScene& c) {
  const auto n = static_cast<Eigen::Index>(c.layout().positions + c.layout().speeds);
  std::vector<double> rates(c.equations->size());
  Work work = c.equations->make_work();
  EXPECT_TRUE(c.equations->derivatives(c.state.time, c.state.y, rates, work).ok());
  Eigen::MatrixXd J(n, n);
  EXPECT_TRUE(c.equations->linearization()
                  ->jacobian(c.state.time, c.state.y, rates, {J.data(), static_cast<std::size_t>(J.size())})
                  .ok());
  return J.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(FastestPole, is_the_greatest_eigenvalue_of_the_jacobian) {
  for (const std::string& formulation : all_formulations) {
    AnalysedScene c(servo_arm, formulation);
    const FastestPole pole = fastest_pole(*c.dynamics, c.state, driven_speeds(*c.scene.model, c.state));
    EXPECT_NEAR(std::abs(pole.value) / greatest_of_jacobian(c), 1, 1e-6) << formulation;
  }
}

/// A hinge that only the bending of a light beam follows: the servo's damping works against little inertia.
TEST(FastestPole, of_a_servo_without_inertia_behind_it_says_so) {
  AnalysedScene c(servo_arm, "quadratic");
  const FastestPole pole = fastest_pole(*c.dynamics, c.state, driven_speeds(*c.scene.model, c.state));
  EXPECT_LT(pole.value.real(), -1e3);
  EXPECT_EQ(c.layout().speed_names[pole.speed], "shoulder.0");
  EXPECT_EQ(pole.cause, "damping of load 'servo'");
  EXPECT_LT(pole.inertia, 0.05 * pole.alone);
  EXPECT_NEAR(-300 / pole.inertia / pole.value.real(), 1, 0.1) << "c/J of what moves";
  EXPECT_NE(describe(pole, c.layout()).find("little inertia"), std::string::npos);
}

/// The same law as a spring's, in loads that act through states of their own: it bears the load's name too.
TEST(FastestPole, of_a_controller_is_that_of_the_spring_that_does_the_same) {
  const std::string spring = "{type: hinge-spring, hinge: shoulder, stiffness: 4000, damping: 300}";
  const auto pole_with = [&](const std::string& load) {
    std::string text = servo_arm;
    text.replace(text.find(spring), spring.size(), load);
    AnalysedScene c(text, "quadratic");
    return fastest_pole(*c.dynamics, c.state, driven_speeds(*c.scene.model, c.state));
  };
  const FastestPole sprung = pole_with(spring);
  EXPECT_TRUE(sprung.of_load);
  for (const std::string law :
       {"proportional: 4000, derivative: 300", "proportional: 4000, integral: 1, derivative: 300"}) {
    const FastestPole pole = pole_with("{type: pid, hinge: shoulder, reference: 0, " + law + "}");
    EXPECT_NEAR(pole.value.real() / sprung.value.real(), 1, 1e-3) << law;
    EXPECT_EQ(pole.cause, "damping of load 'servo'") << law;
    EXPECT_TRUE(pole.of_load) << law;
  }
}

/// One coordinate: −c/J and ±√(k/J) in closed form.
TEST(FastestPole, of_a_disk_is_in_closed_form) {
  const auto disk = [](const std::string& spring) {
    return AnalysedScene(
        "format: withy/1\ntime: {end: 1}\n"
        "bodies: {disk: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}\n"
        "hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: disk}}\n"
        "loads: {spring: {type: hinge-spring, hinge: axle, " +
            spring + "}}\n",
        "quadratic");
  };
  AnalysedScene stiff = disk("stiffness: 800, damping: 0");
  const FastestPole a = fastest_pole(*stiff.dynamics, stiff.state, Held(1, false));
  EXPECT_NEAR(a.value.imag(), 20, 1e-9);
  EXPECT_EQ(a.cause, "stiffness of load 'spring'");
  EXPECT_NEAR(a.inertia, 2, 1e-9);
  EXPECT_EQ(describe(a, stiff.layout()).find("inertia"), std::string::npos);
  AnalysedScene damped = disk("stiffness: 0, damping: 40");
  const FastestPole b = fastest_pole(*damped.dynamics, damped.state, Held(1, false));
  EXPECT_NEAR(b.value.real(), -20, 1e-9);
  EXPECT_EQ(b.value.imag(), 0);
  EXPECT_EQ(b.cause, "damping of load 'spring'");
  EXPECT_EQ(fastest_pole(*damped.dynamics, damped.state, Held(1, true)).value, 0.0) << "nothing is free";
}

/// States of loads have poles too: that of a filter is its cutoff, where that is above what moves.
TEST(FastestPole, of_a_filter_is_its_cutoff) {
  const auto filtered = [](const std::string& cutoff) {
    return AnalysedScene(
        "format: withy/1\ntime: {end: 1}\n"
        "bodies: {disk: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}\n"
        "hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: disk}}\n"
        "loads: {spring: {type: hinge-spring, hinge: axle, stiffness: 800, damping: 0},\n"
        "  seen: {type: filter, of: axle, order: 1, cutoff: " +
            cutoff + "}}\n",
        "quadratic");
  };
  AnalysedScene fast = filtered("100 Hz");
  const FastestPole a = fastest_pole(*fast.dynamics, fast.state, Held(1, false));
  EXPECT_NEAR(a.value.real(), -200 * M_PI, 1e-9 * 200 * M_PI);
  EXPECT_TRUE(a.of_load_state()) << a.cause;
  EXPECT_EQ(a.cause.find("the state of load 'seen."), 0U) << a.cause;
  EXPECT_EQ(describe(a, fast.layout()), "-628.3/s: " + a.cause);
  AnalysedScene slow = filtered("1 Hz");
  const FastestPole b = fastest_pole(*slow.dynamics, slow.state, Held(1, false));
  EXPECT_NEAR(b.value.imag(), 20, 1e-9);
  EXPECT_EQ(b.cause, "stiffness of load 'spring'");
}

/// Without loads it is the fastest vibration that the modes have.
TEST(FastestPole, of_a_free_structure_is_its_highest_mode) {
  AnalysedScene c(blade(2, 3), "quadratic");
  const Held held = hold(c, {"axle"});
  const FastestPole pole = fastest_pole(*c.dynamics, c.state, held);
  EXPECT_NEAR(std::abs(pole.value), 61.697, 0.01) << "third bending mode of a cantilever of unit properties";
  EXPECT_EQ(pole.cause, "stiffness of 'blade'");
  EXPECT_EQ(c.layout().speed_names[pole.speed], "blade.bending_z[3]");
}

/// A disk of J = 2 on a spring of 800 N m/rad whose law pushes by 4 N m s along with the rate: λ = 1 ± i √399. The
/// spring is the greatest force by far, and the growth is by the damping.
TEST(GrowingPole, of_a_negative_damper_is_its_damping_and_not_the_stiffness_beside_it) {
  AnalysedScene c(
      "format: withy/1\ntime: {end: 1}\n"
      "bodies: {disk: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}\n"
      "hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: disk}}\n"
      "loads: {law: {type: expression, hinge: axle, value: \"-800*axle + 4*axle.rate\"}}\n",
      "quadratic");
  const FastestPole pole = growing_pole(*c.dynamics, c.state, Held(1, false));
  EXPECT_NEAR(pole.value.real(), 1, 1e-6);
  EXPECT_NEAR(pole.value.imag(), std::sqrt(399), 1e-6);
  EXPECT_EQ(pole.cause, "damping of load 'law'");
  EXPECT_TRUE(pole.of_load);
  EXPECT_EQ(fastest_pole(*c.dynamics, c.state, Held(1, false)).cause, "stiffness of load 'law'")
      << "what makes it fast is another thing";
}

/// A shaft that turns at Ω = 10 rad/s, 2.8 times its critical speed, with damping of its own, d = 2 ζ ω. In the axes of
/// the shaft z = y + i x has z̈ + (d + 2iΩ) ż + (ω² − Ω²) z = 0. Without damping nothing grows; centrifugal and Coriolis
/// forces are thirty times as large, and the damping takes energy from the motion in these axes.
TEST(GrowingPole, of_a_shaft_above_its_critical_speed_is_the_damping_in_it) {
  const auto shaft = [](const std::string& damping) {
    AnalysedScene c(
        "format: withy/1\ntime: {end: 1}\ngravity: [0, 0, 0]\nbodies:\n"
        "  shaft: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 1, modes: 1, family: "
        "clamped-free},\n"
        "    bending_z: {stiffness: 1, modes: 1, family: clamped-free}, damping_ratio: " +
            damping + "}\nhinges:\n  axle: {type: revolute, axis: [1, 0, 0], parent: world, child: shaft}\n",
        "quadratic");
    c.spin("axle", 10);
    return c;
  };
  AnalysedScene damped = shaft("0.02");
  const FastestPole pole = growing_pole(*damped.dynamics, damped.state, hold(damped, {"axle"}));
  // −d/2 − iΩ + √((d/2 + iΩ)² − ω² + Ω²) with ω = 1.8751040687².
  EXPECT_NEAR(pole.value.real(), 0.1293976, 1e-5);
  EXPECT_NEAR(pole.value.imag(), 6.479019, 1e-4);
  EXPECT_EQ(pole.cause, "damping of 'shaft'");
  AnalysedScene free = shaft("0");
  EXPECT_LT(growing_pole(*free.dynamics, free.state, hold(free, {"axle"})).value.real(), 1e-6);
}

/// A kilogram at the end of a rod of a metre that stands on its hinge: √(g/l), and no force is to blame but its weight.
TEST(GrowingPole, of_a_pendulum_that_stands_on_its_head_is_weight) {
  AnalysedScene c(
      "format: withy/1\ntime: {end: 1}\ngravity: [-9.81, 0, 0]\n"
      "bodies: {bob: {type: rigid, mass: 1, center_of_mass: [1, 0, 0]}}\n"
      "hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: bob}}\n",
      "quadratic");
  const FastestPole pole = growing_pole(*c.dynamics, c.state, Held(1, false));
  EXPECT_NEAR(pole.value.real(), std::sqrt(9.81), 1e-6);
  EXPECT_EQ(pole.cause, "inertia and weight");
  EXPECT_EQ(c.layout().speed_names[pole.speed], "pivot.0");
}

}  // namespace
}  // namespace withy::test
