// Controllers, actuators and motors on either side of their limits: what they say of their derivatives, where they
// begin, and how far they tell that the limits are.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "withy/core/tangents/load_derivatives.hpp"
#include "withy/tests/loads/shown_outputs.hpp"

namespace withy {
namespace {

using test::LoadedScene;
using test::Shown;

/// A turntable with a load, and places where the load is looked at: of the axle, its rate, and the load's states.
struct Places {
  std::string load;
  std::vector<std::vector<double>> all;
};

TEST(ControlLimits, DerivativesAreThoseOfTheSideThatAStateIsOn) {
  const std::string pid = "{type: pid, hinge: axle, proportional: 3, integral: 2, derivative: 0.5, ";
  const std::string table = "[[-2, 1], [2, 5]]";
  const std::vector<Places> cases = {
      {"{type: actuator, of: axle, hinge: axle, frequency: 3, limit: 0.4, rate_limit: 1}",
       {{0.2, 0, 0.1, 0.3}, {1, 0, 0.1, 0.3}, {0.2, 0, 0.1, 5}, {0.2, 0, 0.9, 0.3}, {-1, 0, -0.9, -5}}},
      {"{type: dc-motor, of: axle, hinge: axle, resistance: 2, torque_constant: 0.3, gear: 5, voltage_limit: 0.5}",
       {{0.2, 1}, {1, 1}, {-1, -2}}},
      {"{type: dc-motor, of: axle, hinge: axle, resistance: 2, inductance: 0.1, torque_constant: 0.3, gear: 5, "
       "voltage_limit: 0.5}",
       {{0.2, 1, 0.3}, {1, 1, 0.3}}},
      {pid + "limit: 2, tracking_time: 0.7}", {{0.2, 0.1, 0.3}, {2, 0.1, 0.3}, {-2, 0.1, 0.3}}},
      {pid + "filter: 0.1, limit: 2, tracking_time: 0.7}", {{0.2, 0.1, 0.3, 0.1}, {2, 0.1, 0.3, 0.1}}},
      {pid + "limit: 2, anti_windup: clamping}", {{0.2, 0.1, 0.3}, {2, 0.1, 0.3}, {0.2, 0.1, 4}}},
      {"{type: pid, hinge: axle, proportional: " + table + ", integral: " + table + ", derivative: " + table +
           ", schedule: axle.rate, reference: 0.5}",
       {{0.2, 0.7, 0.3}, {0.2, 3, 0.3}, {0.2, -3, 0.3}}},
      {"{type: transfer-function, of: axle, hinge: axle, numerator: [2, 3], denominator: [1, 4], reference: 0.7}",
       {{0.2, 0, 0.4}}},
      {"{type: reaction-wheel, of: axle, hinge: axle, torque_limit: 0.5, speed_limit: 8, viscous: 0.1, coulomb: 0.2}",
       {{0.2, 3}, {0.2, 7.96}, {-0.2, -7.96}, {-0.2, 7.96}, {1, 7.96}, {1, 9}}},
      {"{type: reaction-wheel, of: axle, hinge: axle, torque_limit: 0.5, speed_limit: 8, time_constant: 0.4}",
       {{0.2, 3, 0.1}, {1, 3, 0.1}, {0.2, 7.96, 0.1}, {0.2, -7.96, -0.1}}}};
  for (const auto& [load, places] : cases) {
    const LoadedScene s(test::turntable + "loads: {drive: " + load + "}\n");
    const Model& model = *s.scene.model;
    for (const std::vector<double>& place : places) {
      State state = s.scene.initial;
      state.time = 0.3;
      state.y[s.hinge("axle").position] = place[0];
      state.y[model.layout().positions + s.hinge("axle").speed] = place[1];
      const auto& slot = model.loads()[0].continuous_slot;
      ASSERT_EQ(slot.count, place.size() - 2) << load;
      for (std::size_t i = 0; i < slot.count; ++i) state.y[slot.first + i] = place[2 + i];
      const auto wrong = false_derivative(model, state);
      EXPECT_FALSE(wrong) << load << " at " << testing::PrintToString(place) << ": " << wrong->what;
    }
  }
}

/// What is asked for at the start is there, as far as limits let it: no lag has a step to answer.
TEST(ControlLimits, StatesBeginSettledWithinThem) {
  const auto begun = [](const std::string& load) {
    const LoadedScene s(test::turntable +
                        "initial: {hinges: {axle: {position: [0.9], rate: [2]}}}\nloads: {drive: " + load + "}\n");
    const auto& slot = s.scene.model->loads()[0].continuous_slot;
    const auto first = s.scene.initial.y.begin() + static_cast<std::ptrdiff_t>(slot.first);
    return std::vector<double>(first, first + static_cast<std::ptrdiff_t>(slot.count));
  };
  EXPECT_EQ(begun("{type: actuator, of: axle, hinge: axle, frequency: 3, limit: 0.4}"), (std::vector{0.4, 0.0}));
  EXPECT_EQ(begun("{type: reaction-wheel, of: axle, hinge: axle, torque_limit: 0.5, time_constant: 1}"),
            std::vector{0.5});
  // (0.5 V − 0.1 V s · 2 rad/s) / 2 ohm.
  EXPECT_NEAR(begun("{type: dc-motor, of: axle, hinge: axle, resistance: 2, inductance: 0.1, torque_constant: 0.1, "
                    "voltage_limit: 0.5}")[0],
              0.15, 1e-15);
  EXPECT_NEAR(begun("{type: pid, hinge: axle, derivative: 1, filter: 0.1, reference: 0.5}")[0], -0.4, 1e-15);
}

TEST(ControlLimits, MarginsAreThoseToTheNearerSide) {
  const auto at_start = [](const std::string& load, const char* number) {
    return Shown(test::turntable + "initial: {hinges: {axle: {position: [-0.3], rate: [-3]}}}\noutputs: {drive_seen: " +
                     "{type: control, of: drive}}\nloads: {drive: " + load + "}\n",
                 {"time.end=0.1"})[std::string("drive_seen.") + number]
        .front();
  };
  EXPECT_NEAR(at_start("{type: pid, hinge: axle, proportional: 2, reference: -1, limit: 5}", "margin"), 3.6, 1e-14);
  EXPECT_NEAR(at_start("{type: reaction-wheel, of: axle, hinge: axle, speed_limit: 8}", "speed_margin"), 5, 1e-14);
  EXPECT_NEAR(at_start("{type: actuator, of: axle, hinge: axle, frequency: 3, rate_limit: 2}", "rate_margin"), 2, 1e-14)
      << "it begins settled";
}

}  // namespace
}  // namespace withy
