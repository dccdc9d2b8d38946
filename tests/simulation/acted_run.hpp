/// \file
/// Scenes with events that act, run to their end.
#pragma once

#include <string>
#include <vector>

#include "made_scene.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::test {

/// A scene run to its end.
struct ActedRun : Made {
  explicit ActedRun(const std::string& text, const std::string& formulation = "") : Made(text, formulation) {
    RunOptions options;
    options.end = end_of_run(scene);
    options.output = scene.output;
    options.events = scene.events;
    summary = simulate(*scene.model, *equations, *scene.integrator, scene.initial, options,
                       [&](const State& s) { outputs.push_back(s); });
  }
  double position(const std::string& hinge, const State& s) const {
    return s.y[scene.model->layout().hinge(hinge)->position];
  }
  double rate(const std::string& hinge, const State& s) const {
    return s.y[scene.model->layout().positions + scene.model->layout().hinge(hinge)->speed];
  }
  double rate(const std::string& hinge) const { return rate(hinge, summary.final); }
  EventNumbers event(std::size_t index) const { return EventBook(*scene.model).numbers(summary.final.y, index); }
  Energies energies(const State& s) const { return equations->energies(s.y); }
  RunSummary summary;
  std::vector<State> outputs;
};

/// Discs of 0.2 and 0.3 kg m² on one axis, the second carried by the first; events follow.
inline std::string discs(const std::string& rest) {
  return R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-11, atol: 1e-13}
bodies:
  one: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  two: {type: rigid, mass: 1, inertia: [0.2, 0.2, 0.3, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: one}
  clutch: {type: revolute, axis: [0, 0, 1], parent: one, child: two}
initial: {hinges: {axle: {rate: [1]}, clutch: {rate: [4]}}}
)" + rest;
}

/// A satellite whose boom swings out on a spring; events follow.
inline std::string deployment(const std::string& rest) {
  return R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies:
  bus: {type: rigid, mass: 20, inertia: [3, 4, 5, 0.1, 0, 0], frames: {out: {position: [0.5, 0.1, 0]}}}
  boom:
    type: beam
    length: 2
    mass_per_length: 0.8
    bending_y: {stiffness: 60, modes: 2}
    bending_z: {stiffness: 90, modes: 1}
  tip: {type: rigid, mass: 1.5, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  base: {type: free, parent: world, child: bus}
  root: {type: revolute, axis: [0, 0, 1], parent: bus.out, child: boom}
  end: {type: weld, parent: boom.tip, child: tip}
loads: {motor: {type: hinge-spring, hinge: root, stiffness: 4, free_position: 110 deg}}
initial: {hinges: {base: {rate: [0.05, 0.1, 0.2, 0.3, -0.2, 0.1]}}}
time: {end: 4, output: 0.1}
)" + rest;
}

}  // namespace withy::test
