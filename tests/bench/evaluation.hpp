/// \file
/// One evaluation of a scene's equations of motion as a benchmark.
#pragma once

#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::bench {

/// A scene compiled in a formulation, at its initial state.
struct Evaluation {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  std::vector<double> y, y_dot;

  /// `text`: of the scene.
  Evaluation(const std::string& text, const std::string& formulation) {
    enroll_static_plugins(registry);
    scene = parse_scene(text, "benchmark", registry, {formulation, "", {}});
    equations = scene.formulation->compile(scene.model);
    y = scene.initial.y;
    y_dot.assign(equations->size(), 0.0);
  }
  [[nodiscard]] std::size_t first_speed() const { return equations->layout().positions; }

  /// Each evaluation waits for the one before, as in an integration.
  void time(benchmark::State& state) {
    Work work = equations->make_work();
    const std::vector<double> start = y;
    double s = 0;
    for (auto _ : state) {
      y[0] = start[0] + 1e-12 * s;
      if (!equations->derivatives(0, y, y_dot, work).ok()) state.SkipWithError("the equations cannot be evaluated");
      s = y_dot[first_speed()];
    }
    benchmark::DoNotOptimize(s);
    y = start;
  }
};

}  // namespace withy::bench
