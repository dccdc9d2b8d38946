/// \file
/// Loads over buckling loads, against closed forms of rotating and buckling beams.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "withy/core/simulation/elastic_modes.hpp"
#include "withy/tests/simulation/cantilever.hpp"

namespace withy::test {
namespace {

// A column that stands on its root buckles under its own weight at rho g L^3 / EI = 7.8529 in two modes.
TEST(MotionStiffness, own_weight_buckles_a_column_where_two_modes_say) {
  const Made m(cantilever("[-9.81, 0, 0]", 2, 1e-12, "bending_y: {stiffness: 10, modes: 2}"));
  const LoadRatio load = load_of(m, "beam", std::vector<double>(2));
  EXPECT_NEAR(load.least * 7.8529 / (2 * 9.81 / 10), -1, 1e-4);
  EXPECT_NEAR(load.shares[9], load.least, 1e-12) << "all of it from v̇ − g along x";
}

// Under a load at the tip the limit is pi^2/4; four clamped-free modes are stiffer by 0.1 %.
TEST(MotionStiffness, a_carried_mass_buckles_a_column_at_pi_squared_over_four) {
  const Made m(cantilever("[-9.81, 0, 0]", 1e-6, 0.5, "bending_y: {stiffness: 10, modes: 8}"));
  const LoadRatio load = load_of(m, "beam", std::vector<double>(8));
  const double expected = -0.5 * 9.81 / (10 * std::numbers::pi * std::numbers::pi / 4);
  EXPECT_NEAR(load.least / expected, 1, 1e-2);
  EXPECT_LT(std::abs(load.least), std::abs(expected)) << "modes can only be stiffer";
}

// A dead force does what a weight of the same size does, wherever on what the column carries it acts.
TEST(MotionStiffness, a_force_buckles_a_column_as_a_weight_does) {
  const std::string bending = "bending_y: {stiffness: 10, modes: 3}";
  const LoadRatio weight = load_of(Made(cantilever("[-9.81, 0, 0]", 1e-6, 0.5, bending)), "beam", {0, 0, 0});
  for (const char* frame : {"beam.tip", "tip"}) {
    const std::string push = "loads: {push: {type: force, frame: " + std::string(frame) + ", value: [-4.905, 0, 0]}}\n";
    const LoadRatio force = load_of(Made(cantilever("[0, 0, 0]", 1e-6, 0.5, bending) + push), "beam", {0, 0, 0});
    EXPECT_NEAR(force.least, weight.least, 1e-6) << frame;
    EXPECT_NEAR(force.shares.back(), force.least, 1e-6) << frame << ": all of it from the load";
  }
  // What holds a weight up at its own body spares the column.
  const LoadRatio held = load_of(Made(cantilever("[-9.81, 0, 0]", 1e-6, 0.5, bending) +
                                      "loads: {hold: {type: force, frame: tip, value: [4.905, 0, 0]}}\n"),
                                 "beam", {0, 0, 0});
  EXPECT_LT(held.size(), 1e-6);
}

// Bending and twist under a transverse load at the tip: P L^2 / sqrt(EI GJ) = 4.0154 in four modes of each kind
// (theory, section 6), in either sense.
TEST(MotionStiffness, a_transverse_load_buckles_laterally) {
  const Made m(cantilever("[0, 0, -9.81]", 1e-6, 0.5,
                          "bending_y: {stiffness: 10, modes: 4}, torsion: {stiffness: 3, inertia: 0.001, modes: 4}"));
  const LoadRatio load = load_of(m, "beam", std::vector<double>(8));
  const double expected = 0.5 * 9.81 / std::sqrt(30.0) / 4.0154;
  EXPECT_NEAR(load.least, -expected, 2e-4 * expected);
  EXPECT_NEAR(load.greatest, expected, 2e-4 * expected);
  // The two are the same but for rounding, and buckling is what matters.
  EXPECT_FALSE(load.stiffens);
  EXPECT_NEAR(load.shares[11], load.least, 1e-12);
}

// Functions that move and turn the root: what is welded there turns as a whole with it. Own computation, Ritz's
// quotient of ∫w''² over ∫(w' − w'(0))² in twelve free-free functions: P L²/EI = 2.62928, 6.6 % above pi²/4. On a hinge
// that leaves the turn free the beam keeps its ends in line, ∫w''² over ∫w'²: 4.00109 pi²/4.
TEST(MotionStiffness, a_beam_whose_functions_turn_its_root_buckles_as_it_is_held_there) {
  const std::string bending = "bending_y: {stiffness: 10, modes: 12, family: free-free}";
  const std::string push = "loads: {push: {type: force, frame: beam.tip, value: [-10, 0, 0]}}\n";
  const LoadRatio welded =
      load_of(Made(cantilever("[0, 0, 0]", 1, 1e-6, bending) + push), "beam", std::vector<double>(12));
  EXPECT_NEAR(welded.least, -1 / 2.62928, 1e-4);
  EXPECT_FALSE(welded.stiffens);
  EXPECT_NEAR(welded.shares.back(), welded.least, 1e-9) << "all of it from the load";
  const LoadRatio hinged = load_of(Made(cantilever("[0, 0, 0]", 1, 1e-6, bending, "revolute, axis: [0, 0, 1]") + push),
                                   "beam", std::vector<double>(13));
  EXPECT_NEAR(hinged.least, -4 / (4.00109 * std::numbers::pi * std::numbers::pi), 1e-4);
}

// Centrifugal tension stiffens the first bending mode of a beam hinged at its axis by 1.193 Omega^2 (theory, section
// 2).
TEST(MotionStiffness, spin_stiffens_by_1_193_of_its_square) {
  Made m(cantilever("[0, 0, 0]", 2, 1e-12, "bending_y: {stiffness: 10, modes: 1}", "revolute, axis: [0, 0, 1]"));
  const double rate = 3;
  m.scene.initial.y[m.scene.model->layout().positions] = rate;
  const LoadRatio load = load_of(m, "beam", std::vector<double>(2));
  const double fundamental = 3.51602 * std::sqrt(10.0 / 2.0);
  EXPECT_NEAR(load.greatest, 1.193 * rate * rate / (fundamental * fundamental), 2e-4);
  EXPECT_TRUE(load.stiffens);
  EXPECT_NEAR(load.shares[2], load.greatest, 1e-12);
  EXPECT_NEAR(elastic_modes(m.scene.model->bodies()[0].body->shape()).frequencies[0], fundamental, 1e-4);
}

}  // namespace
}  // namespace withy::test
