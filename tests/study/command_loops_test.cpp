// Loops of controllers that act through drives: opened at the command, their margins are those of the controller's
// gain. Checked by the modes of the same scene with that gain.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "withy/study/input_error.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/response.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A bus that a wheel turns, whose bearing has friction, or whose motor gives back what its speed makes.
std::string bus(const std::string& drive, double gain) {
  return fmt::format(R"(
bodies:
  bus: {{type: rigid, mass: 10, inertia: [2, 2, 2, 0, 0, 0]}}
  disk: {{type: rigid, mass: 1, inertia: [0.05, 0.05, 0.1, 0, 0, 0]}}
hinges:
  stand: {{type: revolute, axis: [0, 0, 1], parent: world, child: bus}}
  axle: {{type: revolute, axis: [0, 0, 1], parent: bus, child: disk}}
outputs:
  at: {{type: hinge, hinge: stand}}
  back: {{type: expression, value: -at.position, unit: rad}}
loads:
  law: {{type: pid, of: back, to: nothing, proportional: {}, derivative: {}, filter: 0.05}}
  drive: {}
)",
                     2 * gain, 3 * gain, drive);
}

const std::string wheel =
    "{type: reaction-wheel, of: law, hinge: axle, time_constant: 0.3, viscous: 0.2, coulomb: 0.05}";
const std::string motor =
    "{type: dc-motor, of: law, hinge: axle, resistance: 2, inductance: 0.4, torque_constant: 0.8}";
/// Without a state of its own: the command is an effort at once.
const std::string formula = "{type: expression, value: law - 0.3 * axle.rate, hinge: axle}";

double growth(const std::string& scene) {
  double most = -1e300;
  const ModesAt at = modes_at(at_start(scene_of(scene)), true);
  EXPECT_EQ(at.problem, "");
  for (const Mode& mode : at.modes)
    if (!mode.rigid) most = std::max(most, mode.growth());
  return most;
}

Response opened(const std::string& scene, const std::string& input) {
  return response(at_start(scene_of(scene)), {input, "", {}, {}, 100, {}});
}

TEST(LoopOfACommand, HasTheMarginsOfTheControllersGain) {
  for (const std::string& drive : {wheel, motor}) {
    const Response r = opened(bus(drive, 1), "law");
    ASSERT_TRUE(r.margins && r.margins->stable && r.margins->upper() != nullptr) << drive;
    const double factor = r.margins->upper()->factor;
    EXPECT_LT(growth(bus(drive, 0.999 * factor)), 0) << drive << factor;
    EXPECT_GT(growth(bus(drive, 1.001 * factor)), 0) << drive << factor;
    EXPECT_THAT(r.follows, IsEmpty());
    EXPECT_EQ(r.model.inputs[0].name, "law");
  }
}

/// The answer −c(s) of J_b s² θ = −τ, J_w s (s θ + Ω) = τ, τ = v − d Ω.
TEST(LoopOfACommand, IsTheClosedFormOfAWheelThatFollowsAtOnce) {
  const Response r = opened(bus(formula, 1), "law");
  using C = std::complex<double>;
  constexpr double bus_inertia = 2, disk = 0.1, damping = 0.3;
  for (const ResponseAt& at : r.values) {
    const C s(0, at.omega);
    // Ω = τ (1/J_w + 1/J_b)/s, and so τ (1 + d (1/J_w + 1/J_b)/s) = c.
    const C tau = 1.0 / (1.0 + damping * (1 / disk + 1 / bus_inertia) / s), theta = -tau / (bus_inertia * s * s);
    const C law = 2.0 + 3.0 * s / (0.05 * s + 1.0);
    ASSERT_LT(std::abs(at.value + law * theta), 1e-7 * std::abs(law * theta)) << at.omega;
  }
}

/// Of all that the drive does its friction is a part.
TEST(LoopOfADrive, SaysWhoseCommandItFollows) {
  const Response r = opened(bus(wheel, 1), "drive"), law = opened(bus(wheel, 1), "law");
  EXPECT_THAT(r.follows, ElementsAre("law"));
  ASSERT_TRUE(r.margins && law.margins && law.margins->upper() != nullptr);
  const bool same =
      r.margins->upper() != nullptr && std::abs(r.margins->upper()->factor / law.margins->upper()->factor - 1) < 0.05;
  EXPECT_FALSE(same);
}

TEST(LoopOfACommand, ThatNothingFollowsIsRefused) {
  EXPECT_THROW(opened(bus("{type: hinge-spring, hinge: axle, stiffness: 1, damping: 1}", 1), "law"), InputError);
}

}  // namespace
}  // namespace withy::study
