/// \file
/// A run of a scene with its certificate.
#pragma once

#include <functional>
#include <string>

#include "withy/core/simulation/output_statistics.hpp"
#include "withy/study/certificate.hpp"
#include "withy/study/control.hpp"

namespace withy::study {

/// When the error against the next model up is estimated.
enum class Estimate {
  automatic,  ///< against `quadratic`; against `exact` it costs more than it tells of most runs
  always,
  never
};

struct RunSettings {
  Estimate estimate = Estimate::automatic;
  /// Whether accelerations are compared with the next model up along the run; without it there is no estimate either.
  bool look_beyond = true;
  /// Receives every output, with the rung that a run of `auto` is in, else 0; may be empty.
  std::function<void(const State&, std::size_t rung)> output;
  /// Brought to the state of each output before it is given; of a run that has one formulation. May be null.
  Observation* seen = nullptr;
  double checkpoint_seconds = 0;                      ///< wall time between checkpoints; 0: only where interrupted
  std::function<void(const Checkpoint&)> checkpoint;  ///< takes them; may be empty
  const Checkpoint* resume = nullptr;                 ///< where to go on; null: at the scene's initial state
  /// Set at the end of a run: of the outputs for which the scene asks for them. Null: they are not wanted.
  std::vector<OutputStatistics>* statistics = nullptr;
  std::vector<std::string> watched;  ///< names of outputs besides those whose statistics are wanted
  Control control;
};

struct CertifiedRun {
  RunSummary summary;
  Certificate certificate;
};

/// Refuses an integrator that cannot treat these equations. \throws SceneError with its place
void check_integrator(const Prepared& prepared);
/// \throws SceneError with the integrator's place and plugin: it does `deed`, as IntegratorError says
[[noreturn]] void refuse_integrator(const Prepared& prepared, const std::string& deed);

/// Refuses what no run can begin with: a tolerance below what the mass matrix leaves to be had, a start at which that
/// is singular, an integrator that cannot treat these equations, loads that are wrong about themselves (check_loads).
/// \throws SceneError with its place
void check_start(const Prepared& prepared);

/// Simulates from the scene's initial state to its end, measures what is left out on the way, and estimates its effect
/// afterwards. Of `auto` the error is estimated and its formulations are chosen before; a run that comes to the end and
/// does not hold the accuracy asked, or cannot know it, is inaccurate.
/// \throws SceneError where the scene has no end, or the integrator fails on the way.
CertifiedRun run(const Prepared& prepared, Registry& registry, const RunSettings& settings = {});

/// "completed", "completed by an event at 0.56 s", or "diverged at 0.0523 s".
std::string outcome_text(const RunSummary& summary);

/// The run alone, with no more than its outputs.
RunSummary simulate(const Prepared& prepared, Registry& registry, const std::function<void(const State&)>& output,
                    const Control& control = {});

}  // namespace withy::study
