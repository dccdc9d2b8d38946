// What the parts of this project do in scenes, against closed forms and against parts of the package.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <withy/host/simulation.hpp>

namespace {

using withy::host::Scene;
using withy::host::Simulation;

const withy::host::Library& library() {
  static const withy::host::Library library({{OWN_PLUGINS}, {}});
  return library;
}

Scene scene(const std::string& name) { return Scene::read(library(), OWN_SCENES "/" + name + ".yaml"); }

/// Greatest error of θ and of its rate over six seconds, some four swings.
double tautochrone_error(const Scene& scene) {
  const double omega = std::sqrt(9.81 / (4 * 0.5)), widest = std::sin(1.25);
  Simulation simulation(scene);
  double error = 0;
  for (int k = 1; k <= 60; ++k) {
    const double t = 0.1 * k, s = widest * std::cos(omega * t);
    simulation.step(t);
    const double rate = -2 * widest * omega * std::sin(omega * t) / std::sqrt(1 - s * s);
    error = std::max({error, std::abs(simulation.output("track") - 2 * std::asin(s)),
                      std::abs(simulation.output("track.rate") - rate)});
  }
  return error;
}

TEST(Hinge, a_slider_on_the_tautochrone_swings_as_huygens_says) {
  Scene exact = scene("tautochrone");
  exact.set("integrator", "{name: dop853, rtol: 1e-11, atol: 1e-12}");
  EXPECT_LT(tautochrone_error(exact), 1e-9);
}

TEST(Integrator, halving_its_step_divides_the_error_by_eight) {
  double error[3];
  for (int k = 0; k < 3; ++k)
    error[k] = tautochrone_error(scene("tautochrone").set("integrator.step", 0.01 / (1 << k)));
  EXPECT_NEAR(std::log2(error[0] / error[1]), 3, 0.1);
  EXPECT_NEAR(std::log2(error[1] / error[2]), 3, 0.1);
}

TEST(Integrator, goes_on_bit_by_bit_from_a_snapshot) {
  Simulation whole(scene("tautochrone")), other(scene("tautochrone"));
  whole.step(0.73);
  const withy::host::Snapshot kept = whole.snapshot();
  whole.step(1.9);
  other.restore(kept);
  other.step(1.9);
  EXPECT_EQ(whole.output("track"), other.output("track"));
  EXPECT_EQ(whole.output("track.rate"), other.output("track.rate"));
}

TEST(Load, drag_slows_a_puck_as_its_equation_says) {
  Scene puck = scene("puck");
  puck.set("integrator", "{name: dop853, rtol: 1e-11, atol: 1e-12}");
  Simulation simulation(puck);
  for (const double t : {1.0, 2.5, 5.0}) {
    simulation.step(t);
    const double slower = 1 + 0.4 * 3 * t / 2;
    EXPECT_NEAR(simulation.output("slide"), 2 / 0.4 * std::log(slower), 1e-9);
    EXPECT_NEAR(simulation.output("slide.rate"), 3 / slower, 1e-9);
    EXPECT_EQ(simulation.output("fast"), std::abs(simulation.output("slide.rate"))) << "the sensor";
  }
}

TEST(Motion, a_cycloid_leads_a_hinge_and_needs_the_inertia_times_its_acceleration) {
  Scene still = scene("turntable");
  still.set("motions",
            "{turn: {hinge: axle, type: cycloid, to: 180 deg, duration: 2}, stop: {hinge: slot, type: locked}}");
  Simulation simulation(still);
  simulation.step(0.5);  // a quarter of the way in time: the greatest acceleration
  EXPECT_NEAR(simulation.output("axle"), std::numbers::pi * (0.25 - 1 / (2 * std::numbers::pi)), 1e-12);
  EXPECT_NEAR(simulation.output("axle.rate"), std::numbers::pi / 2, 1e-12);
  const double inertia = 3 * (2.0 * 2 / 3 + 0.02 * 0.02 / 4) + 0.5 * 0.5 * 0.5 + 0.001;
  EXPECT_NEAR(simulation.output("axle.motion_effort"), inertia * std::numbers::pi * std::numbers::pi / 2, 1e-9);
}

TEST(Formulation, without_products_of_speeds_a_bead_stays_where_it_is_on_a_turning_arm) {
  Scene table = scene("turntable");
  table.set("motions.turn", "{hinge: axle, type: constant-rate, rate: 1.5 rad/s}");
  Simulation whole(table), slow(table.formulation("slow-linear"));
  whole.step(2);
  slow.step(2);
  EXPECT_NEAR(whole.output("slot"), 0.5 * std::cosh(3.0), 1e-8);
  EXPECT_EQ(slow.output("slot"), 0.5);
}

TEST(StrainKinematics, in_the_plane_a_spinning_beam_moves_as_in_the_complete_second_order) {
  const auto tip = [](const char* formulation) {
    Scene beam = Scene::parse(library(), R"(
format: withy/1
name: spinning beam
integrator: {name: dop853, rtol: 1e-9, atol: 1e-11}
time: {end: 2, output: 0.1}
bodies: {beam: {type: beam, length: 2, mass_per_length: 1.5, bending_y: {stiffness: 40, modes: 2}}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: beam}}
motions: {spin: {hinge: axle, type: spin-up, rate: 2.5 rad/s, duration: 2}}
)");
    beam.set("formulation", formulation);
    Simulation simulation(beam);
    simulation.step(2);
    return simulation.output("beam.tip.deflection_y");
  };
  const double unturned = tip("{kinematics: unturned, truncation: none}");
  EXPECT_NEAR(unturned, tip("quadratic"), 1e-8);
  EXPECT_GT(std::abs(unturned - tip("linear")), 1e-3) << "which lacks the stiffness that the turning gives";
}

}  // namespace
