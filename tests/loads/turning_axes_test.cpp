/// \file
/// The field of axes that turn against a shaft that is driven: which formulations have the same terms in both.
#include <cmath>
#include <string>
#include <vector>

#include "scene_run.hpp"

namespace withy::test {
namespace {

/// A boom on a hinge of a hub, bent at the start.
std::string boom(const std::string& formulation, const std::string& rest) {
  return "format: withy/1\ntime: {end: 1, output: 0.5}\nformulation: " + formulation + R"(
integrator: {name: dop853, rtol: 1e-10, atol: 1e-12}
bodies:
  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {edge: {position: [0.2, 0, 0]}}}
  boom: {type: beam, length: 2, mass_per_length: 0.3, bending_y: {stiffness: 5, modes: 2}, bending_z: {stiffness: 5, modes: 2}}
hinges:
  shaft: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: revolute, axis: [0, 0, 1], parent: hub.edge, child: boom}
initial: {hinges: {root: {position: [0.5]}}, bodies: {boom: {modes: [0.05, 0, 0.04, 0]}}}
)" + rest;
}

/// By how much the hinge of the boom differs at the end [rad].
double difference(const std::string& formulation) {
  LoadedScene driven(boom(formulation, "motions: {spin: {type: constant-rate, hinge: shaft, rate: 0.8}}\n"));
  LoadedScene turning(boom(formulation,
                           "motions: {hold: {type: locked, hinge: shaft}}\n"
                           "loads: {axes: {type: rotating-frame, rate: 0.8}}\n"));
  const std::vector<State> a = driven.run(), b = turning.run();
  return std::abs(driven.position(a.back(), "root") - turning.position(b.back(), "root"));
}

TEST(TurningAxes, AreADrivenShaftWhereNothingOfItsRatesIsDropped) {
  for (const std::string formulation : {"quadratic", "exact", "linear", "ruthless"})
    EXPECT_LT(difference(formulation), 1e-8) << formulation;
}

TEST(TurningAxes, DifferByWhatIsDroppedElsewhere) {
  for (const std::string formulation : {"consistent", "inconsistent", "symmetric", "rate-linear"})
    EXPECT_GT(difference(formulation), 1e-6) << formulation;
}

}  // namespace
}  // namespace withy::test
