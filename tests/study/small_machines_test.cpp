// What holds of a machine holds of it in other units: small motions about its steady states, down to nanometres and
// piconewtons.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "withy/study/equilibrium.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;

/// A rotor whose controller acts through a servo too slow for it: unstable. All masses and torques are times `k`.
std::string slow_servo(double k) {
  return fmt::format(R"(
bodies: {{rotor: {{type: rigid, mass: {0}, inertia: [{0}, {0}, {0}, 0, 0, 0]}}}}
hinges: {{axle: {{type: revolute, axis: [0, 0, 1], parent: world, child: rotor}}}}
loads:
  law: {{type: pid, of: axle, to: nothing, proportional: {1}, limit: {0}}}
  servo: {{type: actuator, of: law, hinge: axle, frequency: 10, limit: {2}}}
)",
                     k, 5 * k, 0.5 * k);
}

/// Behind limits of a piconewton metre too, which steps of a unit do not meet.
TEST(SmallMachines, LoopsWithinSmallLimitsAreAsUnstableAsWithinGreatOnes) {
  const auto growth = [](double k) {
    const Prepared prepared = scene_of(slow_servo(k));
    const Equilibrium found = find_equilibrium({prepared, prepared.scene.initial, {}}, {}, plugins());
    return found.stability ? found.stability->growth : -1;
  };
  const double known = growth(1);
  EXPECT_GT(known, 0.1);
  for (const double k : {1e-6, 1e-9, 1e-10, 1e-12}) EXPECT_NEAR(growth(k), known, 1e-6 * known) << k;
}

/// A beam on a hub, with a spring from the world to its tip. All lengths are times `k`, and times stay.
std::string sprung_arm(double k) {
  return fmt::format(R"(
bodies:
  hub: {{type: rigid, mass: 2, inertia: [{1}, {1}, {1}, 0, 0, 0], frames: {{rim: {{position: [{0}, 0, 0]}}}}}}
  arm: {{type: beam, length: {2}, mass_per_length: {3}, bending_y: {{stiffness: {4}, modes: 1}}}}
hinges:
  axle: {{type: revolute, axis: [0, 0, 1], parent: world, child: hub}}
  root: {{type: weld, parent: hub.rim, child: arm}}
loads: {{spring: {{type: spring-damper, frame: arm.tip, anchor: [{2}, {2}, 0], stiffness: 3, free_length: {5}}}}}
)",
                     0.1 * k, 0.2 * k * k, k, 1 / k, 3 * k * k * k, 0.5 * k);
}

TEST(SmallMachines, SmallMotionsAreThoseOfGreatOnes) {
  const auto in_units = [](double k) -> Eigen::MatrixXd {
    const LinearModel m = linear_model(at_start(scene_of(sprung_arm(k))), {});
    const Eigen::Vector4d sizes(1, k, 1, k);  // of the angle and the mode, and their rates
    return sizes.cwiseInverse().asDiagonal() * m.system.A * sizes.asDiagonal();
  };
  const Eigen::MatrixXd known = in_units(1);
  ASSERT_EQ(known.rows(), 4);
  for (const double k : {1e6, 1e-3, 1e-6, 1e-9})
    EXPECT_LT((in_units(k) - known).cwiseAbs().maxCoeff(), 1e-7 * known.cwiseAbs().maxCoeff()) << k;
}

/// Booms along the axis that it spins about are mounted at right angles, whose cosine is not zero in doubles.
TEST(SmallMachines, ACraftThatSpinsAboutWhatIsMountedOnItsAxisIsSteady) {
  for (const std::string boom :
       {"type: beam, length: 2, mass_per_length: 0.02, bending_y: {stiffness: 3, modes: 1}", "type: rigid, mass: 3"}) {
    const Prepared prepared = scene_of(R"(
bodies:
  bus:
    type: rigid
    mass: 50
    inertia: [10, 10, 6, 0, 0, 0]
    frames: {top: {position: [0, 0, 0.7], orientation: {axis: [0, 1, 0], angle: -90 deg}}}
  boom: {)" + boom + R"(}
hinges:
  float: {type: free, parent: world, child: bus}
  mast: {type: weld, parent: bus.top, child: boom}
initial: {hinges: {float: {rate: [0, 0, 2, 0, 0, 0]}}}
)");
    const Equilibrium found = find_equilibrium({prepared, prepared.scene.initial, {}}, {}, plugins());
    EXPECT_EQ(found.problem, "") << boom;
  }
}

}  // namespace
}  // namespace withy::study
