/// \file
/// Directional and adjoint derivatives against differences of what the FMU itself gives.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "withy/core/plugin/central_difference.hpp"
#include "withy/tests/fmi/importer.hpp"

namespace withy::test {
namespace {

/// Unknowns of an instance of model exchange along a direction of states and inputs, by differences.
std::vector<double> by_differences(Instance3& i, const std::vector<std::uint32_t>& unknowns,
                                   const std::vector<double>& y, const std::vector<double>& along_states,
                                   const std::vector<std::uint32_t>& inputs, const std::vector<double>& along_inputs) {
  const auto at = [&](double h) {
    std::vector<double> moved = y, u = along_inputs;
    for (std::size_t k = 0; k < y.size(); ++k) moved[k] += h * along_states[k];
    for (double& value : u) value *= h;
    EXPECT_EQ(i.fmi.SetContinuousStates(i.c, moved.data(), moved.size()), fmi3OK);
    EXPECT_EQ(i.fmi.SetFloat64(i.c, inputs.data(), inputs.size(), u.data(), u.size()), fmi3OK) << i.heard.last;
    Eigen::VectorXd values(static_cast<Eigen::Index>(unknowns.size()));
    EXPECT_EQ(i.fmi.GetFloat64(i.c, unknowns.data(), unknowns.size(), values.data(), unknowns.size()), fmi3OK);
    return values;
  };
  const Eigen::VectorXd found = central_difference(at, 2e-3);
  at(0);
  return {found.begin(), found.end()};
}

double slope_by(Instance3& i, std::uint32_t unknown, std::uint32_t known) {
  const double along = 1;
  double got = 0;
  EXPECT_EQ(i.fmi.GetDirectionalDerivative(i.c, &unknown, 1, &known, 1, &along, 1, &got, 1), fmi3OK) << i.heard.last;
  return got;
}

}  // namespace

TEST(Derivatives, DirectionalOnesAreThoseOfDifferencesAndAdjointOnesTheirTransposes) {
  for (const std::string& file :
       {smooth_arm_file(), std::string(SCENES "/commanded-arm.yaml"), std::string(SCENES "/loads-of-the-slew.yaml")}) {
    const Unpacked& fmu = exported(file, 3);
    Instance3 i(fmu, false);
    i.initialize();
    ASSERT_EQ(i.fmi.EnterContinuousTimeMode(i.c), fmi3OK);
    const std::vector<std::uint32_t> inputs = fmu.of("input");
    std::vector<double> y(fmu.states.size());
    ASSERT_EQ(i.fmi.GetContinuousStates(i.c, y.data(), y.size()), fmi3OK);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<std::uint32_t> knowns = fmu.states, unknowns = fmu.derivatives;
    std::vector<double> seed, along_states, along_inputs;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const bool quaternion = fmu.variables[fmu.states[k]].name.find(".q") != std::string::npos;
      const bool mode = fmu.variables[fmu.states[k]].name.find('[') != std::string::npos;
      // Of quaternions in every direction, also that in which they are no longer of unit length: an integrator asks for
      // each component by itself, and lets them drift.
      along_states.push_back((mode ? 0.02 : quaternion ? 0.3 : 1) * number(random));
      y[k] += (mode ? 1e-3 : 0.1) * number(random);
    }
    for (std::size_t k = 0; k < inputs.size(); ++k) along_inputs.push_back(number(random));
    const std::vector<std::uint32_t> outputs = fmu.of("output");
    unknowns.insert(unknowns.end(), outputs.begin(), outputs.end());
    knowns.insert(knowns.end(), inputs.begin(), inputs.end());
    seed = along_states;
    seed.insert(seed.end(), along_inputs.begin(), along_inputs.end());
    const std::vector<double> want = by_differences(i, unknowns, y, along_states, inputs, along_inputs);
    std::vector<double> got(unknowns.size());
    ASSERT_EQ(i.fmi.GetDirectionalDerivative(i.c, unknowns.data(), unknowns.size(), knowns.data(), knowns.size(),
                                             seed.data(), seed.size(), got.data(), got.size()),
              fmi3OK)
        << i.heard.last;
    double greatest = 0;
    for (const double w : want) greatest = std::max(greatest, std::abs(w));
    for (std::size_t k = 0; k < want.size(); ++k)
      EXPECT_NEAR(got[k], want[k], 1e-7 * std::max(1.0, std::abs(want[k])) + 1e-12 * greatest)
          << file << ": " << fmu.variables[unknowns[k]].name;
    // w · (J v) = (Jᵀ w) · v
    std::vector<double> weights, adjoint(knowns.size());
    for (std::size_t k = 0; k < unknowns.size(); ++k) weights.push_back(number(random));
    ASSERT_EQ(i.fmi.GetAdjointDerivative(i.c, unknowns.data(), unknowns.size(), knowns.data(), knowns.size(),
                                         weights.data(), weights.size(), adjoint.data(), adjoint.size()),
              fmi3OK);
    double left = 0, right = 0, scale = 0;
    for (std::size_t k = 0; k < unknowns.size(); ++k) left += weights[k] * got[k];
    for (std::size_t k = 0; k < knowns.size(); ++k) {
      right += adjoint[k] * seed[k];
      scale += std::abs(adjoint[k] * seed[k]);
    }
    EXPECT_NEAR(left, right, 1e-7 * scale);
  }
}

/// The rate of a filter of the cube of an acceleration u/m is 3 u² du, not the secant of a step as long as the input.
TEST(Derivatives, ByAnInputThatALawMeasuresInAnotherWayThanInProportionAreThoseAtItsValue) {
  const Unpacked& fmu = fmu_of_text("cube", R"(format: withy/1
bodies: {bar: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {s: {type: prismatic, axis: [1, 0, 0], parent: world, child: bar}}
outputs: {imu: {type: accelerometer, of: bar}}
loads:
  u: {type: input, hinge: s}
  cube: {type: expression, to: nothing, value: imu.x^3}
  lag: {type: transfer-function, of: cube, hinge: s, numerator: [0.1], denominator: [1, 1]}
)");
  Instance3 i(fmu, false);
  i.initialize();
  ASSERT_EQ(i.fmi.EnterContinuousTimeMode(i.c), fmi3OK);
  const std::uint32_t u = fmu.reference("u");
  for (const double value : {0.2, -1.5}) {
    ASSERT_EQ(i.set(u, value), fmi3OK) << i.heard.last;
    EXPECT_NEAR(i.get(fmu.reference("der(lag.x0)")), std::pow(value, 3), 1e-12);
    EXPECT_NEAR(slope_by(i, fmu.reference("der(lag.x0)"), u), 3 * value * value, 1e-10);
    // What is affine has no error but rounding.
    EXPECT_NEAR(slope_by(i, fmu.reference("der(s.rate)"), u), 1, 1e-14);
  }
}

/// A force of 10 N along a body of 1 kg, from t = 1 s on, turns with it: across, the acceleration is 10 times the
/// angle.
TEST(Derivatives, AtAJumpThatHasNotBeenDealtWithAreThoseBeforeIt) {
  const Unpacked& fmu = fmu_of_text("follower", R"(format: withy/1
bodies: {m: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {p: {type: planar, parent: world, child: m}}
loads: {f: {type: force, frame: m, following: true, law: steps, table: [[0, 0, 0, 0], [1, 10, 0, 0]]}}
)");
  Instance3 i(fmu, false);
  i.initialize();
  ASSERT_EQ(i.fmi.EnterContinuousTimeMode(i.c), fmi3OK);
  ASSERT_EQ(i.fmi.SetTime(i.c, 1), fmi3OK);
  const std::uint32_t across = fmu.reference("der(p.rate.2)"), angle = fmu.reference("p.0");
  EXPECT_EQ(i.get(fmu.reference("der(p.rate.1)")), 0);
  EXPECT_EQ(slope_by(i, across, angle), 0);
  ASSERT_EQ(i.fmi.EnterEventMode(i.c), fmi3OK);
  fmi3Boolean again = false, over = false, nominals = false, values = false, timed = false;
  fmi3Float64 next = 0;
  ASSERT_EQ(i.fmi.UpdateDiscreteStates(i.c, &again, &over, &nominals, &values, &timed, &next), fmi3OK);
  ASSERT_EQ(i.fmi.EnterContinuousTimeMode(i.c), fmi3OK);
  EXPECT_NEAR(i.get(fmu.reference("der(p.rate.1)")), 10, 1e-12);
  EXPECT_NEAR(slope_by(i, across, angle), 10, 1e-12);
}

/// A bar of 1 + 0.3² kg m² about its hinge, of a spring of 3 N m/rad.
TEST(Outputs, ThatAreNotFiniteAreDiscardedByThemselves) {
  const Unpacked& fmu = fmu_of_text("root", R"(format: withy/1
bodies: {bar: {type: rigid, mass: 1, center_of_mass: [0.3, 0, 0], inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: bar}}
loads: {s: {type: hinge-spring, hinge: h, stiffness: 3}}
outputs:
  g: {type: gyro, of: bar}
  ratio: {type: expression, value: sqrt(g.z - 0.1)}
  inverse: {type: expression, value: 1 / g.z}
)");
  Instance3 i(fmu, false);
  i.initialize();
  ASSERT_EQ(i.fmi.EnterContinuousTimeMode(i.c), fmi3OK);
  const double y[] = {0.5, 0.05};
  ASSERT_EQ(i.fmi.SetContinuousStates(i.c, y, 2), fmi3OK);
  const std::uint32_t ratio = fmu.reference("ratio");
  double got = 0;
  EXPECT_EQ(i.fmi.GetFloat64(i.c, &ratio, 1, &got, 1), fmi3Discard);
  EXPECT_THAT(i.heard.last, testing::HasSubstr("output 'ratio' is not finite"));
  EXPECT_NEAR(i.get(fmu.reference("kinetic_energy")), 0.5 * 1.09 * 0.05 * 0.05, 1e-15);
  EXPECT_NEAR(i.get(fmu.reference("inverse")), 20, 1e-12);
  EXPECT_NEAR(i.get(fmu.reference("der(h.rate)")), -1.5 / 1.09, 1e-14);
}

/// Closed loops have no Jacobian: the description offers none, and a host that asks all the same is told why.
TEST(Derivatives, OfClosedLoopsAreRefusedForWhatClosesThem) {
  host::Scene scene = host::Scene::read(library(), SCENES "/gallery/four-bar.yaml");
  const std::filesystem::path out = scratch() / "closed.fmu";
  static_cast<void>(fmi::export_fmu(*scene.prepare(), {}, library().registry(), {3, false, true, out}));
  const Unpacked fmu = unpack(out, 3);
  EXPECT_EQ(attributes_of(fmu.xml.get_child("CoSimulation")).count("providesDirectionalDerivatives"), 0U);
  Instance3 i(fmu, true);
  i.initialize();
  const std::uint32_t unknown = fmu.derivatives.at(0), known = fmu.states.at(0);
  const double along = 1;
  double got = 0;
  EXPECT_EQ(i.fmi.GetDirectionalDerivative(i.c, &unknown, 1, &known, 1, &along, 1, &got, 1), fmi3Error);
  EXPECT_THAT(i.heard.last, testing::HasSubstr("constraints close loops"));
}

}  // namespace withy::test
