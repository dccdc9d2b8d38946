// Inputs: loads whose values a host sets between steps.
#include <gmock/gmock.h>

#include <cmath>

#include "withy/core/plugin/central_difference.hpp"
#include "withy/tests/conformance/load_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy {
namespace {

using test::turntable;
using testing::HasSubstr;

// A flexible arm in space, on which inputs act in every way there is.
const std::string arm_with_inputs = R"(format: withy/1
gravity: [0, 0, -3]
time: {end: 0.5, output: 0.05}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 2}, bending_z: {stiffness: 5, modes: 1}}
hinges:
  base: {type: free, parent: world, child: hub}
  axle: {type: revolute, axis: [0, 0, 1], parent: hub, child: boom}
)";

const LoadNode& load_of(const Model& model, const std::string& name) {
  for (const LoadNode& load : model.loads())
    if (load.name == name) return load;
  throw std::out_of_range(name);
}

void set_input(const Model& model, State& state, const std::string& name, double value, double reached) {
  const LoadNode& load = load_of(model, name);
  load.load->input()->set(state.time, reached, value, load.discrete(std::span(state.y)));
}

std::vector<double> coordinates(const Model& model, const State& state) {
  const auto count = static_cast<std::ptrdiff_t>(model.layout().positions + model.layout().speeds);
  return {state.y.begin(), state.y.begin() + count};
}

// A table is a recording of what a host has set: as an input it acts as the same values as an effort or a force.
TEST(Input, by_a_table_acts_as_efforts_and_forces_of_the_same_values) {
  test::LoadedScene inputs(arm_with_inputs + R"(loads:
  a: {type: input, hinge: axle, table: [[0.1, 0.2], [0.3, -0.4]]}
  b: {type: input, hinge: base, component: 4, hold: linear, table: [[0, 1], [0.2, 3], [0.4, 0]]}
  c: {type: input, frame: boom.tip, direction: [0, 0, 2], following: true, table: [[0.05, 0.3], [0.35, 0]]}
  d: {type: input, frame: hub, direction: [0, -1, 0], acts: torque, hold: linear, table: [[0, 0.1], [0.5, 0.5]]}
)");
  test::LoadedScene efforts(arm_with_inputs + R"(loads:
  a: {type: hinge-effort, hinge: axle, law: steps, table: [[0.1, 0.2], [0.3, -0.4]]}
  b: {type: hinge-effort, hinge: base, component: 4, law: table, table: [[0, 1], [0.2, 3], [0.4, 0]]}
  c: {type: force, frame: boom.tip, following: true, law: steps, table: [[0.05, 0, 0, 0.3], [0.35, 0, 0, 0]]}
  d: {type: torque, frame: hub, law: table, table: [[0, 0, -0.1, 0], [0.5, 0, -0.5, 0]]}
)");
  for (const auto& [name, unit] : {std::pair("a", "N m"), {"b", "N"}, {"c", "N"}, {"d", "N m"}})
    EXPECT_EQ(load_of(*inputs.scene.model, name).load->input()->unit(), unit) << name;
  const std::vector<State> by_inputs = inputs.run(), by_efforts = efforts.run();
  ASSERT_EQ(by_inputs.size(), by_efforts.size());
  for (std::size_t i = 0; i < by_inputs.size(); ++i) {
    const std::vector<double> one = coordinates(*inputs.scene.model, by_inputs[i]);
    const std::vector<double> other = coordinates(*efforts.scene.model, by_efforts[i]);
    for (std::size_t k = 0; k < one.size(); ++k) EXPECT_NEAR(one[k], other[k], 1e-13) << by_inputs[i].time;
  }
}

// x'' = τ/J with τ constant, or growing in proportion to time: polynomials.
TEST(Input, set_by_a_host_holds_or_is_reached_in_a_straight_line) {
  for (const bool linear : {false, true}) {
    test::LoadedScene s(turntable + "loads: {command: {type: input, hinge: axle" +
                        (linear ? ", hold: linear}}\n" : "}}\n"));
    const Model& model = *s.scene.model;
    EXPECT_EQ(load_of(model, "command").load->input()->unit(), "N m");
    set_input(model, s.scene.initial, "command", 0.3, 2.0);
    const State end = s.run().back();
    const double J = 0.2, peak = 0.3 / J;
    EXPECT_NEAR(s.rate(end, "axle"), linear ? peak : 2 * peak, 1e-9);
    EXPECT_NEAR(s.position(end, "axle"), linear ? peak * 4 / 6 : 2 * peak, 1e-9);
    // Set anew in the middle of a ramp, it goes on from the value there.
    State middle = s.scene.initial;
    middle.time = 0.5;
    set_input(model, middle, "command", 1.0, 0.7);
    const LoadNode& load = load_of(model, "command");
    const double there = load.load->input()->value(0.6, load.discrete(std::span<const double>(middle.y)));
    EXPECT_NEAR(there, linear ? 0.5 * (0.075 + 1.0) : 1.0, 1e-15);
  }
}

// A state written out has the inputs that were set; runs from it and from the state itself are the same bits.
TEST(Input, is_a_part_of_the_state) {
  test::LoadedScene s(arm_with_inputs + R"(loads:
  push: {type: input, frame: boom.tip, direction: [0, 1, 1], following: true}
  turn: {type: input, hinge: axle, hold: linear}
  other: {type: input, hinge: axle, table: [[0.2, 0.1]]}
initial: {inputs: {push: "200 mN", turn: -0.1}}
)");
  const Model& model = *s.scene.model;
  const State end = s.run().back();
  const State read = parse_state(write_state(model, end), "state.json", model, model.reference_state());
  EXPECT_EQ(read.time, end.time);
  EXPECT_EQ(coordinates(model, read), coordinates(model, end));
  const auto value = [&](const State& state, const char* name) {
    const LoadNode& load = load_of(model, name);
    return load.load->input()->value(state.time + 0.01, load.discrete(std::span(state.y)));
  };
  EXPECT_EQ(value(read, "push"), 0.2);
  EXPECT_EQ(value(read, "turn"), -0.1);
  EXPECT_EQ(value(read, "other"), 0.1);
  std::vector<State> ends;
  for (const State& start : {end, read}) {
    s.scene.initial = start;
    s.scene.end = 0.8;
    ends.push_back(s.run().back());
  }
  EXPECT_EQ(coordinates(model, ends[0]), coordinates(model, ends[1]));
  EXPECT_NE(coordinates(model, ends[0]), coordinates(model, end));
}

// The sweeps, the dense reference and the exact Jacobian see the same load.
TEST(Input, is_in_the_exact_jacobian_and_in_the_dense_system) {
  for (const char* formulation : {"quadratic", "consistent", "symmetric", "ruthless"}) {
    test::LoadedScene s(arm_with_inputs + R"(loads:
  push: {type: input, frame: boom.tip, direction: [0, 1, 1], following: true}
  twist: {type: input, frame: hub, direction: [1, 0, 0], acts: torque}
  turn: {type: input, hinge: axle, hold: linear}
initial:
  inputs: {push: 2, twist: -1, turn: 0.4}
  hinges: {axle: {position: [0.4], rate: [0.3]}, base: {position: [0.8, 0, 0.6, 0, 0, 0, 0], rate: [0.1, 0.2, 0.3, 0, 0, 0]}}
  bodies: {boom: {modes: [0.02, 0.001, 0.01], rates: [0.1, 0, 0.1]}}
)",
                        {std::string("formulation=") + formulation});
    const State& at = s.scene.initial;
    const std::size_t n = s.equations->size() - 1 - s.scene.model->layout().discrete;
    Work work = s.equations->make_work();
    const auto derivatives = [&](const std::vector<double>& y) {
      std::vector<double> y_dot(y.size());
      EXPECT_TRUE(s.equations->derivatives(at.time, y, y_dot, work).ok());
      return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(y_dot.data(), static_cast<Eigen::Index>(n)));
    };
    std::vector<double> y_dot(at.y.size());
    ASSERT_TRUE(s.equations->derivatives(at.time, at.y, y_dot, work).ok());
    const std::vector<double> dense = solve(s.equations->system(at.time, at.y));
    for (std::size_t i = 0; i < dense.size(); ++i)
      EXPECT_NEAR(y_dot[s.scene.model->layout().positions + i], dense[i], 1e-9 * (1 + std::abs(dense[i])));
    if (s.equations->linearization() == nullptr) {
      EXPECT_STREQ(formulation, "symmetric");
      continue;
    }
    Eigen::MatrixXd J(n, n);
    ASSERT_TRUE(s.equations->linearization()
                    ->jacobian(at.time, at.y, y_dot, {J.data(), static_cast<std::size_t>(J.size())})
                    .ok());
    for (std::size_t j = 4; j < n; ++j) {  // not the quaternion, which moves along its sphere
      const Eigen::VectorXd numeric = central_difference(
          [&](double h) {
            std::vector<double> moved = at.y;
            moved[j] += h;
            return derivatives(moved);
          },
          1e-3);
      EXPECT_LT((numeric - J.col(static_cast<Eigen::Index>(j))).cwiseAbs().maxCoeff(),
                1e-7 * (1 + J.cwiseAbs().maxCoeff()))
          << formulation << ", column " << j;
    }
  }
}

TEST(Input, that_does_not_fit_is_refused) {
  const auto problem = [](const std::string& load) {
    return test::problem_of(turntable + "loads: {u: {type: input" + load + "}}\n");
  };
  EXPECT_THAT(problem(""), HasSubstr("one of 'hinge' and 'frame'"));
  EXPECT_THAT(problem(", hinge: axle, frame: table"), HasSubstr("one of 'hinge' and 'frame'"));
  EXPECT_THAT(problem(", hinge: axel"), HasSubstr("did you mean 'axle'"));
  EXPECT_THAT(problem(", hinge: axle, component: 1"), HasSubstr("no component 1"));
  EXPECT_THAT(problem(", hinge: axle, direction: [1, 0, 0]"), HasSubstr("there is no 'direction'"));
  EXPECT_THAT(problem(", frame: table"), HasSubstr("needs a 'direction'"));
  EXPECT_THAT(problem(", frame: table, direction: [0, 0, 0]"), HasSubstr("has no length"));
  EXPECT_THAT(test::problem_of(turntable + "loads: {u: {type: input, hinge: axle}}\ninitial: {inputs: {v: 1}}\n"),
              HasSubstr("no load of type 'input' \"v\"; known: u"));
}

TEST(Input, conforms_to_the_suite) {
  const test::LoadedScene s(turntable);
  Registry registry = load_registry();
  const Value rows = Value::list({Value::list({Value(0.1), Value(2.0)}), Value::list({Value(0.4), Value(-1.0)})});
  test::expect_load_conforms(
      *make_plugin<Load>(
          registry, "input",
          {{"hinge", Value(std::string("axle"))}, {"hold", Value(std::string("linear"))}, {"table", rows}}),
      *s.scene.model);
  test::expect_load_conforms(*make_plugin<Load>(registry, "input",
                                                {{"frame", Value(std::string("table"))},
                                                 {"direction", Value::list({Value(1.0), Value(0.0), Value(0.0)})},
                                                 {"hold", Value(std::string("constant"))}}),
                             *s.scene.model);
}

}  // namespace
}  // namespace withy
