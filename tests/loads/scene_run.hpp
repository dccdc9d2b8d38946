/// \file
/// Scenes written in a test, run to their end.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/core/simulation/simulate.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::test {

/// A scene with its equations.
struct LoadedScene {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;

  /// `overrides` as those of `--set`.
  explicit LoadedScene(const std::string& text, const std::vector<std::string>& overrides = {}) {
    enroll_static_plugins(registry);
    scene = parse_scene(text, "test.yaml", registry, {"", "", overrides});
    equations = scene.formulation->compile(scene.model);
  }
  const Slot& hinge(const std::string& name) const { return *scene.model->layout().hinge(name); }
  double position(const State& s, const std::string& name) const { return s.y[hinge(name).position]; }
  double rate(const State& s, const std::string& name) const {
    return s.y[scene.model->layout().positions + hinge(name).speed];
  }

  /// Every output; the run must complete.
  std::vector<State> run() {
    std::vector<State> outputs;
    RunOptions options;
    options.end = end_of_run(scene);
    options.output = scene.output;
    options.events = scene.events;
    summary = simulate(*scene.model, *equations, *scene.integrator, scene.initial, options,
                       [&](const State& s) { outputs.push_back(s); });
    EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
    return outputs;
  }
  RunSummary summary;
};

/// A table of J = 0.2 kg m² that turns about the vertical; loads follow.
inline const std::string turntable = R"(format: withy/1
time: {end: 2, output: 0.01}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
)";

/// Text of a scene that comes along.
inline std::string shipped(const std::string& name) {
  const std::string path = WITHY_SOURCE_DIRECTORY "/scenes/" + name;
  std::ifstream stream(path, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  if (!stream) throw std::runtime_error("cannot read " + path);
  return text.str();
}

/// What a bad scene is answered with; empty where it is good.
inline std::string problem_of(const std::string& text) {
  try {
    const LoadedScene loaded(text);
  } catch (const SceneError& e) {
    return e.what();
  }
  return {};
}

}  // namespace withy::test
