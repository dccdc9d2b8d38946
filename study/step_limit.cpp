#include "withy/study/step_limit.hpp"

#include <stdexcept>

#include "withy/core/analysis/fastest_pole.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy::study {
namespace {

/// Loads count: what a servo does is not among the vibrations of the modes. Models too large to be looked at as a whole
/// keep the fastest mode.
void find_fastest(const Prepared& prepared, const RunSummary& summary, StepLimit& s) {
  const Model& model = prepared.model();
  if (model.layout().speeds > largest_examined || s.mean == 0 || !loops_of(model).empty()) return;
  try {
    const TangentDynamics dynamics(prepared.scene.model, prepared.scene.formulation->terms());
    const FastestPole pole = fastest_pole(dynamics, summary.final, driven_speeds(model, summary.final));
    if (!(std::abs(pole.value) > 0)) return;
    s.fastest = std::abs(pole.value);
    s.product = s.mean * s.fastest;
    s.maker = describe(pole, model.layout());
    s.made_by_load = pole.cause.find(" of load ") != std::string::npos;
  } catch (const std::domain_error&) {
    // At the end of a run that failed there may be no derivatives: the fastest mode is all that is known.
  }
}

}  // namespace

std::string StepLimit::cause() const {
  // Of the greatest stable step: the mean of steps that go to and fro about it lies above this share.
  constexpr double near_limit = 0.6;
  if (!limit || product == 0) return "unknown";
  return product > near_limit * *limit ? "stability" : "accuracy";
}

StepLimit step_limit(const Integrator& integrator, double start, const RunSummary& summary) {
  StepLimit s;
  s.limit = integrator.stability_limit();
  // What never moves is no measure of what its steps are limited by.
  if (summary.steps.accepted == 0 || summary.energy_scale == 0) return s;
  s.mean = (summary.reached - start) / static_cast<double>(summary.steps.accepted);
  s.fastest = summary.fastest_mode;
  s.product = s.mean * s.fastest;
  return s;
}

StepLimit step_limit(const Prepared& prepared, const RunSummary& summary, Registry& registry) {
  const Scene& scene = prepared.scene;
  StepLimit s = step_limit(*scene.integrator, scene.initial.time, summary);
  find_fastest(prepared, summary, s);
  if (s.cause() != "stability") return s;
  const EquationsOfMotion& equations = *prepared.equations;
  if (!s.made_by_load) s.fewer = best_slowing(*scene.model, equations.system(summary.final.time, summary.final.y));
  // Those with error control, so that no step need be chosen. The first folds stiffness into a symmetric mass matrix.
  for (const std::string id : {"imex", "radau"}) {
    // imex treats stiffness and damping of bodies implicitly, and loads explicitly.
    if (id == "imex" && s.made_by_load) continue;
    const bool able = id != "imex" || equations.linearly_implicit() != nullptr;
    if (able && registry.find<Integrator>(id) != nullptr) s.unlimited.push_back(id);
  }
  return s;
}

}  // namespace withy::study
