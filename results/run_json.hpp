/// \file
/// A run and a state as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "withy/core/simulation/output_statistics.hpp"
#include "withy/scene/scene.hpp"

namespace withy {

/// What run.json holds of a run, but for its certificate; see docs/results.md.
nlohmann::ordered_json run_json(const Scene& scene, const RunSummary& summary);

/// `min` and `max` with their times, `mean`, `rms` and `integral` of each number, by its name.
nlohmann::ordered_json statistics_json(const std::vector<OutputStatistics>& outputs);

/// A state as JSON, in the form that `initial` and --state read.
nlohmann::ordered_json state_json(const Model& model, const State& state);

}  // namespace withy
