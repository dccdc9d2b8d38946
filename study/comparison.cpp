#include "withy/study/comparison.hpp"

#include <algorithm>

#include "withy/study/walk.hpp"

namespace withy::study {
namespace {

Readings read(const Outputs& outputs, const ComparedRun& run) {
  OutputReader reader(outputs, run.prepared.model(), *run.prepared.equations);
  Readings readings;
  for (const State& s : run.outputs) {
    readings.times.push_back(s.time);
    readings.values.push_back(reader.read(s));
  }
  return readings;
}

}  // namespace

NamedDistances Comparison::distances(const ComparedRun& run) const {
  const Outputs outputs = Outputs::all(run.prepared.model());
  const auto [greatest, until] = study::distances(outputs, read(outputs, run), read(outputs, runs[reference]));
  return named(outputs, greatest, until);
}

Comparison compare(const SceneValues& values, Registry& registry, const std::vector<std::string>& formulations,
                   const std::string& reference, const Simulator& simulator) {
  std::vector<std::string> all = formulations;
  Comparison c;
  const auto found = std::find(all.begin(), all.end(), reference);
  c.reference = static_cast<std::size_t>(found - all.begin());
  if (found == all.end()) all.push_back(reference);
  for (const std::string& formulation : all) {
    SceneValues chosen = values;
    chosen.choose_formulation(formulation, "the formulation '" + formulation + "' of the comparison");
    ComparedRun run{prepare(std::move(chosen), registry), {}, {}};
    run.summary = simulator(run.prepared, [&](const State& s) { run.outputs.push_back(s); });
    c.runs.push_back(std::move(run));
    if (c.interrupted()) break;
  }
  c.listed = std::min(formulations.size(), c.runs.size());
  return c;
}

}  // namespace withy::study
