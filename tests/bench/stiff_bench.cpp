/// \file
/// Implicit integrators against dopri5: CPU time to a tip error of 1e-4 of the arm's length, on the driven arm with 2,
/// 4 and 8 modes a link, as it is and with links a hundred times as stiff, and on the spacecraft with booms that twist.
/// `bench-stiff` prints the table of docs/integrators.md; `bench-stiff 8` that of the problems whose titles have an 8.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>

#include "withy/core/simulation/simulate.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace {

struct Problem {
  std::string title, file, body;
  double length, end;
  std::vector<std::string> overrides;
};

struct Outcome {
  std::array<double, 3> tip{};
  double seconds = std::numeric_limits<double>::infinity();
  std::size_t steps = 0, evaluations = 0;
  bool completed = false;
};

/// \param seconds of wall time that a run may take; 0: any
Outcome run(const Problem& problem, const std::string& integrator, int repetitions, double seconds = 60) {
  withy::Registry registry;
  withy::enroll_static_plugins(registry);
  std::ifstream file(std::string(SCENES "/") + problem.file);
  std::stringstream text;
  text << file.rdbuf();
  std::vector<std::string> overrides = problem.overrides;
  overrides.push_back("integrator=" + integrator);
  const withy::Scene scene = withy::parse_scene(text.str(), problem.file, registry, {"quadratic", "", overrides});
  const auto equations = scene.formulation->compile(scene.model);
  withy::RunOptions options;
  options.end = options.output = problem.end;
  options.most_seconds = seconds;
  Outcome o;
  double spent = 0;
  for (int i = 0; i < repetitions && spent < 1; ++i) {
    const withy::RunSummary summary =
        withy::simulate(*scene.model, *equations, *scene.integrator, scene.initial, options, {});
    o.completed = summary.status == withy::RunStatus::completed;
    o.tip = equations->frame_pose(summary.final.y, scene.model->body(problem.body), 0).position;
    o.seconds = std::min(o.seconds, summary.cpu_seconds);
    o.steps = summary.steps.accepted;
    o.evaluations = summary.steps.evaluations;
    spent += summary.cpu_seconds;
  }
  return o;
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6e", x);
  return text;
}

/// The quickest of a method's runs, over tolerances, that ends within 1e-4 of the length of where the reference does.
void compare(const Problem& problem, const std::vector<std::string>& methods) {
  const Outcome reference = run(problem, "{name: dop853, rtol: 1e-10, atol: 1e-12}", 1, 0);
  double first = 0;
  for (const std::string& method : methods) {
    Outcome best;
    double best_error = 0, best_tolerance = 0;
    for (double tolerance = 1e-1; tolerance > 2e-9; tolerance /= std::pow(10.0, 0.125)) {
      const Outcome o = run(
          problem, "{name: " + method + ", rtol: " + number(tolerance) + ", atol: " + number(tolerance / 10) + "}", 20);
      double error = 0;
      for (std::size_t i = 0; i < 3; ++i) error = std::hypot(error, o.tip[i] - reference.tip[i]);
      error /= problem.length;
      if (o.completed && error <= 1e-4 && o.seconds < best.seconds)
        best = o, best_error = error, best_tolerance = tolerance;
      // Tighter tolerances cost more; a run that is right by chance at a loose one is none to judge by alone.
      if (o.completed && (error < 1e-6 || o.seconds > 3 * best.seconds)) break;
    }
    if (first == 0) first = best.seconds;
    std::printf("%-38s %-14s rtol %.1e  error %.1e  %6zu steps %8zu evaluations %9.3f ms  %6.2f x\n",
                problem.title.c_str(), method.c_str(), best_tolerance, best_error, best.steps, best.evaluations,
                1e3 * best.seconds, first / best.seconds);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string wanted = argc > 1 ? argv[1] : "";
  const auto asked_for = [&](const Problem& p) { return p.title.find(wanted) != std::string::npos; };
  const std::vector<std::string> methods = {"dopri5", "imex", "rosenbrock-w", "radau"};
  for (const int modes : {2, 4, 8}) {
    for (const bool stiff : {false, true}) {
      Problem arm{"arm, " + std::to_string(modes) + " modes a link" + (stiff ? ", 100 times as stiff" : ""),
                  "driven-arm.yaml",
                  "payload",
                  2,
                  10,
                  {}};
      for (const char* link : {"link1", "link2"})
        arm.overrides.push_back(std::string("bodies.") + link + ".bending_y.modes=" + std::to_string(modes));
      if (stiff) {
        arm.overrides.emplace_back("bodies.link1.bending_y.stiffness=11200");
        arm.overrides.emplace_back("bodies.link2.bending_y.stiffness=1400");
      }
      if (asked_for(arm)) compare(arm, methods);
    }
  }
  const Problem spacecraft{"spacecraft, booms twist", "spacecraft.yaml", "telescope", 3, 10, {}};
  if (asked_for(spacecraft)) compare(spacecraft, methods);
  return 0;
}
