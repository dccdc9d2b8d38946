#include "withy/study/certificate.hpp"

#include <cmath>
#include <limits>

#include "withy/core/plugin/formulation.hpp"

namespace withy::study {
namespace {

void add_stretches(Certificate& c, const Prepared& prepared, const EscalatedRun& run) {
  for (const Stretch& s : run.stretches) c.stretches.push_back({prepared.rungs[s.rung].name, s});
  c.discarded_evaluations = run.discarded_evaluations;
}

}  // namespace

Certificate certify(const Prepared& prepared, Evidence evidence, Registry& registry) {
  const Scene& scene = prepared.scene;
  const RunSummary& summary = *evidence.summary;
  Certificate c;
  c.formulation = scene.formulation_name;
  if (const auto* plugin = registry.find<Formulation>(scene.formulation_name)) c.meaning = plugin->summary;
  const Rung* last = nullptr;  // what a run that changes its formulation ended in
  if (evidence.escalated != nullptr) {
    last = &prepared.rungs[evidence.escalated->stretches.back().rung];
    add_stretches(c, prepared, *evidence.escalated);
  }
  c.compiled = (last != nullptr ? *last->equations : *prepared.equations).savings();
  c.energy_drift = summary.energy_drift;
  // Digits lost in solving for accelerations: no result is better than this, whatever the integrator's tolerance.
  if (const double condition = summary.conditioning.condition; condition > 0)
    c.rounding = condition * std::numeric_limits<double>::epsilon();
  c.samples = summary.validity.samples;
  c.bodies = summary.validity.bodies;
  if (evidence.beyond != nullptr) c.against = evidence.beyond->formulation;
  c.neglected = summary.validity.neglected;
  c.estimate = std::move(evidence.estimate);
  c.steps = step_limit(prepared, summary, registry);
  c.indicators = indicators(scene, summary, last != nullptr ? std::optional(last->terms) : std::nullopt);
  return c;
}

std::size_t greatest_share(const LoadRatio& load) {
  std::size_t most = 0;
  for (std::size_t k = 1; k < motion_terms; ++k)
    if (std::abs(load.shares[k]) > std::abs(load.shares[most])) most = k;
  return most;
}

}  // namespace withy::study
