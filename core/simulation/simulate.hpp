/// \file
/// Runs a model from a state to a time, watching what can go wrong: the loop that applications embed.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "withy/core/dynamics/equations.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/integrator.hpp"

namespace withy {

/// How a run ended.
enum class RunStatus { completed, diverged, singular, step_underflow, interrupted };
/// "completed", "diverged", "singular", "step-underflow", "interrupted".
std::string_view name(RunStatus status);

struct RunOptions {
  double end = 0;                 ///< [s]
  double output = 0.01;           ///< interval of outputs [s]; the end is always one
  double deflection_limit = 1.0;  ///< a deflection past this many lengths of its body is divergence
  std::size_t most_steps = 100'000'000;
  double most_seconds = 0;            ///< wall time; 0: unlimited
  std::function<bool()> interrupted;  ///< asked between steps
};

/// What a run leaves behind, whatever its end.
struct RunSummary {
  RunStatus status = RunStatus::completed;
  std::string message;  ///< the physical reason, in a sentence or two
  State final;          ///< the last accepted state
  /// Greatest |deflection| of each beam's tip over all accepted steps, body axes x, y, z [m].
  std::map<std::string, std::array<double, 3>> peak_deflection;
  /// Greatest |effort| of the loads on each generalized speed over all accepted steps [N m, N].
  std::vector<double> peak_effort;
  /// Greatest |E(t) − E(0) − work| over the outputs, relative to the greatest of |E|, |work| and kinetic energy seen.
  double energy_drift = 0;
  Conditioning conditioning;  ///< at the final state
  StepStatistics steps;
  double cpu_seconds = 0;
};

/// Integrates from `initial`; `output` receives the state at 0, at every multiple of the output interval and at the
/// end.
RunSummary simulate(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator,
                    const State& initial, const RunOptions& options, const std::function<void(const State&)>& output);

}  // namespace withy
