/// \file
/// Runs a model in the least formulation that its motion allows, and goes over to the next where an indicator of
/// validity passes its limit. Coordinates are the same in all formulations, so a state is handed over as it is.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "withy/core/plugin/terms.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {

/// A formulation that a run may be in; each keeps more than the one before it.
struct Rung {
  std::string name;
  Terms terms;
  const EquationsOfMotion* equations = nullptr;
};

/// An indicator past its limit.
struct Excess {
  std::string body;
  std::string indicator;  ///< "rate over fundamental frequency", "load over buckling load", "deflection over length"
  double value = 0, limit = 0;
  double time = 0;  ///< [s]
};

/// A part of a run in one formulation.
struct Stretch {
  std::size_t rung = 0;
  double start = 0, end = 0;  ///< [s]
  std::size_t steps = 0, evaluations = 0;
  double energy_drift = 0;     ///< as RunSummary::energy_drift, within the stretch
  std::vector<Excess> excess;  ///< why it ended; empty: it is the last
  /// What the next formulation counts as energy at the end of the stretch beyond what this one does [J].
  double energy_jump = 0;
};

struct EscalatedRun {
  /// Of all stretches: peaks and indicators are the greatest, costs the sums; conditioning is that of the last. Drift
  /// is the greatest of a stretch, whose energies are those of its own formulation.
  RunSummary summary;
  std::vector<Stretch> stretches;         ///< one that was left at once has no duration
  std::size_t discarded_evaluations = 0;  ///< spent beyond a limit, or to find where it is passed
};

/// The indicators of a state that are past the limits of a formulation.
class LimitWatch {
 public:
  explicit LimitWatch(const Model& model);
  ~LimitWatch();
  [[nodiscard]] std::vector<Excess> excess(const State& state, const Rung& used, const Terms& limits_of);

 private:
  struct Watched;
  const Model& model_;
  std::unique_ptr<Watched> watched_;
};

/// As `simulate`, beginning with the first formulation whose limits hold. Indicators are looked at at every output.
/// Where one passes, the run is taken back to the last output at which all held, by running up to there once more, so
/// that neither an output nor a peak comes from beyond a limit; there the least formulation goes on whose limits hold
/// where the one before failed, or the last. The same input gives the same bits. `output` is told the rung as well.
/// Events are those of what is kept; there are no checkpoints.
/// \throws std::invalid_argument as `simulate`, where there is no rung, a load of the model has discrete states (they
/// are renewed where a run begins), or the options ask for a checkpoint.
EscalatedRun simulate_escalating(const Model& model, const std::vector<Rung>& rungs, const Integrator& integrator,
                                 const State& initial, const RunOptions& options,
                                 const std::function<void(const State&, std::size_t rung)>& output);

}  // namespace withy
