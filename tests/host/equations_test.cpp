// Equations of motion for integrators of the host's own.
#include "withy/host/equations.hpp"

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <thread>

#include "withy/core/plugin/central_difference.hpp"
#include "withy/host/simulation.hpp"
#include "withy/tests/host/arm.hpp"

namespace withy {
namespace {

using host::Equations;
using host::Scene;
using test::library;
using test::smooth_arm;
using testing::HasSubstr;

/// The classical Runge-Kutta method: what a host may bring.
void rk4(Equations& f, double t, double h, std::vector<double>& y) {
  const std::size_t n = y.size();
  std::vector<double> k1(n), k2(n), k3(n), k4(n), at(n);
  const auto stage = [&](double part, const std::vector<double>& k) {
    for (std::size_t i = 0; i < n; ++i) at[i] = y[i] + part * h * k[i];
    return std::span<const double>(at);
  };
  EXPECT_TRUE(f.derivatives(t, y, k1).ok());
  EXPECT_TRUE(f.derivatives(t + h / 2, stage(0.5, k1), k2).ok());
  EXPECT_TRUE(f.derivatives(t + h / 2, stage(0.5, k2), k3).ok());
  EXPECT_TRUE(f.derivatives(t + h, stage(1, k3), k4).ok());
  for (std::size_t i = 0; i < n; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  f.normalize(y);
}

TEST(HostedEquations, say_where_a_loop_cannot_be_closed) {
  Equations equations(Scene::read(library(), WITHY_SOURCES "/scenes/gallery/four-bar.yaml"));
  std::vector<double> y(equations.y0().begin(), equations.y0().end());
  equations.normalize(y);
  y.front() = std::nan("");
  EXPECT_THROW(equations.normalize(y), std::invalid_argument);
}

// A host's integrator and that of withy find the same motion; each number of y is the column of its name.
TEST(HostedEquations, integrated_by_a_host_are_the_simulation) {
  Scene scene = smooth_arm();
  scene.set("integrator", "{name: dop853, rtol: 1e-11, atol: 1e-13}");
  Equations equations(scene);
  host::Simulation simulation(scene);
  equations.set_input("torque", 0.1);
  equations.set_input("jet", 0.2);
  simulation.set_input("torque", 0.1);
  simulation.set_input("jet", 0.2);
  std::vector<double> y = equations.y0();
  for (int k = 0; k < 1000; ++k) rk4(equations, 0.0002 * k, 0.0002, y);
  simulation.step(0.2);
  for (std::size_t i = 0; i < y.size(); ++i) {
    const host::Port& state = equations.states()[i];
    EXPECT_NEAR(y[i], simulation.output(state.name), 3e-8) << state.name;
    EXPECT_EQ(state.unit, simulation.outputs()[simulation.output_index(state.name)].unit) << state.name;
  }
}

TEST(HostedEquations, have_an_exact_jacobian) {
  Equations equations(smooth_arm(), "quadratic");
  equations.set_input("ramp", 0.3);
  equations.set_input("jet", 0.2);
  std::vector<double> y = equations.y0();
  for (std::size_t i = 4; i < y.size(); ++i) y[i] += 0.02 * std::sin(1.0 + 2.0 * static_cast<double>(i));
  const std::size_t n = equations.size();
  std::vector<double> jacobian(n * n), y_dot(n);
  equations.jacobian(0.1, y, jacobian);
  for (std::size_t j = 4; j < n; ++j) {
    const Eigen::VectorXd numeric = central_difference(
        [&](double h) {
          std::vector<double> moved = y;
          moved[j] += h;
          EXPECT_TRUE(equations.derivatives(0.1, moved, y_dot).ok());
          return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(y_dot.data(), static_cast<Eigen::Index>(n)));
        },
        1e-3);
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(jacobian[i * n + j], numeric[static_cast<Eigen::Index>(i)],
                  1e-7 * (1 + std::abs(jacobian[i * n + j])))
          << equations.states()[i].name << " by " << equations.states()[j].name;
  }
}

TEST(HostedEquations, are_copied_for_other_threads) {
  Equations equations(smooth_arm());
  equations.set_input("torque", 0.4);
  const auto walk = [](Equations f) {
    std::vector<double> y = f.y0();
    for (int k = 0; k < 50; ++k) rk4(f, 0.01 * k, 0.01, y);
    return y;
  };
  const std::vector<double> expected = walk(equations);
  std::vector<std::vector<double>> got(6);
  std::vector<std::thread> threads;
  for (std::vector<double>& y : got) threads.emplace_back([&y, &walk, own = equations] { y = walk(own); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<double>& y : got) EXPECT_EQ(y, expected);
}

/// Eleven states about the initial one, row after row.
std::vector<double> many_states(const Equations& equations) {
  std::vector<double> rows;
  for (int k = 0; k < 11; ++k) {
    std::vector<double> y = equations.y0();
    for (std::size_t i = y.size() - 6; i < y.size(); ++i)
      y[i] += 0.02 * std::sin(1.0 + k + 2.0 * static_cast<double>(i));
    rows.insert(rows.end(), y.begin(), y.end());
  }
  return rows;
}

// A row gets the bits that it gets alone, whatever stands in the others; a formulation without lanes gives those of
// `derivatives`, one with lanes the same to rounding.
TEST(HostedEquations, of_many_states_give_each_row_what_it_gets_alone) {
  std::string text = test::busy_arm;
  text.erase(text.find("  ramp:"), text.find("  jet:") - text.find("  ramp:"));
  text.erase(text.find("  hold:"), text.find("  kick:") - text.find("  hold:"));
  text.replace(text.find("type: free"), 10, "type: revolute, axis: [0, 0, 1]");
  for (const char* formulation : {"quadratic", "ruthless", "consistent"}) {
    const bool in_lanes = formulation != std::string("consistent");
    Equations equations(Scene::parse(test::library(), text), formulation);
    equations.set_input("torque", 0.4);
    const std::size_t n = equations.size();
    const std::vector<double> y = many_states(equations);
    std::vector<double> all(y.size()), alone(n), one(n);
    const host::EvaluatedRows done = equations.derivatives_many(0.1, y, all);
    ASSERT_TRUE(done.evaluation.ok());
    ASSERT_EQ(done.rows, 11U);
    for (std::size_t row = 0; row < done.rows; ++row) {
      const std::span<const double> of_row = std::span<const double>(y).subspan(row * n, n);
      ASSERT_TRUE(equations.derivatives_many(0.1, of_row, alone).evaluation.ok());
      ASSERT_TRUE(equations.derivatives(0.1, of_row, one).ok());
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_EQ(all[row * n + i], alone[i]) << formulation;
        EXPECT_NEAR(all[row * n + i], one[i], in_lanes ? 1e-11 * (1 + std::abs(one[i])) : 0) << formulation;
      }
    }
  }
}

TEST(HostedEquations, of_many_states_name_the_row_that_has_none) {
  Equations equations(smooth_arm());
  std::vector<double> y = many_states(equations), y_dot(y.size());
  y[6 * equations.size() + 7] = std::nan("");
  const host::EvaluatedRows done = equations.derivatives_many(0, y, y_dot);
  EXPECT_EQ(done.rows, 6U);
  EXPECT_FALSE(done.evaluation.ok());
  EXPECT_EQ(equations.reason(0, done.evaluation),
            "t = 0 s: the state is not finite: '" + equations.states()[7].name + "' is nan.");
  y.pop_back();
  try {
    static_cast<void>(equations.derivatives_many(0, y, y_dot));
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_EQ(e.what(), "y: got " + std::to_string(y.size()) + " numbers; need a multiple of " +
                            std::to_string(equations.size()));
  }
}

// Where a slider or a free body is nothing depends on: such numbers would go by unseen.
TEST(HostedEquations, have_no_values_at_a_state_with_any_number_that_is_none) {
  for (const std::string hinge : {"prismatic, axis: [1, 0, 0]", "free"}) {
    Equations equations(Scene::parse(test::library(), R"(format: withy/1
bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {parent: world, child: b, type: )" + hinge + "}}"));
    const std::size_t n = equations.size();
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double> y = equations.y0(), y_dot(n), twice_dot(2 * n);
      y[i] = std::nan("");
      EXPECT_FALSE(equations.derivatives(0, y, y_dot).ok()) << hinge << i;
      std::vector<double> twice = equations.y0();
      twice.insert(twice.end(), y.begin(), y.end());
      const host::EvaluatedRows many = equations.derivatives_many(0, twice, twice_dot);
      EXPECT_EQ(many.rows, 1U) << hinge << i;
      EXPECT_THAT(equations.reason(0, many.evaluation), HasSubstr("'" + equations.states()[i].name + "' is nan"));
    }
  }
}

TEST(HostedEquations, refuse_what_they_do_not_know) {
  try {
    const Equations sampled(Scene::parse(test::library(), test::busy_arm));
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("load 'hold' changes at instants"));
  }
  // An event that only reports acts on nothing, whatever it watches.
  Scene watched = smooth_arm();
  watched.set("events.fast", "{signal: axle.rate, value: 0.1, repeat: true}").set("events.timed", "{at: 0.2}");
  EXPECT_EQ(Equations(watched).size(), Equations(smooth_arm()).size());
  watched.set("events.latch", "{hinge: axle, value: 0.1, do: {lock: axle}}");
  try {
    const Equations acted(watched);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("/events/latch: an event acts on the motion"));
  }
  Equations equations(smooth_arm());
  std::vector<double> y = equations.y0(), y_dot(y.size() - 1);
  EXPECT_THROW(static_cast<void>(equations.derivatives(0, y, y_dot)), std::invalid_argument);
  EXPECT_THROW(equations.jacobian(0, y, y_dot), std::invalid_argument);
  EXPECT_THROW(equations.set_input("torque", INFINITY), std::invalid_argument);
  y_dot.resize(y.size());
  y[7] = std::nan("");
  const Evaluation evaluation = equations.derivatives(0, y, y_dot);
  EXPECT_FALSE(evaluation.ok());
  EXPECT_EQ(equations.reason(0, evaluation),
            "t = 0 s: the state is not finite: '" + equations.states()[7].name + "' is nan.");
  y[7] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(equations.reason(0, equations.derivatives(0, y, y_dot)), HasSubstr("is infinite."));
}

TEST(HostedEquations, have_no_values_at_a_time_that_is_none) {
  Equations equations(smooth_arm());
  const std::vector<double> y = equations.y0();
  std::vector<double> y_dot(y.size());
  const double none = std::nan("");
  const Evaluation evaluation = equations.derivatives(none, y, y_dot);
  EXPECT_FALSE(evaluation.ok());
  EXPECT_EQ(equations.reason(none, evaluation), "t = nan s: the time is not finite.");
  const host::EvaluatedRows done = equations.derivatives_many(none, y, y_dot);
  EXPECT_EQ(done.rows, 0U);
  EXPECT_FALSE(done.evaluation.ok());
}

TEST(HostedEquations, whose_loops_are_closed_say_that_they_have_no_jacobian) {
  Equations equations(Scene::parse(library(), R"(format: withy/1
bodies:
  left: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {end: {position: [1, 0, 0]}}}
  right: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  a: {type: planar, parent: world, child: left}
  b: {type: planar, parent: world, child: right}
constraints:
  pin: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: left.end, b: right}
initial: {guess: {hinges: {b: {position: [0, 1, 0]}}}}
)"));
  std::vector<double> jacobian(equations.size() * equations.size());
  try {
    equations.jacobian(0, equations.y0(), jacobian);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("close loops"));
  }
}

}  // namespace
}  // namespace withy
