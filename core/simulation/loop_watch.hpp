/// \file
/// Watches that closed loops keep their rank along a run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/memory.hpp"

namespace withy {

/// Goes from one accepted state to the next.
class LoopWatch {
 public:
  LoopWatch(const EquationsOfMotion& equations, const State& initial);
  /// Why the run cannot go on from this state; empty where it can, and of trees.
  [[nodiscard]] std::string fault(const State& state);
  void remember(Memory& memory);

 private:
  const ClosedLoops* loops_;
  Work work_;
  State last_;
  std::size_t rank_ = 0;  ///< of the closing equations at the start
};

/// What closing has changed in a run, in a sentence; empty of trees.
std::string closing_text(const EquationsOfMotion& equations, const Stepper& stepper);

}  // namespace withy
