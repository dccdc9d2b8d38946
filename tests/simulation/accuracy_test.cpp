/// \file
/// What accuracy the mass matrix leaves to be had: against closed forms, whatever the units.
#include "withy/core/simulation/accuracy.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "made_scene.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Two coordinates coupled to c of the geometric mean of their inertias: eigenvalues 1 ± c, whatever their units.
TEST(Accuracy, the_condition_does_not_depend_on_units) {
  const double c = 0.999;
  for (const double unit : {1.0, 1e-6, 39.37}) {
    const DenseSystem system{2, {4, 2 * c * unit, 2 * c * unit, unit * unit}, {0, 0}, {0, 0}};
    const AttainableAccuracy a = attainable_accuracy(system);
    EXPECT_NEAR(a.condition, (1 + c) / (1 - c), 1e-9 * a.condition);
    EXPECT_NEAR(a.share, 1 - c, 1e-12);
    EXPECT_NEAR(a.accuracy / a.condition, std::ldexp(1.0, -52), 1e-30);
    EXPECT_NEAR(std::abs(a.weakest[0]), std::sqrt(0.5), 1e-9);
  }
  EXPECT_EQ(attainable_accuracy({2, {4, 0, 0, 1}, {0, 0}, {0, 0}, {{0, 0}}}).condition, 1) << "prescribed";
  EXPECT_TRUE(std::isinf(attainable_accuracy({2, {4, 0, 0, 0}, {0, 0}, {0, 0}}).condition));
}

const std::string arm =
    "format: withy/1\ntime: {end: 1}\nbodies:\n"
    "  link: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 1, modes: 3}}\n"
    "  load: {type: rigid, mass: 1e6}\nhinges:\n"
    "  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: link}\n"
    "  tip: {type: weld, parent: link.tip, child: load}\n";

// Hinge and modes all move the heavy tip: of four directions three are nearly massless.
TEST(Accuracy, nearly_massless_directions_are_found_named_and_valued) {
  const test::Made made(arm);
  const DenseSystem system = made.equations->system(0, made.scene.initial.y);
  const auto massless = massless_directions(*made.scene.model, system, 1e-3);
  ASSERT_EQ(massless.size(), 3);
  for (const MasslessDirection& d : massless) {
    EXPECT_GT(d.share, 0);
    EXPECT_LT(d.share, 1e-6) << "of the order of the beam's mass over its load's";
    EXPECT_GT(d.frequency, 10);
    EXPECT_THAT(d.owners, HasSubstr("'link'"));
  }
  const auto removal = best_removal(*made.scene.model, system);
  ASSERT_TRUE(removal);
  EXPECT_EQ(removal->mode, "link.bending_y[3]");
  EXPECT_LT(removal->condition, attainable_accuracy(system).condition);
}

TEST(Accuracy, a_tolerance_below_what_can_be_had_is_refused_with_the_reason) {
  const test::Made made(arm);
  const RoundingError a = rounding_error(*made.scene.model, *made.equations, made.scene.initial);
  const auto why = [&](double tolerance) {
    return unattainable(*made.scene.model, *made.equations, made.scene.initial, tolerance);
  };
  EXPECT_EQ(why(1.01 * a.relative), "");
  EXPECT_THAT(why(0.99 * a.relative), AllOf(HasSubstr("modes of 'link'"), HasSubstr("hinge 'axle'"),
                                            HasSubstr("without link.bending_y[3] the condition is")));
}

// A mast that leans on a spring, bent by its weight and come to rest: accelerations are what rounding leaves of forces
// that balance. It can be run to any tolerance, and stays.
TEST(Accuracy, of_a_state_whose_forces_balance_is_that_of_its_mass_matrix) {
  const std::string leaning =
      "format: withy/1\ngravity: [3, -9.81, 1]\nintegrator: {name: dopri5, rtol: 1e-9}\ntime: {end: 60}\nbodies:\n"
      "  mast:\n    {type: beam, length: 1.3, mass_per_length: 1.7, damping_ratio: 0.3,\n"
      "     bending_y: {stiffness: 47, modes: 2}, bending_z: {stiffness: 31, modes: 2}}\n"
      "hinges: {pin: {type: universal, first_axis: [0, 1, 0], second_axis: [0, 0, 1], parent: world, child: mast}}\n"
      "loads:\n  a: {type: hinge-spring, hinge: pin, stiffness: 90, damping: 9}\n"
      "  b: {type: hinge-spring, hinge: pin, component: 1, stiffness: 110, damping: 9}\n"
      "  stay: {type: spring-damper, frame: mast.tip, anchor: [1, 2, 3], stiffness: 3, damping: 0.2}\n";
  const test::Made made(leaning);
  RunOptions options;
  options.end = 60;
  options.output = 60;
  const State end = simulate(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, options,
                             [](const State&) {})
                        .final;
  // As near to balance as rounding comes: what is left is 1e-12 and below, of forces of 20 N.
  EXPECT_LT(rounding_error(*made.scene.model, *made.equations, end).relative, 1e-13);
  EXPECT_EQ(unattainable(*made.scene.model, *made.equations, end, 1e-12), "");
}

/// κ·2⁻⁵² of 200 rods is 4e-6; their accelerations are right to 6e-15 (against 50 digits).
TEST(Accuracy, of_long_chains_is_that_of_their_accelerations_whatever_their_size) {
  for (const int rods : {40, 200, 300}) {
    std::string text = "format: withy/1\ngravity: [0, -9.81, 0]\ntime: {end: 1}\nbodies:\n", hinges = "hinges:\n";
    for (int i = 0; i < rods; ++i) {
      const std::string n = std::to_string(i);
      text += "  b" + n +
              ": {type: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [0.01, 0.08, 0.08, 0, 0, 0], "
              "frames: {out: {position: [1, 0, 0]}}}\n";
      hinges += "  h" + n + ": {type: revolute, axis: [0, 0, 1], parent: " +
                (i == 0 ? "world" : "b" + std::to_string(i - 1) + ".out") + ", child: b" + n + "}\n";
    }
    const test::Made made(text + hinges);
    const RoundingError error = rounding_error(*made.scene.model, *made.equations, made.scene.initial);
    EXPECT_GT(error.relative, 0) << rods;
    EXPECT_LT(error.relative, 1e-11) << rods;
    EXPECT_EQ(unattainable(*made.scene.model, *made.equations, made.scene.initial, 1e-10), "") << rods;
  }
}

// A point on a tilted axis: rounding leaves an inertia that is not zero.
TEST(Accuracy, a_hinge_that_turns_nothing_is_refused_and_its_body_named) {
  const test::Made made(
      "format: withy/1\ntime: {end: 1}\nbodies:\n  bob: {type: rigid, mass: 2, center_of_mass: [0.37, 0.74, 1.11]}\n"
      "hinges: {pin: {type: revolute, axis: [1, 2, 3], parent: world, child: bob}}\n");
  EXPECT_THAT(unattainable(*made.scene.model, *made.equations, made.scene.initial, 1.0),
              AllOf(HasSubstr("singular"), HasSubstr("pin.0"), HasSubstr("'bob'")));
}

/// A wrist without masses but at its end: in one line its first and last axis turn against each other and move nothing.
std::string wrist(const std::string& bend) {
  return "format: withy/1\ntime: {end: 1}\nbodies: {a: {type: rigid, mass: 0}, b: {type: rigid, mass: 0}, "
         "c: {type: rigid, mass: 1, center_of_mass: [0.1, 0, 0.1], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}\nhinges:\n"
         "  roll: {type: revolute, axis: [0, 0, 1], parent: world, child: a}\n"
         "  pitch: {type: revolute, axis: [0, 1, 0], parent: a, child: b}\n"
         "  turn: {type: revolute, axis: [0, 0, 1], parent: b, child: c}\n"
         "initial: {hinges: {pitch: {position: [" +
         bend + "]}}}\n";
}

TEST(Accuracy, hinges_that_move_no_mass_together_are_named) {
  const test::Made straight(wrist("0"));
  const auto rate = unsolvable_rate(*straight.scene.model, *straight.equations, straight.scene.initial);
  ASSERT_TRUE(rate);
  EXPECT_TRUE(rate->together);
  EXPECT_THAT(rate->why, AllOf(HasSubstr("singular here"), HasSubstr("50 % hinge 'roll'"),
                               HasSubstr("50 % hinge 'turn'"), HasSubstr("begin elsewhere")));
  EXPECT_EQ(unattainable(*straight.scene.model, *straight.equations, straight.scene.initial, 1e-6), rate->why);
  const test::Made bent(wrist("0.5"));
  EXPECT_FALSE(unsolvable_rate(*bent.scene.model, *bent.equations, bent.scene.initial));
  EXPECT_EQ(unattainable(*bent.scene.model, *bent.equations, bent.scene.initial, 1e-6), "");
}

}  // namespace
}  // namespace withy
