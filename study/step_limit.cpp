#include "withy/study/step_limit.hpp"

namespace withy::study {

std::string StepLimit::cause() const {
  // Of the greatest stable step: the mean of steps that go to and fro about it lies above this share.
  constexpr double near_limit = 0.6;
  if (!limit || product == 0) return "unknown";
  return product > near_limit * *limit ? "stability" : "accuracy";
}

StepLimit step_limit(const Integrator& integrator, double start, const RunSummary& summary) {
  StepLimit s;
  s.limit = integrator.stability_limit();
  if (summary.steps.accepted == 0) return s;
  s.mean = (summary.final.time - start) / static_cast<double>(summary.steps.accepted);
  s.fastest = summary.fastest_mode;
  s.product = s.mean * s.fastest;
  return s;
}

StepLimit step_limit(const Prepared& prepared, const RunSummary& summary, Registry& registry) {
  const Scene& scene = prepared.scene;
  StepLimit s = step_limit(*scene.integrator, scene.initial.time, summary);
  if (s.cause() != "stability") return s;
  const EquationsOfMotion& equations = *prepared.equations;
  s.fewer = best_slowing(*scene.model, equations.system(summary.final.time, summary.final.y));
  // Those with error control, so that no step need be chosen. The first folds stiffness into a symmetric mass matrix.
  for (const std::string id : {"imex", "radau"}) {
    const bool able = id != "imex" || equations.linearly_implicit() != nullptr;
    if (able && registry.find<Integrator>(id) != nullptr) s.unlimited.push_back(id);
  }
  return s;
}

}  // namespace withy::study
