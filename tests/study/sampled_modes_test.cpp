// Modes and steady states of bodies together with sampled controllers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "withy/study/effective_mass.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/run.hpp"
#include "withy/study/variation_text.hpp"
#include "withy/tests/study/linear_scenes.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;
using Complex = std::complex<double>;

/// A table of 0.2 kg m² with a proportional controller of 5 N m/rad.
const std::string digital_table = R"(
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads: {servo: {type: pid, hinge: axle, proportional: 5, sample: 0.02}}
)";
constexpr double table_inertia = 0.2, table_gain = 5, table_sample = 0.02;

/// A cantilever in gravity whose root a controller with an integral holds.
const std::string digital_beam = R"(
gravity: [0, 0, -9.81]
bodies:
  beam: {type: beam, length: 2, mass_per_length: 1, damping_ratio: 0.02, bending_z: {stiffness: 200, modes: 3}}
hinges: {root: {type: revolute, axis: [0, 1, 0], parent: world, child: beam}}
loads: {servo: {type: pid, hinge: root, proportional: 150, integral: 200, derivative: 30, filter: 0.02, reference: 0.3, sample: 0.005}}
)";

/// θ, ω over T with the torque u held.
Eigen::Matrix<double, 2, 3> over(double T) {
  Eigen::Matrix<double, 2, 3> step;
  step << 1, T, T * T / (2 * table_inertia), 0, 1, T / table_inertia;
  return step;
}

/// e^{λT} of all modes, those of conjugates too.
std::vector<Complex> multipliers(const ModesAt& at) {
  std::vector<Complex> all;
  for (const Mode& m : at.modes) {
    all.push_back(std::exp(m.eigenvalue * at.period));
    if (!m.single) all.push_back(std::exp(m.partner * at.period));
  }
  return all;
}

/// That these are the eigenvalues of a matrix but for those at zero.
void expect_eigenvalues(std::vector<Complex> found, const Eigen::MatrixXd& map, double error) {
  const Eigen::VectorXcd expected = map.eigenvalues();
  ASSERT_EQ(static_cast<Eigen::Index>(found.size()), (expected.array().abs() > 1e-7).count());
  for (const Complex& e : expected) {
    if (std::abs(e) < 1e-7) continue;
    const auto nearest =
        std::min_element(found.begin(), found.end(), [&](auto a, auto b) { return std::abs(a - e) < std::abs(b - e); });
    ASSERT_NE(nearest, found.end());
    EXPECT_LE(std::abs(*nearest - e), error) << e;
    found.erase(nearest);
  }
}

ModesAt modes_of(const std::string& text, const std::vector<std::string>& changes = {}) {
  return modes_at(at_start(scene_of(text, changes)), false);
}

TEST(SampledModes, AreThoseOfTheMapByHand) {
  const ModesAt at = modes_of(digital_table);
  ASSERT_EQ(at.problem, "");
  EXPECT_EQ(at.period, table_sample);
  Eigen::Matrix2d map = over(table_sample).leftCols<2>();
  map.col(0) -= table_gain * over(table_sample).col(2);
  expect_eigenvalues(multipliers(at), map, 1e-12);
  // Half a sample late: it grows, although in continuous time it would not decay.
  ASSERT_EQ(at.modes.size(), 1U);
  EXPECT_EQ(behaviour(at, at.modes[0]), "flutters");
  EXPECT_EQ(dominating(at, at.modes[0]), "axle.0");
  EXPECT_NEAR(at.modes[0].growth(), table_gain / table_inertia * table_sample / 4, 0.01 * at.modes[0].growth());
}

/// What a controller holds may be of any size: here it is told thousand million times what it measures.
TEST(SampledModes, DoNotDependOnUnitsOfWhatIsHeld) {
  const ModesAt at =
      modes_of(digital_table, {"loads={large: {type: expression, value: 1.0e+9 * axle, to: nothing, sample: 0.02}, "
                               "servo: {type: pid, of: large, hinge: axle, proportional: 5.0e-9, sample: 0.02}}"});
  ASSERT_EQ(at.problem, "");
  Eigen::Matrix2d map = over(table_sample).leftCols<2>();
  map.col(0) -= table_gain * over(table_sample).col(2);
  expect_eigenvalues(multipliers(at), map, 1e-12);
  EXPECT_EQ(dominating(at, at.modes[0]), "axle.0");
}

TEST(SampledModes, OfADelayedControllerHaveWhatIsOnItsWay) {
  const ModesAt at = modes_of(digital_table, {"loads.servo.delay=0.02"});
  ASSERT_EQ(at.problem, "");
  // θ, ω and what was commanded a sample ago.
  Eigen::Matrix3d map = Eigen::Matrix3d::Zero();
  map.topRows(2) = over(table_sample);
  map.row(2) << -table_gain, 0, 0;
  // The command that acts in a period is that of a sample before.
  expect_eigenvalues(multipliers(at), map, 1e-12);
}

/// A controller with a delay that begins between two samples waits for the next; small motions are about one that acts,
/// whatever the time of the state: 8.3333 on, its own instants go on as those of a multiple.
TEST(SampledModes, OfADelayedControllerAreTheSameBetweenSamples) {
  // θ, ω and what was commanded two samples ago and one.
  Eigen::Matrix4d map = Eigen::Matrix4d::Zero();
  map.topLeftCorner<2, 3>() = over(table_sample);
  map(2, 3) = 1;
  map(3, 0) = -table_gain;
  for (const std::string time : {"0", "0.005", "0.02", "8.3333"}) {
    SCOPED_TRACE(time);
    const std::vector<std::string> changes = {"loads.servo.delay=0.04", "loads.servo.reference=0.4",
                                              "initial={time: " + time + "}", "time={end: 10}"};
    const Configuration c = at_start(scene_of(digital_table, changes));
    const ModesAt at = modes_at(c, false);
    ASSERT_EQ(at.problem, "");
    expect_eigenvalues(multipliers(at), map, 1e-12);
    EXPECT_NEAR(at.steady->steady.state.y[0], 0.4, 1e-12) << "at rest it stands where its reference is";
    EXPECT_FALSE(linear_model(c, {{"axle"}, {}}).equilibrium);
  }
}

/// Two controllers, one of them at every second sample of the other.
TEST(SampledModes, OfSeveralPeriodsAreThoseOfTheCommonOne) {
  const ModesAt at = modes_of(digital_table, {"loads.slow={type: pid, hinge: axle, proportional: 2, sample: 0.04}"});
  ASSERT_EQ(at.problem, "");
  EXPECT_EQ(at.period, 2 * table_sample);
  // θ, ω, and what the slow one commands.
  Eigen::Matrix3d first = Eigen::Matrix3d::Zero(), second = first;
  second.topLeftCorner<2, 2>() = over(table_sample).leftCols<2>();
  second.topRightCorner<2, 1>() = over(table_sample).col(2);
  second.col(0).head<2>() -= table_gain * over(table_sample).col(2);
  second(2, 2) = 1;
  Eigen::Matrix3d renewed = Eigen::Matrix3d::Identity();
  renewed.row(2) << -2, 0, 0;
  first = second * renewed;
  expect_eigenvalues(multipliers(at), second * first, 1e-12);
}

/// Two periods that differ in their seventh digit are told apart where they have no common multiple.
TEST(SampledModes, WithoutACommonPeriodNamePeriodsThatDiffer) {
  try {
    modes_of(digital_table, {"loads.slow={type: pid, hinge: axle, proportional: 2, sample: 0.02000001}"});
    ADD_FAILURE() << "found";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("0.02 s to 0.02000001 s, have no common multiple"));
  }
}

/// A multiplier tells frequencies up to half the rate of samples. What vibrates faster is known by how it moves between
/// them: a controller that hardly does anything leaves all as it is without.
TEST(SampledModes, KnowVibrationsFasterThanTheSamples) {
  for (const char* sample : {"0.1", "0.031", "0.003"}) {
    const ModesAt with =
        modes_of(digital_beam,
                 {"loads={servo: {type: pid, hinge: root, proportional: 1.0e-6, sample: " + std::string(sample) + "}}",
                  "gravity=null"});
    const ModesAt without = modes_of(digital_beam, {"loads={}", "gravity=null"});
    ASSERT_EQ(with.problem, "");
    for (const Mode& m : without.modes) {
      if (m.rigid) continue;
      // In a tenth of a second this one is forgotten.
      if (m.growth() < -190 && sample == std::string("0.1")) continue;
      const double nearest = std::abs(std::min_element(with.modes.begin(), with.modes.end(),
                                                       [&](const Mode& a, const Mode& b) {
                                                         return std::abs(a.eigenvalue - m.eigenvalue) <
                                                                std::abs(b.eigenvalue - m.eigenvalue);
                                                       })
                                          ->eigenvalue -
                                      m.eigenvalue);
      EXPECT_LE(nearest, 1e-6 * m.frequency()) << sample << ' ' << m.eigenvalue;
    }
    EXPECT_EQ(with.forgotten, sample == std::string("0.1") ? 4U : 2U) << "that it has begun, and its command";
    EXPECT_GT(without.modes.back().frequency(), 5 * std::numbers::pi / 0.031);
  }
}

/// With shorter samples they come to those of the continuous controller, and the difference is the sample's.
TEST(SampledModes, ComeToThoseOfTheContinuousController) {
  const ModesAt continuous = modes_of(digital_beam, {"loads.servo.sample=null"});
  const auto difference = [&](const std::string& sample) {
    const ModesAt at = modes_of(digital_beam, {"loads.servo.sample=" + sample});
    double most = 0;
    for (const Mode& m : continuous.modes) {
      double nearest = 1;
      for (const Mode& other : at.modes)
        nearest = std::min(nearest, std::abs(other.eigenvalue - m.eigenvalue) / std::abs(m.eigenvalue));
      most = std::max(most, nearest);
    }
    return most;
  };
  const double coarse = difference("4.0e-4"), fine = difference("2.0e-4");
  EXPECT_LT(fine, 0.1);
  EXPECT_NEAR(coarse / fine, 2, 0.2);
}

/// A brake that is stronger than what it measures: ω of one sample is −ω/2 at the next.
TEST(SampledModes, AlternateWhereAMultiplierIsNegative) {
  for (const auto& [derivative, multiplier, name] :
       {std::tuple{"15", -0.5, "alternates"}, {"25", -1.5, "flutters"}, {"5", 0.5, "decays"}}) {
    const ModesAt at =
        modes_of(digital_table,
                 {"loads.servo={type: pid, hinge: axle, sample: 0.02, derivative: " + std::string(derivative) + "}"});
    ASSERT_EQ(at.problem, "");
    const Mode& m = *std::find_if(at.modes.begin(), at.modes.end(), [](const Mode& mode) { return !mode.rigid; });
    EXPECT_EQ(behaviour(at, m), name);
    EXPECT_TRUE(m.single);
    EXPECT_NEAR(std::exp(m.eigenvalue * table_sample).real(), multiplier, 1e-12);
    EXPECT_NEAR(m.eigenvalue.imag(), multiplier < 0 ? std::numbers::pi / table_sample : 0, 1e-12);
  }
}

/// What nothing holds stays a rigid motion, and the sum of an error that is none is one too.
TEST(SampledModes, KeepRigidMotions) {
  const ModesAt at = modes_at(at_start(scene_of(R"(
bodies:
  bus: {type: rigid, mass: 4, inertia: [3, 4, 5, 0, 0, 0]}
  panel: {type: beam, length: 3, mass_per_length: 0.5, bending_y: {stiffness: 20, modes: 2}}
hinges:
  float: {type: free, parent: world, child: bus}
  drive: {type: revolute, axis: [0, 0, 1], parent: bus, child: panel}
loads: {hold: {type: pid, hinge: drive, proportional: 4, derivative: 2, filter: 0.1, sample: 0.002}}
)")),
                              true);
  ASSERT_EQ(at.problem, "");
  std::size_t pairs = 0;
  for (const Mode& m : at.modes) pairs += m.rigid && !m.single ? 1 : 0;
  EXPECT_EQ(pairs, 6U) << "of the free bus";
  for (const Mode& m : at.modes) EXPECT_LE(resolved_growth(at, m), 0);
}

/// Time integration knows samples by its clocks: long after a displacement the motion is that of the leading mode from
/// one sample to the next, whether it decays or grows.
TEST(SampledModes, AreSeenInARun) {
  struct Case {
    std::vector<std::string> changes;
    int samples;
    double displaced;  ///< of what the controller holds of its integral [N m]
  };
  for (const Case& run : {Case{{"loads.servo.integral=20", "loads.servo.sample=0.002"}, 2500, 1e-3},
                          Case{{"loads.servo.sample=0.005"}, 28, 1e-10}}) {
    Prepared prepared = scene_of(digital_beam, run.changes);
    const ModesAt at = modes_at(at_start(prepared), false);
    ASSERT_EQ(at.problem, "");
    const Mode& leading = *std::max_element(at.modes.begin(), at.modes.end(),
                                            [](const Mode& a, const Mode& b) { return a.growth() < b.growth(); });
    ASSERT_TRUE(leading.single);
    SceneValues values = prepared.values;
    values.set_text("integrator={name: dop853, rtol: 1e-12, atol: 1e-16}");
    values.set_text("time={end: " + std::to_string(run.samples * at.period) + ", output: " + std::to_string(at.period) +
                    "}");
    prepared = prepare(std::move(values), plugins());
    State& start = prepared.scene.initial = at.steady->steady.state;
    start.y[sampled_slots(prepared.model()).front().first + 1] += run.displaced;
    std::vector<double> angles;
    const auto note = [&](const State& s) { angles.push_back(s.y[0] - at.steady->steady.state.y[0]); };
    simulate(prepared, plugins(), note, {});
    ASSERT_GE(angles.size(), 3U);
    const double multiplier = std::exp(leading.eigenvalue * at.period).real();
    EXPECT_NEAR(angles.back() / angles[angles.size() - 2], multiplier, 1e-6 * std::abs(multiplier)) << angles.size();
  }
}

/// A newton metre of the integral is nothing beside the vibrations, and is found all the same.
TEST(SampledEquilibrium, IsFoundWhateverTheSizesAre) {
  const Configuration c = at_start(scene_of(heavy_hub, {"loads.servo.sample=0.01"}));
  const Equilibrium found = find_equilibrium(c, {}, plugins());
  ASSERT_EQ(found.problem, "");
  const LoadSlot servo = sampled_slots(c.prepared().model()).front();
  EXPECT_NEAR(std::abs(found.steady.state.y[servo.first + servo.count - 1]), 9.81 * 2 * 1, 1e-6);
}

/// Samples do not change where an integral comes to rest.
TEST(SampledEquilibrium, IsThatOfTheContinuousController) {
  const Configuration sampled = at_start(scene_of(digital_beam));
  const Configuration continuous = at_start(scene_of(digital_beam, {"loads.servo.sample=null"}));
  const Equilibrium found = find_equilibrium(sampled, {}, plugins()),
                    other = find_equilibrium(continuous, {}, plugins());
  ASSERT_EQ(found.problem, "");
  ASSERT_EQ(other.problem, "");
  for (std::size_t i = 0; i < sampled.layout().positions; ++i)
    EXPECT_NEAR(found.steady.state.y[i], other.steady.state.y[i], 1e-12) << i;
  EXPECT_EQ(found.deflections.size(), 1U);
  EXPECT_LT(found.steady.renewed.cwiseAbs().maxCoeff(), 1e-9);
}

/// A run that begins there stays there, sample after sample.
TEST(SampledEquilibrium, IsWhereARunStays) {
  Prepared prepared = scene_of(digital_beam, {"loads.servo.sample=0.002"});
  const Equilibrium found = find_equilibrium(at_start(prepared), {}, plugins());
  ASSERT_EQ(found.problem, "");
  prepared.scene.initial = found.steady.state;
  State last;
  simulate(prepared, plugins(), [&](const State& s) { last = s; }, {});
  EXPECT_EQ(last.time, 1);
  const Layout& layout = prepared.model().layout();
  for (std::size_t i = 0; i < layout.positions; ++i) EXPECT_NEAR(last.y[i], found.steady.state.y[i], 1e-12) << i;
}

/// Linear models call an equilibrium what the search for one does: where a run has come to rest, what a sample still
/// changes is rounding, however small that is which the controller holds.
TEST(SampledEquilibrium, IsOneForLinearModelsToo) {
  Prepared prepared = scene_of(R"(bodies: {bus: {type: rigid, mass: 10, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: bus}}
loads: {servo: {type: pid, hinge: axle, proportional: 4, derivative: 3, reference: 0.5, sample: 0.1}}
)",
                               {"time={end: 30, output: 30}"});
  EXPECT_FALSE(linear_model(at_start(prepared), {{"axle"}, {}}).equilibrium);
  State last;
  simulate(prepared, plugins(), [&](const State& s) { last = s; }, {});
  const Equilibrium found = find_equilibrium({prepared, last, {}}, {}, plugins());
  ASSERT_EQ(found.problem, "");
  EXPECT_TRUE(linear_model({prepared, found.steady.state, {}}, {{"axle"}, {}}).equilibrium);
}

TEST(SampledEquilibrium, SaysWhatGoesOnChanging) {
  const Prepared prepared = scene_of(digital_beam);
  const Configuration locked(prepared, prepared.scene.initial, {{"root"}, {}});
  const Equilibrium found = find_equilibrium(locked, {{"root"}, {}}, plugins());
  // 200 N m/(rad s) times 0.3 rad times 5 ms.
  EXPECT_THAT(found.problem, HasSubstr("changes by 0.3 with a sample"));
}

TEST(SampledEquilibrium, IsNotSoughtWhereNumbersAreDrawn) {
  const std::string noise = "loads.noisy={type: noise, of: root, deviation: 0.01, sample: 0.005}";
  const Configuration drawn = at_start(scene_of(digital_beam, {noise, "loads.servo.of=noisy"}));
  try {
    (void)find_equilibrium(drawn, {}, plugins());
    ADD_FAILURE() << "found";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("--set loads.noisy.deviation=0"));
  }
  const Configuration none =
      at_start(scene_of(digital_beam, {noise, "loads.servo.of=noisy", "loads.noisy.deviation=0"}));
  EXPECT_EQ(find_equilibrium(none, {}, plugins()).problem, "");
}

/// Branches of a sweep over the sample itself: the beam begins to grow within it.
TEST(SampledModes, AreFollowedOverTheirSample) {
  const Sweep sweep = parse_sweep("loads.servo.sample=0.001:0.02:20", "sweep");
  const Prepared prepared = scene_of(digital_beam);
  const ModesOf run = sweep_modes(prepared.values, plugins(), {}, {}, sweep, false, {}, {});
  ASSERT_EQ(run.points.size(), 20U);
  for (const ModesAt& at : run.points) EXPECT_EQ(at.problem, "") << at.value;
  const auto grows = [](const ModesAt& at) {
    return std::any_of(at.modes.begin(), at.modes.end(), [&](const Mode& m) { return unstable(at, m); });
  };
  EXPECT_FALSE(grows(run.points.front()));
  EXPECT_TRUE(grows(run.points.back()));
}

TEST(SampledModes, AreRefusedWhereTimeIsContinuous) {
  const Configuration c = at_start(scene_of(digital_beam));
  TurningWish wish;
  wish.floquet = true;
  EXPECT_THROW((void)modes_at(c, false, wish), InputError);
  EXPECT_THROW((void)effective_masses(c), InputError);
}

}  // namespace
}  // namespace withy::study
