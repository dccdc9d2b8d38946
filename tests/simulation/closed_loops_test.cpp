/// \file
/// Motion of closed loops: against a solution in the one coordinate of a four-bar linkage, against published numbers,
/// and by what is conserved.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "four_bar.hpp"
#include "withy/tests/conformance/allocations.hpp"
#include "withy/tests/simulation/wrapped_steps.hpp"

namespace withy::test {
namespace {

using Vector = std::vector<double>;

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
    const std::string text = replaced(four_bar(beam_coupler, "{name: dop853, rtol: 1e-10, atol: 1e-12}"),
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

TEST(ClosedLoops, AreRefusedToIntegratorsThatDoNotSayThatTheyCloseThem) {
  Made made(four_bar(rigid_coupler, "{name: dopri5}"));
  made.scene.integrator = std::make_shared<WrappedIntegrator<WrappedSteps>>(made.scene.integrator);
  try {
    run(made, 0.1);
    FAIL() << "it ran";
  } catch (const std::invalid_argument& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("the integrator cannot run closed loops (constraints)"));
  }
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

/// A parallelogram whose cranks both have motions, alike in coordinate and rate at first; they part by 0.3 t³.
std::string parted(const std::string& integrator) {
  std::string text = four_bar(rigid_coupler, integrator);
  text = replaced(text, "frames: {pin: {position: [0.8, 0, 0]}}", "frames: {pin: {position: [0.3, 0, 0]}}");
  text = replaced(text, "offset: {position: [0.9, 0, 0]}", "offset: {position: [1.0, 0, 0]}");
  text = replaced(text, "loads:\n  torque: {type: hinge-effort, hinge: motor, law: constant, value: 1.5}\n", R"(motions:
  one: {hinge: motor, type: constant-rate, rate: 1, from: 1.2}
  other: {hinge: pivot, type: expression, value: 1.2 + t + 0.3 * t^3}
)");
  const std::size_t initial = text.find("initial:");
  return text.replace(initial, std::string::npos, "initial: {guess: {hinges: {elbow: {position: [-1.2]}}}}\n");
}

// The coupler stays level: of the two equations that close the loop in the plane, one moves nothing, and at the stages
// of implicit steps next to nothing.
TEST(ClosedLoops, ImplicitStepsFollowTwoMotionsThatAgree) {
  for (const char* integrator : {"{name: gauss, step: 0.01}", "{name: radau, rtol: 1e-8, atol: 1e-10}"}) {
    SCOPED_TRACE(integrator);
    std::string text = parted(integrator);
    text = replaced(text, "1.2 + t + 0.3 * t^3", "1.2 + t");
    const Made made(text);
    RunOptions options;
    options.most_steps = 1'000;
    const RunSummary summary = run(made, 1.0, {}, options);
    EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
    EXPECT_EQ(summary.steps.rejected, 0U);
    EXPECT_LT(summary.energy_drift, 1e-5)
        << "of a tree that is driven in part, work is no part of the error that steps keep";
  }
}

// The coupler leaves 0.3 m · 0.3 t³ sin 1.2 open, which is more than rounding, 10⁻⁹ m, from 2.3 ms on.
TEST(ClosedLoops, MotionsThatPartEndARunWhereTheyDo) {
  for (const char* integrator : {"{name: dopri5, rtol: 1e-8, atol: 1e-10}", "{name: dop853, rtol: 1e-10, atol: 1e-12}",
                                 "{name: rk4-adaptive, rtol: 1e-8, atol: 1e-10}",
                                 "{name: radau, rtol: 1e-8, atol: 1e-10}", "{name: rk4, step: 1e-3}"}) {
    SCOPED_TRACE(integrator);
    const Made made(parted(integrator));
    RunOptions options;
    options.most_steps = 10'000;
    const RunSummary summary = run(made, 1.0, {}, options);
    EXPECT_EQ(summary.status, RunStatus::singular) << summary.message;
    EXPECT_THAT(summary.message, testing::HasSubstr("motions that leave them no way"));
    EXPECT_GT(summary.reached, 1e-3);
    EXPECT_LT(summary.reached, 3e-3);
    EXPECT_LT(summary.steps.accepted + summary.steps.rejected, 300U);
  }
}

TEST(ClosedLoops, DataThatAreRoundedLeaveGapsThatDoNotStopARun) {
  const Made made(replaced(four_bar(rigid_coupler, "{name: dopri5, rtol: 1e-7, atol: 1e-9}"),
                           "offset: {position: [0.9, 0, 0]}", "offset: {position: [0.9, 0, 9e-11]}"));
  const RunSummary summary = run(made, 1.0);
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
}

TEST(ClosedLoops, RunsAreResumedBitByBitAndEvaluationsAllocateNothing) {
  for (const char* integrator : {"{name: dopri5, rtol: 1e-7, atol: 1e-9}", "{name: radau, rtol: 1e-7, atol: 1e-9}"}) {
    SCOPED_TRACE(integrator);
    const Made made(four_bar(beam_coupler, integrator));
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
}

/// A linkage that dampers bring to rest, whose coupler's fastest mode is ten thousand times as fast as the slowest. At
/// rest radau takes steps of seconds. Closing the loop by smallest changes left forces of that stiffness after each,
/// and differences of speeds that are next to nothing left rounding for a Jacobian.
std::string coming_to_rest(const std::string& integrator) {
  const std::string coupler =
      "{type: beam, length: 1.0, mass_per_length: 0.54, bending_y: {stiffness: 116.7, modes: 6, family: clamped-free}, "
      "extension: {stiffness: 1.4e7, modes: 2}, damping_ratio: 0.02}";
  const std::string text = replaced(four_bar(coupler, integrator), "rate: [6]", "rate: [1]");
  return replaced(text, "initial:", R"(  on_crank: {type: hinge-spring, hinge: motor, stiffness: 3, damping: 2}
  on_rocker: {type: hinge-spring, hinge: pivot, stiffness: 0, damping: 1}
outputs: {pin: {type: reaction, constraint: loop}}
initial:)");
}

TEST(ClosedLoops, StiffModesDoNotCutTheLongStepsOfRadauAtRest) {
  const Made made(coming_to_rest("{name: radau, rtol: 1e-6, atol: 1e-11}"));
  const RunSummary summary = run(made, 60.0);
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
  EXPECT_LT(summary.steps.rejected, summary.steps.accepted / 4);
}

TEST(ClosedLoops, AtRestReactionsAreTheSameWithinLongSteps) {
  const Made made(coming_to_rest("{name: radau, rtol: 1e-6, atol: 1e-9}"));
  Vector last;
  double apart = 0;
  run(made, 60.0, [&](const State& state) {
    if (state.time < 25) return;
    const Vector now = read_sensors(made, state);
    for (std::size_t i = 0; i < last.size(); ++i) apart = std::max(apart, std::abs(now[i] - last[i]));
    last = now;
  });
  ASSERT_FALSE(last.empty());
  EXPECT_GT(std::abs(last[0]), 1) << "N along the coupler";
  EXPECT_LT(apart, 1e-4) << "of a stiffness of 1e7 N/m, at 1e-9 m";
}

/// An arm on a hinge with 3 N m, its end a metre away welded to the world: the weld's force and its moment both hold
/// the one angle. The least of λ_f² + λ_m² with λ_m = moment / ℓ is f = τ r/(r² + ℓ²), m = τ ℓ²/(r² + ℓ²), with ℓ = r
/// half each. A frame that nothing joins, ten metres off, is no length of anything.
TEST(ClosedLoops, ReactionsOfRedundantLoopsDoNotDependOnFramesThatNothingJoins) {
  for (const char* more : {"", ", unused: {position: [0, 0, 10]}"}) {
    const Made made(std::string(R"(format: withy/1
gravity: [0, 0, 0]
time: {end: 0.1}
bodies:
  arm: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0], frames: {end: {position: [1, 0, 0]})") +
                    more + R"(}}
  bob: {type: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  a: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}
  b: {type: revolute, axis: [0, 0, 1], parent: world, child: bob, offset: {position: [0, 0.5, 0]}}
constraints:
  held: {type: hinge, hinge: weld, a: world, b: arm.end, offset: {position: [1, 0, 0]}}
loads: {torque: {type: hinge-effort, hinge: a, law: constant, value: 3}}
outputs: {on: {type: reaction, constraint: held}}
)");
    const std::vector<double> on = read_sensors(made, made.scene.initial);
    ASSERT_EQ(on.size(), 6U);
    std::vector<double> sizes;
    for (const double x : on) sizes.push_back(std::abs(x));
    std::sort(sizes.begin(), sizes.end());
    EXPECT_NEAR(sizes[3], 0, 1e-12) << more;
    EXPECT_NEAR(sizes[4], 1.5, 1e-12) << "force or moment" << more;
    EXPECT_NEAR(sizes[5], 1.5, 1e-12) << "force or moment" << more;
    EXPECT_NEAR(on[1], -1.5, 1e-12) << "the force on the arm's end" << more;
  }
}

}  // namespace
}  // namespace withy::test
