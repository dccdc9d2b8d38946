/// \file
/// How far the motion of some equations is from that of others of the same model: both integrated together.
#pragma once

#include <functional>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/integrator.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {

struct PairedRunOptions {
  double end = 0;                     ///< [s]
  double output = 0.01;               ///< interval of outputs [s]
  bool at_steps = false;              ///< outputs are ends of steps, at least the interval apart: nothing interpolates
  std::size_t most_evaluations = 0;   ///< of both together as one; 0: unlimited
  std::function<bool()> interrupted;  ///< asked between steps
};

struct PairedRun {
  double until = 0;  ///< time reached [s]: the end, unless stepping failed or the evaluations were spent
  std::size_t evaluations = 0;
  double cpu_seconds = 0;
};

/// Tolerances that suffice for a pair whose motion a run has shown: 1e-4 of the motion, and of elastic coordinates 1e-3
/// of the smallest peak deflection.
struct PairedTolerances {
  double rtol = 1e-4;
  double atol = 1e-5;
};
PairedTolerances paired_tolerances(const RunSummary& summary);

/// Integrates both from `initial` with common steps. Where the equations differ by little, so do their solutions, and
/// the errors of a common step are nearly the same in both: the difference is right to a relative accuracy of about the
/// integrator's, however small it is, and a coarse integrator serves. `output` receives both states at the start, at
/// the multiples of the output interval and at the end, works from zero on; that of the second is known where steps are
/// linearly implicit (CoarseSteps), else zero. \throws std::invalid_argument where a load has switching functions: both
/// would switch at times of their own.
PairedRun run_paired(const Model& model, const EquationsOfMotion& first, const EquationsOfMotion& second,
                     const Integrator& integrator, const State& initial, const PairedRunOptions& options,
                     const std::function<void(const State& first, const State& second)>& output);

}  // namespace withy
