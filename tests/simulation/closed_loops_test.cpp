/// \file
/// Closed loops: against a solution in the one coordinate of a four-bar linkage, against trees that move the same, and
/// by what constraint forces may not do.
#include "withy/core/plugin/closed_loops.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>

#include "four_bar.hpp"
#include "made_scene.hpp"
#include "withy/core/simulation/changing_equations.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {
namespace {

using Vector = std::vector<double>;

const ClosedLoops& loops_of(const EquationsOfMotion& equations) { return dynamic_cast<const ClosedLoops&>(equations); }

RunSummary run(const Made& made, double end, const std::function<void(const State&)>& output = {},
               RunOptions options = {}) {
  options.end = end;
  options.output = end / 20;
  return simulate(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, options, output);
}

Vector read_sensors(const Made& made, const State& state) {
  SensorReader reader(made.scene.outputs, *made.equations);
  Vector values(reader.columns().size());
  EXPECT_TRUE(reader.read(state, values));
  return values;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("no '" + from + "'");
  return text.replace(at, from.size(), to);
}

TEST(ClosedLoops, AFourBarLinkageMovesAsInTheAngleOfItsCrank) {
  const auto [angle, rate] = Linkage::at(1.0);
  for (const char* integrator : {"{name: dopri5, rtol: 1e-11, atol: 1e-12}", "{name: dop853, rtol: 1e-11, atol: 1e-12}",
                                 "{name: radau, rtol: 1e-10, atol: 1e-11}", "{name: gauss, step: 0.001}"}) {
    const Made made(four_bar(rigid_coupler, integrator));
    const RunSummary summary = run(made, 1.0);
    EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
    const Layout& layout = made.scene.model->layout();
    EXPECT_NEAR(summary.final.y[layout.hinge("motor")->position], angle, 2e-9) << integrator;
    EXPECT_NEAR(summary.final.y[layout.positions + layout.hinge("motor")->speed], rate, 2e-8) << integrator;
    EXPECT_NEAR(summary.final.y[layout.hinge("pivot")->position], Linkage::place(angle).rocker, 2e-9) << integrator;
    EXPECT_LT(summary.energy_drift, 1e-8) << integrator;
    Work work = made.equations->make_work();
    Vector y = summary.final.y;
    EXPECT_LT(loops_of(*made.equations).close(y, work).gap, 1e-14) << integrator;
  }
}

TEST(ClosedLoops, ErrorsOfAFlexibleLinkageFallWithTheOrderOfTheIntegrator) {
  const auto end = [](const std::string& integrator) {
    const Made made(four_bar(beam_coupler, integrator));
    const RunSummary summary = run(made, 0.5);
    EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
    return summary.final.y;
  };
  const Vector exact = end("{name: dop853, rtol: 1e-12, atol: 1e-13}");
  double last = 0;
  for (const double step : {2e-3, 1e-3, 5e-4}) {
    const Vector y = end("{name: rk4, step: " + std::to_string(step) + "}");
    double error = 0;
    for (std::size_t i = 0; i + 1 < y.size(); ++i) error = std::max(error, std::abs(y[i] - exact[i]));
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 4, 0.4);
    }
    last = error;
  }
}

TEST(ClosedLoops, EnergyIsConservedInAllFormulationsThatConserveItInTrees) {
  for (const char* formulation : {"quadratic", "exact"}) {
    const std::string text = replaced(four_bar(clamped_coupler, "{name: dop853, rtol: 1e-10, atol: 1e-12}"),
                                      "law: constant, value: 1.5", "law: constant, value: 0");
    const Made made(text, formulation);
    const RunSummary summary = run(made, 1.0);
    EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
    EXPECT_LT(summary.energy_drift, 1e-7) << formulation;
  }
}

TEST(ClosedLoops, TheLinkageOfTheGalleryTurnsAsItsPageSays) {
  std::ifstream file(WITHY_SOURCE_DIRECTORY "/scenes/gallery/four-bar.yaml");
  std::stringstream text;
  text << file.rdbuf();
  const Made made(text.str());
  Work work = made.equations->make_work();
  const auto counts = loops_of(*made.equations).counts(made.scene.initial.y, work);
  ASSERT_EQ(counts.size(), 1U);
  EXPECT_EQ(counts[0].equations, 5U);
  EXPECT_EQ(counts[0].independent, 2U);
  const RunSummary summary = run(made, made.scene.end.value_or(0));
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
  EXPECT_EQ(summary.reached, 4);
  EXPECT_LT(summary.energy_drift, 1e-5);
  for (const double value : read_sensors(made, summary.final)) EXPECT_TRUE(std::isfinite(value));
}

// Seven bodies, three loops at one point, no gravity, a spring. Data and the solution at 30 ms: Mazzia & Magherini,
// "Test Set for Initial Value Problem Solvers", release 2.4, II-10; after Hairer & Wanner II, VII.7.
constexpr const char* andrews_squeezer = R"(format: withy/1
time: {end: 0.03}
integrator: {name: dop853, rtol: 1e-12, atol: 1e-13}
bodies:
  k1: {type: rigid, mass: 0.04325, center_of_mass: [0.00092, 0, 0], inertia: [2.194e-6, 2.194e-6, 2.194e-6, 0, 0, 0], frames: {end: {position: [0.007, 0, 0]}}}
  k2: {type: rigid, mass: 0.00365, center_of_mass: [-0.0115, 0, 0], inertia: [4.410e-7, 4.410e-7, 4.410e-7, 0, 0, 0], frames: {end: {position: [-0.028, 0, 0]}}}
  k3: {type: rigid, mass: 0.02373, center_of_mass: [0.01043, -0.01874, 0], inertia: [5.255e-6, 5.255e-6, 5.255e-6, 0, 0, 0], frames: {end: {position: [0, -0.035, 0]}, eye: {position: [0.02, -0.018, 0]}}}
  k4: {type: rigid, mass: 0.00706, center_of_mass: [0, -0.00579, 0], inertia: [5.667e-7, 5.667e-7, 5.667e-7, 0, 0, 0], frames: {end: {position: [0, -0.02, 0]}}}
  k5: {type: rigid, mass: 0.07050, center_of_mass: [0.02308, 0.00916, 0], inertia: [1.169e-5, 1.169e-5, 1.169e-5, 0, 0, 0], frames: {end: {position: [0.04, 0, 0]}}}
  k6: {type: rigid, mass: 0.00706, center_of_mass: [0.00579, 0, 0], inertia: [5.667e-7, 5.667e-7, 5.667e-7, 0, 0, 0], frames: {end: {position: [0.02, 0, 0]}}}
  k7: {type: rigid, mass: 0.05498, center_of_mass: [-0.00449, -0.01228, 0], inertia: [1.912e-5, 1.912e-5, 1.912e-5, 0, 0, 0], frames: {end: {position: [0, -0.04, 0]}}}
hinges:
  beta: {type: revolute, axis: [0, 0, 1], parent: world, child: k1}
  theta: {type: revolute, axis: [0, 0, 1], parent: k1.end, child: k2}
  gamma: {type: revolute, axis: [0, 0, 1], parent: world, child: k3, offset: {position: [-0.03635, 0.03273, 0]}}
  delta: {type: revolute, axis: [0, 0, 1], parent: world, child: k5, offset: {position: [-0.06934, -0.00227, 0]}}
  phi: {type: revolute, axis: [0, 0, 1], parent: k5.end, child: k4}
  epsilon: {type: revolute, axis: [0, 0, 1], parent: world, child: k7, offset: {position: [-0.06934, -0.00227, 0]}}
  omega: {type: revolute, axis: [0, 0, 1], parent: k7.end, child: k6}
constraints:
  third: {type: hinge, hinge: spherical, a: k3.end, b: k2.end}
  fourth: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: k4.end, b: k2.end}
  sixth: {type: hinge, hinge: cylindrical, axis: [0, 0, 1], a: k6.end, b: k2.end}
loads:
  drive: {type: hinge-effort, hinge: beta, law: constant, value: 0.033}
  spring: {type: spring-damper, frame: k3.eye, anchor: [0.014, 0.072, 0], stiffness: 4530, free_length: 0.07785}
initial:
  hinges:
    beta: {position: [-0.0617138900142764496]}
    gamma: {position: [0.455279819163070380]}
  guess: {hinges: {phi: {position: [0.22]}, delta: {position: [0.48]}, omega: {position: [-0.22]}, epsilon: {position: [1.2]}}}
)";

TEST(ClosedLoops, AndrewsSqueezerIsWhereItsPublishedSolutionHasIt) {
  const Made made(andrews_squeezer);
  const RunSummary summary = run(made, 0.03);
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
  const std::pair<const char*, double> published[] = {
      {"beta", 0.1581077119629904e2},   {"theta", -0.1575637105984298e2}, {"gamma", 0.4082224013073101e-1},
      {"phi", -0.5347301163226948},     {"delta", 0.5244099658805304},    {"omega", 0.5347301163226948},
      {"epsilon", 0.1048080741042263e1}};
  for (const auto& [hinge, angle] : published)
    EXPECT_NEAR(summary.final.y[made.scene.model->layout().hinge(hinge)->position], angle, 1e-8 * (1 + std::abs(angle)))
        << hinge;
  EXPECT_LT(summary.energy_drift, 1e-9);
}

/// Two bodies: one on a revolute hinge and flexible, the other on its tip by the hinge under test. `cut`: the second
/// body floats freely, and a constraint is that hinge.
std::string joined(const std::string& hinge, const std::string& position, const std::string& rate, bool cut) {
  const std::string first = R"(format: withy/1
gravity: [0.3, -9.81, 0.5]
time: {end: 1}
integrator: {name: dop853, rtol: 1e-12, atol: 1e-12}
bodies:
  arm: {type: beam, length: 0.9, mass_per_length: 1.3, bending_y: {stiffness: 60, modes: 2, family: clamped-free}, bending_z: {stiffness: 90, modes: 1, family: clamped-free}}
  load: {type: rigid, mass: 0.8, center_of_mass: [0.1, -0.2, 0.15], inertia: [0.02, 0.03, 0.025, 0.001, 0, 0], frames: {grip: {position: [0.05, 0.02, 0], orientation: {axis: [1, 2, 0], angle: 0.3}}}}
hinges:
  shoulder: {type: revolute, axis: [0, 0.2, 1], parent: world, child: arm}
)";
  const std::string offset = "offset: {position: [0.02, 0, 0.01], orientation: {axis: [0, 1, 1], angle: 0.4}}";
  const std::string outputs = R"(
outputs:
  place: {type: frame, of: load, in: world}
  base: {type: reaction, hinge: shoulder}
  middle: {type: section, of: arm, at: 0.5}
)";
  if (!cut)
    return first + "  wrist: {" + hinge + ", parent: arm.tip, child: load.grip, " + offset + "}\n" +
           "initial: {hinges: {shoulder: {rate: [2]}" +
           (position.empty() ? "" : ", wrist: {position: " + position + ", rate: " + rate + "}") + "}}" + outputs +
           "  wrist_load: {type: reaction, hinge: wrist}\n";
  return first + "  wrist: {type: free, parent: world, child: load}\n" + "constraints:\n  grip: {" +
         replaced(hinge, "type: ", "type: hinge, hinge: ") + ", a: arm.tip, b: load.grip, " + offset + "}\n" + outputs +
         "  wrist_load: {type: reaction, constraint: grip}\n";
}

struct Joint {
  const char* hinge;
  const char* position;
  const char* rate;
  std::size_t freedoms;
};
void PrintTo(const Joint& joint, std::ostream* out) { *out << joint.hinge; }

class Joints : public testing::TestWithParam<Joint> {};

// The state of the cut one is that of the tree: pose and twist of the free body, read by its sensor.
TEST_P(Joints, AConstraintMovesAndBearsAsTheHingeInATree) {
  const Joint& joint = GetParam();
  const Made tree(joined(joint.hinge, joint.position, joint.rate, false));
  Made cut(joined(joint.hinge, joint.position, joint.rate, true));
  const Layout &layout = tree.scene.model->layout(), &there = cut.scene.model->layout();
  const State& from = tree.scene.initial;
  State& to = cut.scene.initial;
  const auto copy = [&](const Slot& a, const Slot& b) {
    std::copy_n(&from.y[a.position], a.positions, &to.y[b.position]);
    std::copy_n(&from.y[layout.positions + a.speed], a.speeds, &to.y[there.positions + b.speed]);
  };
  copy(*layout.hinge("shoulder"), *there.hinge("shoulder"));
  copy(*layout.body("arm"), *there.body("arm"));
  const auto seen = tree.equations->make_observation();
  seen->observe(from.y);
  const int load = tree.scene.model->body("load");
  const WorldPose pose = seen->frame_pose(load, 0);
  const WorldVelocity velocity = seen->frame_velocity(load, 0);
  const Slot& free = *there.hinge("wrist");
  const Eigen::Quaterniond q(
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation.data()).eval());
  const Vector values = {q.w(), q.x(), q.y(), q.z(), pose.position[0], pose.position[1], pose.position[2]};
  std::copy(values.begin(), values.end(), &to.y[free.position]);
  std::copy(velocity.angular.begin(), velocity.angular.end(), &to.y[there.positions + free.speed]);
  std::copy(velocity.linear.begin(), velocity.linear.end(), &to.y[there.positions + free.speed + 3]);

  Work work = cut.equations->make_work();
  const ClosedLoops& loops = loops_of(*cut.equations);
  Vector closed = to.y;
  EXPECT_LT(loops.close(closed, work).gap, 1e-14);
  const std::vector<LoopCount> counts = loops.counts(to.y, work);
  ASSERT_EQ(counts.size(), 1U);
  EXPECT_EQ(counts[0].equations, 6 - joint.freedoms);
  EXPECT_EQ(counts[0].independent, 6 - joint.freedoms);
  const RunSummary a = run(tree, 1.0), b = run(cut, 1.0);
  EXPECT_EQ(b.status, RunStatus::completed) << b.message;
  const Vector of_tree = read_sensors(tree, a.final), of_cut = read_sensors(cut, b.final);
  ASSERT_EQ(of_tree.size(), of_cut.size());
  // Place and velocity, then accelerations, forces and moments.
  for (std::size_t i = 0; i < of_tree.size(); ++i)
    EXPECT_NEAR(of_cut[i], of_tree[i], i < 6 ? 2e-9 : 2e-8 * (1 + std::abs(of_tree[i]))) << i;
}

INSTANTIATE_TEST_SUITE_P(
    ClosedLoops, Joints,
    testing::Values(Joint{"type: weld", "", "", 0}, Joint{"type: revolute, axis: [1, 0.5, 0.2]", "[0.4]", "[3]", 1},
                    Joint{"type: prismatic, axis: [1, 0.5, 0.2]", "[0.1]", "[0.3]", 1},
                    Joint{"type: universal, first_axis: [1, 0, 0.2], second_axis: [0, 1, 0]", "[0.3, -0.5]", "[2, 1]",
                          2},
                    Joint{"type: cylindrical, axis: [0, 1, 0.2]", "[0.3, 0.05]", "[2, 0.4]", 2},
                    Joint{"type: planar, normal: [0, 0.1, 1]", "[0.3, 0.05, 0.02]", "[2, 0.1, -0.3]", 3},
                    Joint{"type: spherical", "{axis: [1, 1, 0], angle: 0.5}", "[1, 2, -1]", 3}));

TEST(ClosedLoops, RowsAreTheDerivativesOfGapsAndTheirForcesDoNoWork) {
  const Made made(joined("type: revolute, axis: [1, 0.5, 0.2]", "", "", true));
  const ClosedLoops& loops = loops_of(*made.equations);
  const Layout& layout = made.scene.model->layout();
  const std::size_t m = loops.closing_equations(), n = layout.speeds;
  Work work = made.equations->make_work();
  State state = made.scene.initial;
  for (std::size_t i = 0; i < layout.positions + n; ++i)
    state.y[i] += 0.2 * std::sin(1.0 + 3.0 * static_cast<double>(i));
  made.equations->normalize(state.y);
  Vector g(m), rates(m), J(m * n), slopes(made.equations->size());
  loops.see(state.y, g, rates, J, work);
  made.equations->position_rates(0, state.y, slopes, work);
  Vector product(m, 0.0);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t k = 0; k < n; ++k) product[i] += J[i * n + k] * state.y[layout.positions + k];
  const auto gaps_at = [&](double h) {
    State moved = state;
    for (std::size_t i = 0; i < layout.positions; ++i) moved.y[i] += h * slopes[i];
    made.equations->normalize(moved.y);
    Vector gaps(m), unused(m), rows(m * n);
    loops.see(moved.y, gaps, unused, rows, work);
    return gaps;
  };
  const Vector ahead = gaps_at(1e-5), behind = gaps_at(-1e-5);
  for (std::size_t i = 0; i < m; ++i) {
    EXPECT_NEAR(product[i], rates[i], 1e-14 * (1 + std::abs(rates[i])));  // Jᵀ is the transpose of u → ġ
    EXPECT_NEAR((ahead[i] - behind[i]) / 2e-5, rates[i], 1e-8);
  }
}

TEST(ClosedLoops, AFloatingLoopConservesItsMomenta) {
  const Made made(R"(format: withy/1
time: {end: 1}
integrator: {name: dop853, rtol: 1e-11, atol: 1e-12}
bodies:
  bus: {type: rigid, mass: 5, inertia: [0.3, 0.2, 0.25, 0, 0, 0], frames: {near: {position: [0.1, 0, 0]}, far: {position: [0.7, 0.1, 0]}}}
  left: {type: rigid, mass: 0.5, center_of_mass: [0.2, 0, 0], inertia: [0.001, 0.01, 0.01, 0, 0, 0], frames: {tip: {position: [0.6, 0, 0]}}}
  right: {type: beam, length: 0.6, mass_per_length: 1, bending_y: {stiffness: 30, modes: 2, family: clamped-free}}
hinges:
  float: {type: free, parent: world, child: bus}
  a: {type: spherical, parent: bus.near, child: left}
  b: {type: revolute, axis: [0, 0, 1], parent: bus.far, child: right}
constraints:
  ball: {type: hinge, hinge: spherical, a: left.tip, b: right.tip}
initial:
  hinges: {float: {rate: [1, 2, 3, 0.1, 0.2, 0.3]}}
  guess: {hinges: {a: {position: {axis: [0, 0, 1], angle: 1.1}}, b: {position: [2.2]}}}
)");
  const RunSummary summary = run(made, 1.0);
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
  ASSERT_TRUE(summary.momentum.conserved);
  EXPECT_LT(summary.momentum.linear, 1e-10);
  EXPECT_LT(summary.momentum.angular, 1e-10);
  EXPECT_LT(summary.energy_drift, 1e-8);
}

TEST(ClosedLoops, MotionsDriveLoopsAndTheirWorkIsBalanced) {
  std::string text = four_bar(beam_coupler, "{name: dop853, rtol: 1e-10, atol: 1e-12}");
  text = replaced(text, "loads:\n  torque: {type: hinge-effort, hinge: motor, law: constant, value: 1.5}\n",
                  "motions:\n  turn: {hinge: motor, type: constant-rate, rate: 6, from: 1.5}\n"
                  "outputs: {drive: {type: effort, hinge: motor}, base: {type: reaction, hinge: motor}}\n");
  text = replaced(text, "hinges: {motor: {position: [\"90 deg\"], rate: [6]}}", "hinges: {}");
  const Made made(text);
  const RunSummary summary = run(made, 1.0);
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
  EXPECT_LT(summary.energy_drift, 1e-7);
  const Vector values = read_sensors(made, summary.final);
  EXPECT_NEAR(values[0], values[6], 1e-9 * (1 + std::abs(values[0])));  // the drive is what the hinge bears about z
}

TEST(ClosedLoops, DependentEquationsAreCountedAndLeaveTheMotionAsItIs) {
  const std::string planar = four_bar(rigid_coupler, "{name: dopri5, rtol: 1e-10, atol: 1e-11}");
  const Made once(planar);
  // The same loop twice, by another hinge.
  const Made twice(replaced(
      planar,
      "loads:", "  again: {type: hinge, hinge: cylindrical, axis: [0, 0, 1], a: coupler.tip, b: rocker.pin}\nloads:"));
  Work work = twice.equations->make_work();
  const auto counts = loops_of(*twice.equations).counts(twice.scene.initial.y, work);
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_EQ(counts[0].equations, 5U);
  EXPECT_EQ(counts[0].independent, 2U);
  EXPECT_EQ(counts[1].equations, 4U);
  EXPECT_EQ(counts[1].independent, 0U);
  const RunSummary a = run(once, 0.5), b = run(twice, 0.5);
  for (std::size_t i = 0; i + 1 < a.final.y.size(); ++i) EXPECT_NEAR(a.final.y[i], b.final.y[i], 1e-10);
}

TEST(ClosedLoops, ARunStopsWhereLoopsCanMoveOnInTwoWays) {
  // A parallelogram, whose links come into one line.
  std::string text = four_bar(rigid_coupler, "{name: dopri5, rtol: 1e-8, atol: 1e-10}");
  text = replaced(text, "frames: {pin: {position: [0.8, 0, 0]}}", "frames: {pin: {position: [0.3, 0, 0]}}");
  text = replaced(text, "offset: {position: [0.9, 0, 0]}", "offset: {position: [1.0, 0, 0]}");
  text = replaced(text, "elbow: {position: [\"-60 deg\"]}, pivot: {position: [\"80 deg\"]}",
                  "elbow: {position: [\"-90 deg\"]}, pivot: {position: [\"90 deg\"]}");
  const Made made(text);
  const RunSummary summary = run(made, 1.0);
  EXPECT_EQ(summary.status, RunStatus::singular);
  EXPECT_THAT(summary.message, testing::HasSubstr("lose rank between"));
  EXPECT_LT(summary.final.time, 0.5);
}

TEST(ClosedLoops, RunsAreResumedBitByBitAndEvaluationsAllocateNothing) {
  const Made made(four_bar(beam_coupler, "{name: dopri5, rtol: 1e-7, atol: 1e-9}"));
  std::optional<Checkpoint> saved;
  int asked = 0;
  RunOptions options;
  options.checkpoint_due = [&] { return ++asked == 40; };
  options.checkpoint = [&](const Checkpoint& checkpoint) { saved = checkpoint; };
  const RunSummary whole = run(made, 1.0, {}, options);
  ASSERT_TRUE(saved.has_value());
  RunOptions rest;
  rest.resume = &*saved;
  const RunSummary resumed = run(made, 1.0, {}, rest);
  EXPECT_EQ(resumed.final.y, whole.final.y);
  EXPECT_EQ(resumed.message, whole.message);
  EXPECT_THAT(whole.message, testing::HasSubstr("Loops were closed after each step"));

  Vector y = whole.final.y, y_dot(y.size());
  Work work = made.equations->make_work();
  work.poison();
  const std::size_t before = allocations();
  ASSERT_TRUE(made.equations->derivatives(1, y, y_dot, work).ok());
  ASSERT_TRUE(loops_of(*made.equations).close(y, work).closed);
  EXPECT_EQ(allocations(), before);
  Vector again(y.size());
  work.poison();
  ASSERT_TRUE(made.equations->derivatives(1, whole.final.y, again, work).ok());
  EXPECT_EQ(again, y_dot);
}

/// What a user is told of a scene; empty where it is good.
std::string message(const std::string& scene, const std::string& formulation = "") {
  try {
    const Made unused(scene, formulation);
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

TEST(ClosedLoops, InitialValuesStayOrAreRefusedWithTheDistance) {
  const std::string text = four_bar(rigid_coupler, "dopri5");
  const Made made(text);
  const Layout& layout = made.scene.model->layout();
  EXPECT_EQ(made.scene.initial.y[layout.hinge("motor")->position], M_PI / 2);
  EXPECT_EQ(made.scene.initial.y[layout.positions + layout.hinge("motor")->speed], 6);
  EXPECT_NEAR(made.scene.initial.y[layout.hinge("pivot")->position], Linkage::place(M_PI / 2).rocker, 1e-14);
  EXPECT_THAT(message(replaced(text, "hinges: {motor: {position: [\"90 deg\"], rate: [6]}}",
                               "hinges: {motor: {position: [1]}, elbow: {position: [0]}, pivot: {position: [0]}}")),
              testing::AllOf(testing::HasSubstr("/constraints/loop: the loop cannot be closed"),
                             testing::HasSubstr("m apart there")));
  EXPECT_THAT(message(replaced(text, "rate: [6]}", "rate: [6]}, pivot: {rate: [6]}")),
              testing::HasSubstr("the initial speeds part its frames at"));
}

TEST(ClosedLoops, AllFaultsOfConstraintsAreReportedWhereTheyStand) {
  const std::string good = four_bar(rigid_coupler, "dopri5");
  const std::string bad = replaced(good, "constraints:\n", R"(constraints:
  a: {type: hinge, hinge: revolut, a: coupler.tip, b: rocker.pin}
  b: {type: hinge, hinge: universal, a: coupler.tp, b: rocker.pin}
  c: {type: hinge, hinge: spherical, a: coupler.tip, b: coupler.root}
  e: {type: hinge, hinge: free, a: coupler.tip, b: rocker.pin}
  f: {type: hinge, hinge: spherical, a: world, b: world}
  g: {type: rope, hinge: spherical, a: world, b: rocker.pin}
)");
  EXPECT_THAT(message(bad),
              testing::AllOf(
                  testing::HasSubstr(R"(14:27: /constraints/a/hinge: no hinge plugin "revolut")"),
                  testing::HasSubstr(R"(15:41: /constraints/b/a: no frame "coupler.tp"; did you mean 'coupler.tip'?)"),
                  testing::HasSubstr("16:57: /constraints/c/b: both its frames are on body 'coupler'"),
                  testing::HasSubstr(R"(17:27: /constraints/e/hinge: "free" cannot close a loop)"),
                  testing::HasSubstr("/constraints/f/b: both its frames are in the world"),
                  testing::HasSubstr("19:13: /constraints/g/type: got \"rope\"")));
  // Two loops that no state closes.
  EXPECT_THAT(message(replaced(
                  good, "loads:", "  other: {type: hinge, hinge: spherical, a: coupler.root, b: rocker.pin}\nloads:")),
              testing::HasSubstr("the loop cannot be closed from the initial state"));
}

TEST(ClosedLoops, WhatKnowsTreesAloneIsRefused) {
  const std::string good = four_bar(beam_coupler, "dopri5");
  EXPECT_THAT(message(good, "consistent"),
              testing::HasSubstr("/formulation: consistent: closed loops (constraints) need"));
  EXPECT_THAT(message(good, "auto"), testing::HasSubstr("/formulation: got 'auto'"));
  EXPECT_THAT(message(replaced(good, "  torque:",
                               "  slew: {type: rigid-inverse-dynamics, law: quintic, duration: 1, "
                               "hinges: {motor: {from: 0, to: 1}}}\n  torque:")),
              testing::HasSubstr("/loads/slew: the inverse dynamics of the rigid tree"));
  const Made made(good);
  for (const char* id : {"cvode", "imex", "rosenbrock-w", "generalized-alpha"}) {
    const std::string options = std::string(id) == "generalized-alpha" ? "{name: generalized-alpha, step: 0.01}" : id;
    const Made other(four_bar(beam_coupler, options));
    EXPECT_THAT([&] { other.scene.integrator->start(*other.equations, other.scene.initial); },
                testing::ThrowsMessage<std::invalid_argument>(
                    testing::HasSubstr("integrator '" + std::string(id) + "' cannot run closed loops")));
  }
  // What stands between equations and integrator would hide the loops.
  const std::vector<Rung> rungs = {{"quadratic", {}, made.equations.get()}};
  EXPECT_THAT(
      [&] {
        ChangingEquations(rungs, {{0, 0, 1}});
      },
      testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("loops are closed")));
  EXPECT_THAT(message(good + "events:\n  hold: {at: 0.2, do: {lock: motor}}\n"),
              testing::HasSubstr("events lock or unlock hinges knows nothing of closed loops"));
}

}  // namespace
}  // namespace withy::test
