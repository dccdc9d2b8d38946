/// \file
/// What limits a column that a closed loop holds at its far end: loads, frequencies and poles are those of the column
/// with both ends held, whose numbers are known, and not of the tree with its loop cut.
#include <gtest/gtest.h>

#include <cmath>

#include "four_bar.hpp"
#include "withy/core/analysis/closed_pole.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/loop_following.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::test {
namespace {

constexpr double stiffness = 6, density = 0.6, push = 45;
const double unit_rate = std::sqrt(stiffness / density);

/// A column of length 1 between a carriage, which a force pushes, and a pin in the world that closes a loop. `root`:
/// the hinge on the carriage.
std::string column(const std::string& root, int modes, double force,
                   const std::string& family = "orthogonal-polynomials") {
  return R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-7, atol: 1e-9}
time: {end: 0.02}
bodies:
  carriage: {type: rigid, mass: 1.0, inertia: [0.001, 0.01, 0.01, 0, 0, 0]}
  rod: {type: beam, length: 1, mass_per_length: 0.6, bending_y: {stiffness: 6, modes: )" +
         std::to_string(modes) + ", family: " + family + R"(}}
hinges:
  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: carriage}
  root: {)" +
         root + R"(, parent: carriage, child: rod}
loads:
  push: {type: force, frame: carriage, value: [)" +
         std::to_string(force) + R"(, 0, 0]}
constraints:
  end: {type: hinge, hinge: revolute, axis: [0, 0, 1], offset: {position: [1, 0, 0]}, a: world, b: rod.tip}
)";
}
constexpr const char* pin = "type: revolute, axis: [0, 0, 1]";
constexpr const char* clamp = "type: weld";

RunSummary summary_of(const std::string& text, const std::string& formulation) {
  const Made m(text, formulation);
  RunOptions options;
  options.end = 0.02;
  RunSummary summary =
      simulate(*m.scene.model, *m.equations, *m.scene.integrator, m.scene.initial, options, [](const State&) {});
  EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
  return summary;
}

BodyValidity validity_of(const std::string& text, const std::string& formulation) {
  return summary_of(text, formulation).validity.bodies.at(0);
}

FastestPole pole_of(const Made& m) { return fastest_pole_of_loops(*m.scene.model, *m.equations, m.scene.initial); }

/// Euler's loads: π² EI/L² of a column with two pins, 20.1907 EI/L² of one that is clamped at one end.
TEST(LoopLimits, TheLoadOfAColumnInALoopIsHeldAgainstEulersLoadOfTheColumnAsItIsHeld) {
  for (const char* formulation : {"linear", "ruthless", "quadratic", "exact"}) {
    const BodyValidity pinned = validity_of(column(pin, 5, push), formulation);
    EXPECT_NEAR(pinned.buckling, push / (M_PI * M_PI * stiffness), 1e-4) << formulation;
    EXPECT_FALSE(pinned.load.stiffens);
    EXPECT_NEAR(pinned.load.shares[motion_terms - 1], pinned.load.least, 1e-6) << "all of it by loads at frames";
    double sum = 0;
    for (const double share : pinned.load.shares) sum += share;
    EXPECT_NEAR(sum, pinned.load.least, 1e-9);
    const BodyValidity clamped = validity_of(column(clamp, 5, push), formulation);
    EXPECT_NEAR(clamped.buckling, push / (20.190729 * stiffness), 1e-3) << formulation;
    const BodyValidity pulled = validity_of(column(pin, 5, -push), formulation);
    EXPECT_TRUE(pulled.load.stiffens);
  }
}

/// The pin turns the root's section, and modes may turn it in the body frame besides: half a sine is the shape of
/// Euler's column, and five functions of the other families come as near as a few thousandths.
TEST(LoopLimits, TheLoadOfAColumnWithTwoPinsIsTheSameWhateverItsModesTurn) {
  const double euler = push / (M_PI * M_PI * stiffness);
  for (const char* formulation : {"linear", "ruthless", "quadratic"}) {
    EXPECT_NEAR(validity_of(column(pin, 1, push, "pinned-pinned"), formulation).buckling, euler, 1e-4) << formulation;
    for (const char* family : {"clamped-free", "pinned-pinned", "pinned-free", "free-free"}) {
      const BodyValidity v = validity_of(column(pin, 5, push, family), formulation);
      EXPECT_NEAR(v.buckling, euler, 5e-3 * euler) << formulation << family;
      double sum = 0;
      for (const double share : v.load.shares) sum += share;
      EXPECT_NEAR(sum, v.load.least, 1e-9) << formulation << family;
    }
  }
}

/// A straight column does not move, and what rounding lets its load do is no energy. A bent one has energy to be off.
TEST(LoopLimits, AColumnThatRestsUnderItsLoadHasNoEnergyThatCouldBeOff) {
  const std::string straight = column(pin, 5, push, "clamped-free");
  for (const std::string integrator : {"{name: dopri5}", "{name: radau}", "{name: gauss, step: 0.001}"}) {
    const RunSummary rests =
        summary_of(replaced(straight, "{name: dopri5, rtol: 1e-7, atol: 1e-9}", integrator), "quadratic");
    EXPECT_EQ(rests.energy_drift, 0) << integrator;
    EXPECT_EQ(rests.energy_scale, 0) << integrator;
  }
  const RunSummary moves =
      summary_of(straight + "initial: {bodies: {rod: {modes: [0.001, 0, 0, 0, 0]}}}\n", "quadratic");
  EXPECT_GT(moves.energy_scale, 0);
  EXPECT_GT(moves.energy_drift, 0);
  EXPECT_LT(moves.energy_drift, 1e-3);
}

/// π² √(EI/m)/L² with two pins, 15.4182 √(EI/m)/L² with one end clamped.
TEST(LoopLimits, TheLowestFrequencyOfARodInALoopIsThatOfTheRodWithBothEndsHeld) {
  for (const char* formulation : {"linear", "ruthless", "quadratic", "exact"}) {
    EXPECT_NEAR(validity_of(column(pin, 5, 0), formulation).fundamental, M_PI * M_PI * unit_rate, 1e-2) << formulation;
    EXPECT_NEAR(validity_of(column(clamp, 5, 0), formulation).fundamental, 15.41821 * unit_rate, 1e-2) << formulation;
  }
}

/// By Ritz's method with x, x², x³ and x⁴, w(L) = 0: frequencies 31.2197, 158.745 and 416.828 rad/s, and under 45 N
/// 15.3108, 148.492 and 407.536 rad/s.
TEST(LoopLimits, TheFastestPoleOfALoopIsThatOfTheMotionsThatKeepItClosed) {
  const Made still(column(pin, 3, 0), "quadratic"), pushed(column(pin, 3, push), "quadratic");
  EXPECT_NEAR(std::abs(pole_of(still).value), 416.8277, 1e-3);
  EXPECT_NEAR(std::abs(pole_of(pushed).value), 407.5360, 1e-3) << "with what multipliers do as the rod turns";
  EXPECT_FALSE(pole_of(still).of_load);
  const std::string& name = still.scene.model->layout().speed_names[pole_of(still).speed];
  EXPECT_TRUE(name.starts_with("rod.") || name == "root.0") << name;
  const State& state = still.scene.initial;
  const DenseSystem system = still.equations->system(state.time, state.y);
  const Eigen::MatrixXd rows = closing_rows(*still.equations, state.y);
  EXPECT_NEAR(fastest_mode(*still.scene.model, system, rows), 416.8277, 1e-3);
  // With x, x² and x³ 158.745 rad/s is the fastest.
  const std::optional<Slowing> fewer = best_slowing(*still.scene.model, system, rows);
  ASSERT_TRUE(fewer);
  EXPECT_NEAR(fewer->fastest, 158.7451, 1e-3);
  EXPECT_GT(fastest_mode(*still.scene.model, system), 1.2 * 416.8) << "the tree with its loop cut";
}

/// No mode is as fast as what a strong damper on the root's pin makes die out.
TEST(LoopLimits, ADamperThatIsFasterThanAllModesIsToldAsALoads) {
  const std::string text = column(pin, 3, 0);
  const std::size_t at = text.find("  push:");
  const Made m(
      text.substr(0, at) + "  servo: {type: hinge-spring, hinge: root, stiffness: 0, damping: 50}\n" + text.substr(at),
      "quadratic");
  const FastestPole pole = pole_of(m);
  EXPECT_GT(std::abs(pole.value), 2 * 416.8);
  EXPECT_LT(pole.value.real(), 0);
  EXPECT_TRUE(pole.of_load);
}

}  // namespace
}  // namespace withy::test
