// The inertia of rotors behind gears, as hinges feel it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "random_case.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

/// A disc of 2 kg m² that is free to turn, and an arm of 0.5 kg m² on its axis, by a drive that reflects 3 kg m².
std::string disc_and_arm(const std::string& rest) {
  return R"(
format: withy/1
time: {end: 2, output: 0.1}
bodies:
  disc: {type: rigid, mass: 1, inertia: [2, 2, 2, 0, 0, 0]}
  arm: {type: rigid, mass: 1, inertia: [0.5, 0.5, 0.5, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: disc}
  drive: {type: revolute, axis: [0, 0, -1], parent: disc, child: arm, reflected_inertia: 3}
)" + rest;
}

class ReflectedInertia : public testing::TestWithParam<std::string> {};

/// T = ½ 2 ω² + ½ 0.5 (ω − ẋ)² + ½ 3 ẋ², and 7 N m on x: M (ω̇, ẍ) = (0, 7).
TEST_P(ReflectedInertia, IsFeltByItsRateAlone) {
  const Case c(disc_and_arm("loads: {motor: {type: hinge-effort, hinge: drive, value: 7}}\n"), GetParam());
  State s = c.state;
  s.y[2] = 0.3, s.y[3] = -0.8;
  const std::vector<double> y_dot = c.derivatives(s);
  const double a = 2 + 0.5, b = -0.5, d = 0.5 + 3, determinant = a * d - b * b;
  EXPECT_NEAR(y_dot[2], -b * 7 / determinant, 1e-14);
  EXPECT_NEAR(y_dot[3], a * 7 / determinant, 1e-14);
  const auto seen = c.equations->make_observation();
  seen->observe(s.y);
  EXPECT_NEAR(seen->energies().kinetic, 0.5 * (2 * 0.09 + 0.5 * 1.21 + 3 * 0.64), 1e-14);
  EXPECT_NEAR(seen->energies().angular_momentum[2], 2 * 0.3 + 0.5 * 1.1, 1e-14) << "that of the bodies";
  EXPECT_NEAR(c.equations->energies(s.y).kinetic, seen->energies().kinetic, 1e-14);
}

/// T as before is the `energy` of all; that of a body is its own.
TEST_P(ReflectedInertia, IsPartOfTheEnergyOfAll) {
  const Case c(disc_and_arm("outputs: {all: {type: energy}, of_arm: {type: energy, of: arm}}\n"), GetParam());
  State s = c.state;
  s.y[2] = 0.3, s.y[3] = -0.8;
  SensorReader reader(c.scene.outputs, *c.equations);
  std::vector<double> values(reader.columns().size());
  ASSERT_TRUE(reader.read(s, values));
  EXPECT_NEAR(values[0], 0.5 * (2 * 0.09 + 0.5 * 1.21 + 3 * 0.64), 1e-14);
  EXPECT_NEAR(values[3], 0.5 * 0.5 * 1.21, 1e-14);
}

/// What drives the hinge moves the rotor as well, and its work is the energy of both.
TEST_P(ReflectedInertia, IsMovedByWhatDrivesTheHinge) {
  const Case c(disc_and_arm("integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}\n"
                            "motions: {swing: {type: sine, hinge: drive, amplitude: 0.4, period: 1.3}}\n"),
               GetParam());
  State s = c.state;
  s.time = 0.4;
  c.scene.model->prescribe(s);
  const std::vector<double> y_dot = c.derivatives(s);
  std::vector<double> efforts(2);
  Work work = c.equations->make_work();
  ASSERT_TRUE(c.equations->motion_efforts(s.time, s.y, efforts, work).ok());
  // 2.5 ω̇ = 0.5 ẍ; the drive gives 0.5 (ẍ − ω̇) + 3 ẍ.
  EXPECT_NEAR(y_dot[2], 0.2 * y_dot[3], 1e-13);
  EXPECT_NEAR(efforts[1], (0.5 * 0.8 + 3) * y_dot[3], 1e-12);
  RunOptions options;
  options.end = 2;
  const RunSummary run = simulate(*c.scene.model, *c.equations, *c.scene.integrator, c.scene.initial, options, {});
  EXPECT_EQ(run.status, RunStatus::completed);
  EXPECT_LT(run.energy_drift, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Formulations, ReflectedInertia, testing::ValuesIn(formulations), formulation_name);

/// Mass is added to M where its rate is, and nowhere else.
TEST(ReflectedInertiaOfAScrew, IsAddedToTheMassMatrix) {
  const std::string bare = R"(
format: withy/1
bodies: {nut: {type: rigid, mass: 1, center_of_mass: [0.1, 0.2, 0.3], inertia: [0.4, 0.4, 0.4, 0, 0, 0]}}
hinges: {thread: {type: screw, axis: [0, 0, 1], pitch: 0.2, parent: world, child: nut)";
  for (const std::string& formulation : formulations) {
    const Case without(bare + "}}\n", formulation), with(bare + ", reflected_inertia: 0.25 kg m^2}}\n", formulation);
    const auto mass = [](const Case& c) { return c.equations->system(0, c.state.y).mass.at(0); };
    EXPECT_NEAR(mass(with), mass(without) + 0.25, 1e-15);
    std::vector<double> one{1}, product(1);
    Work work = with.equations->make_work();
    with.equations->mass_times(with.state.y, one, product, work);
    EXPECT_NEAR(product[0], mass(with), 1e-14);
  }
}

TEST(ReflectedInertiaOfAScene, IsRefusedWhereItIsOfNoRate) {
  const auto refusal = [](const std::string& hinge) {
    Registry registry;
    enroll_static_plugins(registry);
    try {
      static_cast<void>(parse_scene("format: withy/1\nbodies: {b: {type: rigid, mass: 1}}\nhinges: {h: {" + hinge +
                                        ", parent: world, child: b}}\n",
                                    "refused.yaml", registry, {"quadratic", "", {}}));
    } catch (const SceneError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal("type: spherical, reflected_inertia: 1"),
              HasSubstr("refused.yaml:3:50: /hinges/h/reflected_inertia: only hinges of one rate have a reflected "
                        "inertia, and this one has 3"));
  EXPECT_THAT(refusal("type: weld, reflected_inertia: 1"), HasSubstr("and this one has 0"));
  EXPECT_THAT(refusal("type: revolute, axis: [0, 0, 1], reflected_inertia: -1"),
              HasSubstr("/hinges/h/reflected_inertia: got -1"));
}

}  // namespace
}  // namespace withy::test
