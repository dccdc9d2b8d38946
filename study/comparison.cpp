#include "withy/study/comparison.hpp"

#include <algorithm>

#include "withy/study/check_loads.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/walk.hpp"

namespace withy::study {
namespace {

Readings read(const Outputs& outputs, const ComparedRun& run) {
  OutputReader reader(outputs, run.prepared.model(), *run.prepared.equations, run.prepared.scene.outputs);
  Readings readings;
  for (const State& s : run.outputs) {
    readings.times.push_back(s.time);
    readings.values.push_back(reader.read(s));
  }
  return readings;
}

/// What distances are of.
Outputs measured(const Comparison& comparison, const ComparedRun& run) {
  return comparison.outputs.empty() ? Outputs::all(run.prepared.model())
                                    : Outputs(run.prepared.model(), comparison.outputs, run.prepared.scene.outputs);
}

}  // namespace

std::vector<Comparison::OutputError> Comparison::output_errors(const ComparedRun& run) const {
  if (outputs.empty()) return {};
  const Outputs asked = measured(*this, run);
  const Readings own = read(asked, run), truth = read(asked, runs[reference]);
  const Distances greatest = study::distances(asked, own, truth).first;
  Distances ranges = asked.none();
  for (std::size_t i = 0; i < std::min(own.values.size(), truth.values.size()); ++i)
    asked.raise_ranges(truth.values[i], truth.values.front(), ranges);
  std::vector<OutputError> errors;
  for (std::size_t i = 0; i < greatest.size(); ++i)
    errors.push_back({asked.list()[i].label, asked.list()[i].unit, greatest[i], ranges[i]});
  return errors;
}

bool Comparison::has_distances(const ComparedRun& run) const {
  if (!has_reference()) return false;
  const std::vector<State>&own = run.outputs, &truth = runs[reference].outputs;
  return own.size() > 1 && truth.size() > 1 && own[1].time == truth[1].time;
}

NamedDistances Comparison::distances(const ComparedRun& run) const {
  const Outputs asked = measured(*this, run);
  const auto [greatest, until] = study::distances(asked, read(asked, run), read(asked, runs[reference]));
  return named(asked, greatest, until);
}

Comparison compare(const SceneValues& values, Registry& registry, const std::vector<std::string>& formulations,
                   const std::string& reference, const Simulator& simulator, const std::vector<std::string>& outputs) {
  std::vector<std::string> all = formulations;
  Comparison c;
  c.outputs = outputs;
  const auto found = std::find(all.begin(), all.end(), reference);
  c.reference = static_cast<std::size_t>(found - all.begin());
  if (found == all.end()) all.push_back(reference);
  // What cannot be is said before anything is run.
  std::vector<Prepared> scenes;
  for (const std::string& formulation : all) {
    SceneValues chosen = values;
    chosen.choose_formulation(formulation, "the formulation '" + formulation + "' of the comparison");
    scenes.push_back(prepare(std::move(chosen), registry));
    check_integrator(scenes.back());
  }
  check_loads(scenes.front());
  for (Prepared& scene : scenes) {
    ComparedRun run{std::move(scene), {}, {}};
    if (c.runs.empty()) static_cast<void>(measured(c, run));  // and so are bad names
    run.summary = simulator(run.prepared, [&](const State& s) { run.outputs.push_back(s); });
    c.runs.push_back(std::move(run));
    if (c.interrupted()) break;
  }
  c.listed = std::min(formulations.size(), c.runs.size());
  return c;
}

}  // namespace withy::study
