/// \file
/// One body on a revolute hinge with one mode, and equations of motion for it of the tests' own choice.
#pragma once

#include <cmath>
#include <functional>
#include <limits>

#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/conformance/function_equations.hpp"
#include "withy/tests/conformance/test_bodies.hpp"
#include "withy/tests/integrators/integrator_plugins.hpp"

extern "C" {
extern const withy::PluginDescriptor withy_plugin_hinges;
}

namespace withy {

/// An effort on the hinge given by a function, with discontinuities as declared.
class TestLoad final : public Load {
 public:
  explicit TestLoad(std::function<double(double)> effort, std::vector<double> jumps = {})
      : effort_(std::move(effort)), jumps_(std::move(jumps)) {}
  std::unique_ptr<BoundLoad> bind(const Model&) const override { return std::make_unique<Bound>(effort_, jumps_); }

 private:
  class Bound final : public BoundLoad {
   public:
    Bound(std::function<double(double)> effort, std::vector<double> jumps)
        : effort_(std::move(effort)), jumps_(std::move(jumps)) {}
    std::size_t scratch() const override { return 0; }
    void add(double t, std::span<const double>, std::span<const double>, std::span<double> efforts,
             std::span<double>) const noexcept override {
      efforts[0] += effort_(t);
    }
    std::vector<double> discontinuities() const override { return jumps_; }
    double end() const override { return 0; }
    void begin(State&) const override {}

   private:
    std::function<double(double)> effort_;
    std::vector<double> jumps_;
  };
  std::function<double(double)> effort_;
  std::vector<double> jumps_;
};

/// y: hinge angle x, mode q; their rates; work. The body "boom" is 2 m long and its tip moves by q.
inline Model boom() {
  Registry registry = registry_of({&withy_plugin_hinges});
  const Value axis = Value::list({Value(0.0), Value(0.0), Value(1.0)});
  return Model(
      {test_node("boom", test_rod(1, 2, 1))},
      {{.name = "axle", .hinge = make_plugin<Hinge>(registry, "revolute", {{"axis", axis}}), .offset = {}, .child = 0}},
      Vector3::Zero());
}

/// ẍ = the loads' effort, q̈ = acceleration(t, q, q̇): two systems side by side, unit masses.
inline FunctionEquations boom_equations(const Model& model,
                                        std::function<double(double t, double q, double rate)> acceleration) {
  FunctionEquations e(model.layout(), [&model, acceleration](double t, std::span<const double> y, std::span<double> f) {
    f[0] = y[2];
    f[1] = y[3];
    double effort[2] = {0, 0};
    for (const LoadNode& node : model.loads()) node.load->add(t, y.first(2), y.subspan(2, 2), effort, {});
    f[2] = effort[0];
    f[3] = acceleration(t, y[1], y[3]);
    f[4] = effort[0] * y[2];
    return Evaluation{};
  });
  e.load_efforts_ = [&model](double t, std::span<const double> y, int load, std::span<double> efforts) {
    for (std::size_t i = 0; i < model.loads().size(); ++i) {
      if (load < 0 || i == static_cast<std::size_t>(load))
        model.loads()[i].load->add(t, y.first(2), y.subspan(2, 2), efforts, {});
    }
  };
  return e;
}

inline State boom_state(double x, double q, double x_rate = 0, double q_rate = 0) {
  return {0, {x, q, x_rate, q_rate, 0}};
}

/// Options of a run to `end` with this interval of outputs [s].
inline RunOptions until(double end, double output = 0.01) {
  RunOptions options;
  options.end = end;
  options.output = output;
  return options;
}

/// Runs with dopri5 at rtol = atol = 1e-9 unless another integrator is given.
struct Runner {
  explicit Runner(RunOptions o, std::unique_ptr<Integrator> i = nullptr)
      : options(std::move(o)), integrator(std::move(i)) {
    if (!integrator) integrator = make_integrator("dopri5", {{"rtol", Value(1e-9)}, {"atol", Value(1e-9)}});
  }
  RunSummary operator()(const Model& model, const EquationsOfMotion& equations, const State& start) {
    outputs.clear();
    return simulate(model, equations, *integrator, start, options, [this](const State& s) { outputs.push_back(s); });
  }

  RunOptions options;
  std::unique_ptr<Integrator> integrator;
  std::vector<State> outputs;
};

}  // namespace withy
