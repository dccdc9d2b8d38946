/// \file
/// Runs of a scene at the times of measured data.
#pragma once

#include <string>
#include <vector>

#include "withy/campaign/measured.hpp"
#include "withy/scene/scene.hpp"
#include "withy/study/control.hpp"

namespace withy::campaign {

/// What a run gives where something was measured.
struct MatchedRun {
  std::vector<std::vector<double>> columns;  ///< one a column of the data, a number for each time; SI
  std::string failure;                       ///< why there is no such run; empty where there is
  bool interrupted = false;
  [[nodiscard]] bool ok() const { return failure.empty() && !interrupted; }
};

/// Runs the scene to the last time of the data, with the steps of a run to the scene's end, and reads it as the rows of
/// that run would show it: between steps on the dense output of the integrator, at an instant (a sample, an event,
/// times that rounding alone tells apart from it) what was until then, at the scene's end what is from then on. A scene
/// that cannot be made, or a run that does not come so far, is a failure; nothing is thrown. \throws PluginError
MatchedRun matched_run(const SceneValues& scene, Registry& registry, const Measured& data,
                       const study::Control& control);

/// Several of them, `jobs` at once; each is the same, bit by bit, however many.
std::vector<MatchedRun> matched_runs(const std::vector<SceneValues>& scenes, Registry& registry, const Measured& data,
                                     std::size_t jobs, const study::Control& control);

}  // namespace withy::campaign
