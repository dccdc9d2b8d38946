/// \file
/// A run that another looks at step by step.
#pragma once

#include <functional>

#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {

/// Sees what a run does between its outputs. Changes nothing.
class StepWatch {
 public:
  virtual ~StepWatch() = default;
  /// At the start, and where something has jumped: what follows is not smooth with what was before.
  virtual void begin_at(const State& state) = 0;
  /// After each accepted step, which the stepper can interpolate.
  virtual void observe(const Stepper& stepper) = 0;
  /// For checkpoints of the run.
  virtual void remember(Memory& memory) = 0;
};

/// How much of a run is looked at.
enum class Attention {
  whole,
  /// How it ends, how far its bodies are deflected, and its energy. RunSummary::momentum and the peaks of efforts stay
  /// empty, and of a run that ends well `validity` and `conditioning` as well, and `fastest_mode` 0: all of that takes
  /// more than a fifth of a short run's time.
  outcome
};

/// As without a watch, which may be null. The motion and what ends it do not depend on the attention.
RunSummary simulate(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator,
                    const State& initial, const RunOptions& options, const std::function<void(const State&)>& output,
                    StepWatch* watch, Attention attention = Attention::whole);

}  // namespace withy
