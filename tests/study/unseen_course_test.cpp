// What steps of a fixed size do not see of loads and motions, and that a run says so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

/// A pendulum that a torque shakes, and a drum that a motion turns to and fro.
CertifiedRun run_of_shaken(const std::string& integrator, const std::string& load, const std::string& motion) {
  SceneValues values = SceneValues::parse("format: withy/1\nintegrator: " + integrator + R"(
time: {end: 1}
bodies:
  bar: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0], center_of_mass: [0, -0.3, 0]}
  drum: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  pin: {type: revolute, axis: [0, 0, 1], parent: world, child: bar}
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: drum}
loads: {weight: {type: hinge-spring, hinge: pin, stiffness: 1}, shaker: )" +
                                              load + "}\nmotions: {turn: " + motion + "}\n",
                                          "shaken");
  return run(prepare(values, plugins()), plugins());
}
std::string sine_load(double period) {
  return "{type: hinge-effort, hinge: pin, law: sine, amplitude: 0.1, period: " + std::to_string(period) + "}";
}
std::string sine_motion(double period) {
  return "{type: sine, hinge: axle, amplitude: 0.1, period: " + std::to_string(period) + "}";
}

TEST(UnseenCourse, IsNamedWhereStepsAreFixed) {
  const std::string slow = sine_motion(0.5), steps_of_20ms = "{name: rk4, step: 0.02}";
  // Parts of the step too, at which the load is the same at both of its ends.
  for (const double period : {0.035, 0.02, 0.013, 0.01, 0.005, 0.0025, 0.00123, 1e-4}) {
    const CertifiedRun shaken = run_of_shaken(steps_of_20ms, sine_load(period), slow);
    EXPECT_THAT(shaken.summary.message, testing::HasSubstr("Load 'shaker' goes to and fro every ")) << period;
    EXPECT_THAT(shaken.summary.message, testing::HasSubstr("and steps of 0.02 s do not follow it")) << period;
    const CertifiedRun turned = run_of_shaken(steps_of_20ms, sine_load(0.5), sine_motion(period));
    EXPECT_THAT(turned.summary.message, testing::HasSubstr("Motion 'turn' goes to and fro every ")) << period;
  }
}

/// Samples of it tell the period to an eighth, a clock to the last bit.
TEST(UnseenCourse, SaysThatItsPeriodIsRough) {
  const CertifiedRun shaken = run_of_shaken("{name: rk4, step: 0.02}", sine_load(0.01), sine_motion(0.5));
  EXPECT_THAT(shaken.summary.message, testing::HasSubstr(" s or so, whatever moves, "));
}

TEST(UnseenCourse, IsNoneWhereStepsFollow) {
  const std::string slow = sine_motion(0.5);
  const auto message = [](const std::string& integrator, const std::string& load, const std::string& motion) {
    return run_of_shaken(integrator, load, motion).summary.message;
  };
  EXPECT_EQ(message("{name: rk4, step: 0.02}", sine_load(0.06), slow), "");
  EXPECT_EQ(message("{name: rk4, step: 0.0005}", sine_load(0.01), slow), "");
  EXPECT_EQ(message("{name: dopri5, rtol: 1e-6}", sine_load(0.01), slow), "") << "it controls its error";
  EXPECT_EQ(message("{name: rk4, step: 0.02}",
                    "{type: hinge-effort, hinge: pin, law: steps, table: [[0, 1], [0.003, "
                    "-1], [0.005, 1], [0.011, 0]]}",
                    slow),
            "")
      << "steps end where it jumps";
}

}  // namespace
}  // namespace withy::study
