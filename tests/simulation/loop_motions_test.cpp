/// \file
/// Small motions of closed loops: against closed forms of a four-bar linkage and of a platform on three rods, and
/// against simulations that begin in the shape of a mode.
#include "withy/core/analysis/loop_motions.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "four_bar.hpp"
#include "made_scene.hpp"
#include "withy/core/analysis/modes.hpp"
#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::test {
namespace {

/// A scene's loops about its initial state.
struct Linear {
  Made made;
  TangentDynamics dynamics;
  Held held;
  LoopMotions loops;
  explicit Linear(const std::string& text)
      : made(text),
        dynamics(made.scene.model, made.scene.formulation->terms()),
        held(made.scene.model->layout().speeds, false),
        loops(*made.equations, dynamics, held) {}

  [[nodiscard]] std::vector<Mode> modes(const State& state, const LoopChart& chart) const {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    const Tangents tree = dynamics.tangents(state.time, state.y, none);
    return natural_modes(loops.reduced(tree, state, none, chart), chart.held);
  }
};

std::string at_rest(std::string text) {
  const std::string moving = ", rate: [6]";
  return text.erase(text.find(moving), moving.size());
}

double curvature_of(double (*f)(double), double at) {
  constexpr double e = 1e-2;
  const auto slope = [&](double x) { return central_difference([&](double h) { return f(x + h); }, e); };
  return central_difference([&](double h) { return slope(at + h); }, e);
}

TEST(LoopMotions, AFourBarLinkageRestsAndSwingsAsInTheAngleOfItsCrank) {
  const Linear linkage(at_rest(four_bar(rigid_coupler, "dopri5")));
  const SteadyState found = linkage.loops.rest(linkage.made.scene.initial);
  ASSERT_TRUE(found.converged);
  const Layout& layout = linkage.made.scene.model->layout();
  const double angle = found.state.y[layout.hinge("motor")->position];
  const double balance = central_difference([&](double h) { return Linkage::weight(angle + h); }, 1e-2);
  EXPECT_NEAR(balance, 1.5, 1e-10) << "weight carries the motor's torque";
  EXPECT_NEAR(found.state.y[layout.hinge("pivot")->position], Linkage::place(angle).rocker, 1e-12);
  EXPECT_LT(found.efforts.cwiseAbs().maxCoeff(), 1e-9);

  const LoopChart chart = linkage.loops.chart(found.state);
  ASSERT_EQ(chart.independent.size(), 1U);
  const std::vector<Mode> modes = linkage.modes(found.state, chart);
  ASSERT_EQ(modes.size(), 1U);
  const double square = curvature_of(&Linkage::weight, angle) / Linkage::inertia(angle);
  EXPECT_NEAR(modes[0].squared_frequency() / square, 1, 1e-8);
}

/// A platform on three rods that hang from universal joints, balls at their lower ends: two balls close loops. It
/// sways level, and turns about its middle.
std::string hanging_platform() {
  std::string bodies, hinges, constraints;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * M_PI * i / 3;
    const auto point = [&](double z) {
      return "[" + std::to_string(0.4 * std::cos(angle)) + ", " + std::to_string(0.4 * std::sin(angle)) + ", " +
             std::to_string(z) + "]";
    };
    const std::string n = std::to_string(i);
    bodies += "  rod" + n +
              ": {type: rigid, mass: 0.6, center_of_mass: [0, 0, -0.75], inertia: [0.1125, 0.1125, 0, 0, 0, 0], "
              "frames: {end: {position: [0, 0, -1.5]}}}\n";
    hinges += "  top" + n +
              ": {type: universal, first_axis: [1, 0, 0], second_axis: [0, 1, 0], parent: world, child: rod" + n +
              ", offset: {position: " + point(0) + "}}\n";
    if (i == 0)
      hinges += "  ball: {type: spherical, parent: rod0.end, child: platform.pin0}\n";
    else
      constraints +=
          "  ball" + n + ": {type: hinge, hinge: spherical, a: platform.pin" + n + ", b: rod" + n + ".end}\n";
  }
  const auto pin = [&](int i) {
    const double angle = 2 * M_PI * i / 3;
    return "pin" + std::to_string(i) + ": {position: [" + std::to_string(0.4 * std::cos(angle)) + ", " +
           std::to_string(0.4 * std::sin(angle)) + ", 0]}";
  };
  return "format: withy/1\ngravity: [0, 0, -9.81]\ntime: {end: 1}\nintegrator: dopri5\nbodies:\n" + bodies +
         "  platform: {type: rigid, mass: 5, inertia: [0.2, 0.2, 0.37, 0, 0, 0], frames: {" + pin(0) + ", " + pin(1) +
         ", " + pin(2) + "}}\nhinges:\n" + hinges + "constraints:\n" + constraints;
}

TEST(LoopMotions, APlatformOnThreeRodsSwaysAndTurnsAsItsClosedFormSays) {
  const Linear platform(hanging_platform());
  const SteadyState found = platform.loops.rest(platform.made.scene.initial);
  ASSERT_TRUE(found.converged);
  const LoopChart chart = platform.loops.chart(found.state);
  ASSERT_EQ(chart.independent.size(), 3U) << "two ways to sway and one to turn";
  const std::vector<Mode> modes = platform.modes(found.state, chart);
  // Rods turn about their tops: a third of their mass moves with the platform, half of their weight is lifted.
  constexpr double g = 9.81, l = 1.5, radius = 0.4, mass = 5, rods = 1.8, inertia = 0.37;
  const double stiffness = (mass + rods / 2) * g / l;
  std::vector<double> squares = {stiffness / (mass + rods / 3), stiffness / (mass + rods / 3),
                                 stiffness * radius * radius / (inertia + rods / 3 * radius * radius)};
  std::sort(squares.begin(), squares.end());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(modes[i].squared_frequency() / squares[i], 1, 1e-5) << i;
}

/// Of a small motion in the shape of a mode nothing is left after a quarter of its period; what is quadratic in it goes
/// with the sign.
TEST(LoopMotions, AFlexibleLinkageLetGoInTheShapeOfAModeSwingsWithItsFrequency) {
  const Linear linkage(at_rest(four_bar(beam_coupler, "{name: dop853, rtol: 1e-12, atol: 1e-14}")));
  const SteadyState found = linkage.loops.rest(linkage.made.scene.initial);
  ASSERT_TRUE(found.converged);
  const LoopChart chart = linkage.loops.chart(found.state);
  const std::vector<Mode> modes = linkage.modes(found.state, chart);
  ASSERT_EQ(modes.size(), 3U) << "the crank and two modes of the coupler";
  Work work = linkage.made.equations->make_work();
  for (const Mode& mode : modes) {
    const Eigen::VectorXd shape = chart.T * mode.shape(chart.independent).real();
    constexpr double size = 1e-5;
    std::vector<std::vector<double>> ends;
    for (const double sign : {1.0, -1.0}) {
      State start = found.state;
      linkage.dynamics.displace(start.y, sign * size / shape.cwiseAbs().maxCoeff() * shape);
      dynamic_cast<const ClosedLoops&>(*linkage.made.equations).close(start.y, work);
      RunOptions options;
      options.end = 0.5 * M_PI / mode.frequency();
      options.output = options.end;
      const RunSummary run = simulate(*linkage.made.scene.model, *linkage.made.equations,
                                      *linkage.made.scene.integrator, start, options, {});
      ASSERT_EQ(run.status, RunStatus::completed) << run.message;
      ends.push_back(run.final.y);
    }
    for (std::size_t i = 0; i < linkage.made.scene.model->layout().positions; ++i)
      EXPECT_LT(std::abs(ends[0][i] - ends[1][i]) / (2 * size), 1e-6) << mode.frequency() << " rad/s, coordinate " << i;
  }
}

/// Away from equilibrium the loops' forces and the change of what is independent count too.
TEST(LoopMotions, WhereTheyBeginToMoveTheyAreDerivativesOfTheAccelerationsOfClosedLoops) {
  const Linear linkage(at_rest(four_bar(beam_coupler, "dopri5")));
  const State& state = linkage.made.scene.initial;
  const Eigen::VectorXd a = linkage.loops.accelerations(state);
  const std::vector<double> rates = linkage.made.rates(state);
  const Layout& layout = linkage.made.scene.model->layout();
  for (Eigen::Index i = 0; i < a.size(); ++i)
    EXPECT_NEAR(a[i], rates[layout.positions + static_cast<std::size_t>(i)], 1e-9 * a.cwiseAbs().maxCoeff()) << i;
  EXPECT_GT(a.cwiseAbs().maxCoeff(), 1) << "it begins to move";

  const LoopChart chart = linkage.loops.chart(state);
  const Tangents reduced = linkage.loops.reduced(linkage.dynamics.tangents(state.time, state.y, a), state, a, chart);
  const FirstOrderForm form = first_order_form(reduced, chart.held);
  const auto m = static_cast<Eigen::Index>(chart.independent.size());
  Work work = linkage.made.equations->make_work();
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto accelerations = [&](double h) -> Eigen::VectorXd {
      State there = state;
      linkage.dynamics.displace(there.y, h * chart.T.col(i));
      std::vector<double> y = there.y;
      dynamic_cast<const ClosedLoops&>(*linkage.made.equations).close(y, work);
      std::vector<double> y_dot(y.size());
      EXPECT_TRUE(linkage.made.equations->derivatives(0, y, y_dot, work).ok());
      Eigen::VectorXd of(m);
      for (Eigen::Index k = 0; k < m; ++k)
        of[k] = y_dot[layout.positions + static_cast<std::size_t>(chart.independent[static_cast<std::size_t>(k)])];
      return of;
    };
    const Eigen::VectorXd slope = central_difference(accelerations, 1e-3);
    const Eigen::VectorXd found = form.A.col(i).tail(m);
    EXPECT_LT((slope - found).cwiseAbs().maxCoeff(), 1e-6 * form.A.cwiseAbs().maxCoeff()) << i;
  }
}

}  // namespace
}  // namespace withy::test
