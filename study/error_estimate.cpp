#include "withy/study/error_estimate.hpp"

#include "withy/core/simulation/paired_run.hpp"

namespace withy::study {

ErrorEstimate estimate_error(const Scene& scene, const EquationsOfMotion& used, const Beyond& beyond,
                             const RunSummary& summary, Registry& registry, const std::function<bool()>& interrupted) {
  const PairedTolerances coarse = paired_tolerances(summary);
  const auto integrator =
      make_integrator(registry, "dopri5", Value::map({{"rtol", Value(coarse.rtol)}, {"atol", Value(coarse.atol)}}));
  PairedRunOptions options;
  options.end = summary.final.time;
  options.output = scene.output;
  options.most_evaluations = summary.steps.evaluations;
  options.interrupted = interrupted;
  const Outputs outputs = Outputs::all(*scene.model);
  OutputReader ours(outputs, *scene.model, used), theirs(outputs, *beyond.model, *beyond.equations);
  Distances greatest = outputs.none();
  const PairedRun run =
      run_paired(*scene.model, used, *beyond.equations, *integrator, scene.initial, options,
                 [&](const State& a, const State& b) { outputs.raise(ours.read(a), theirs.read(b), greatest); });
  return {beyond.formulation, named(outputs, greatest, run.until), summary.final.time, run.cpu_seconds};
}

}  // namespace withy::study
