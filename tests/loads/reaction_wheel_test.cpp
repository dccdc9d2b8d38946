// Reaction wheels, by what outputs show.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "withy/tests/loads/shown_outputs.hpp"

namespace withy {
namespace {

using test::Shown;
using testing::HasSubstr;

/// A bus about its axis with a wheel on it: J_b = 4, J_w = 0.1.
const std::string wheel_on_bus = R"(format: withy/1
time: {end: 10, output: 0.1}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
bodies:
  bus: {type: rigid, mass: 10, inertia: [4, 4, 4, 0, 0, 0]}
  wheel: {type: rigid, mass: 1, inertia: [0.05, 0.05, 0.1, 0, 0, 0]}
hinges:
  turn: {type: revolute, axis: [0, 0, 1], parent: world, child: bus}
  axle: {type: revolute, axis: [0, 0, 1], parent: bus, child: wheel}
outputs:
  drive: {type: control, of: wheel}
  turn_seen: {type: hinge, hinge: turn}
  axle_seen: {type: hinge, hinge: axle}
)";

/// The command is constant and a lag begins settled on it: it changes nothing, at the limit of speed neither.
TEST(ReactionWheel, GivesItsTorqueToTheBusUntilItsSpeedLimit) {
  for (const char* lag : {"0", "0.5", "2"}) {
    const Shown s(wheel_on_bus + R"(loads:
  law: {type: expression, value: "0.5", to: nothing}
  wheel: {type: reaction-wheel, of: law, hinge: axle, torque_limit: 0.2, speed_limit: 8, inertia: 0.1, time_constant: )" +
                  lag + "}\n");
    const std::vector<double> bus = s["turn_seen.rate"], rate = s["axle_seen.rate"], momentum = s["drive.momentum"];
    const double reduced = 1 / (1 / 0.1 + 1 / 4.0);  // of the rate between the two
    for (std::size_t k = 0; k < s.times.size(); ++k) {
      ASSERT_NEAR(4 * bus[k] + 0.1 * (bus[k] + rate[k]), 0, 1e-9) << "momentum is kept";
      ASSERT_DOUBLE_EQ(momentum[k], 0.1 * rate[k]);
      ASSERT_LE(rate[k], 8 + 1e-9) << lag;
      if (s.times[k] < 0.99 * 8 * reduced / 0.2) {
        ASSERT_NEAR(rate[k], 0.2 * s.times[k] / reduced, 1e-7);
      }
    }
    EXPECT_NEAR(rate.back(), 8, 1e-3);
    EXPECT_LT(s["drive.motor"].back(), 1e-3);
  }
}

/// T τ̇ = c − τ from τ(0) = c(0) = −c₁ with c = c₁ (2 t − 1): τ = c₁ (2 t − 1 − 2 T (1 − e^(−t/T))), whether the wheel
/// is at its limit or not. The wheel begins at −8, which the motor drives no further, and is braked as soon as τ > 0.
TEST(ReactionWheel, AtItsSpeedLimitBrakesAsSoonAsItsTorqueDoes) {
  const Shown s(wheel_on_bus + R"(initial: {hinges: {axle: {rate: [-8]}}}
loads:
  law: {type: expression, value: 0.1 * (2 * t - 1), to: nothing}
  wheel: {type: reaction-wheel, of: law, hinge: axle, speed_limit: 8, time_constant: 0.4}
)",
                {"time.end=2"});
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    const double t = s.times[k], torque = 0.1 * (2 * t - 1 - 0.8 * (1 - std::exp(-t / 0.4)));
    ASSERT_NEAR(s["drive.torque"][k], torque, 1e-8) << t;
    ASSERT_NEAR(s["drive.motor"][k], std::max(torque, 0.0), 1e-8) << t;
    ASSERT_GE(s["axle_seen.rate"][k], -8 - 1e-9) << t;
  }
  EXPECT_GT(s["axle_seen.rate"].back(), -7);
}

/// Far above its speed Coulomb's friction is constant: J Ω̇ = −b Ω − τ_c.
TEST(ReactionWheel, SlowsDownByFrictionAndStops) {
  const Shown s(wheel_on_bus + R"(initial: {hinges: {axle: {rate: [20]}}}
loads:
  law: {type: expression, value: "0", to: nothing}
  wheel: {type: reaction-wheel, of: law, hinge: axle, viscous: 0.01, coulomb: 0.1, coulomb_speed: 0.02}
)",
                {"time.end=40"});
  const double J = 1 / (1 / 0.1 + 1 / 4.0), b = 0.01, c = 0.1;
  const double stop = J / b * std::log(1 + 20 * b / c);
  ASSERT_LT(stop, 30);
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    const double rate = (20 + c / b) * std::exp(-b * s.times[k] / J) - c / b;
    if (rate > 1) {
      ASSERT_NEAR(s["axle_seen.rate"][k], rate, 1e-6) << s.times[k];
    }
    if (s.times[k] > stop + 1) {
      ASSERT_NEAR(s["axle_seen.rate"][k], 0, 1e-3) << s.times[k];
    }
  }
}

TEST(ReactionWheel, WithALagTakesAccelerationsAndNamesWhatItLacks) {
  const auto problem = [](const std::string& options) {
    return test::problem_of(wheel_on_bus +
                            "  imu: {type: accelerometer, of: wheel}\nloads: {wheel: {type: reaction-wheel, " +
                            options + "}}\n");
  };
  EXPECT_EQ(problem("of: imu.x, hinge: axle, time_constant: 0.1"), "");
  EXPECT_THAT(problem("of: imu.x, hinge: axle"), HasSubstr("is algebraic"));
  EXPECT_THAT(problem("hinge: axle"), HasSubstr("needs 'of' with one signal, the torque that is commanded"));
  EXPECT_THAT(problem("of: turn, hinge: axle, sample: 0.1"), HasSubstr("its controller may be sampled"));
}

}  // namespace
}  // namespace withy
