/// \file
/// Watches that closed loops keep their rank along a run.
#pragma once

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
  /// Why the run cannot go on after the stepper's last step; empty where it can, and of trees.
  [[nodiscard]] std::string fault(const Stepper& stepper);
  void remember(Memory& memory);

 private:
  /// Rank between two states of the last step; a way that is too far to tell is halved, so often at most. \returns the
  /// time up to which it is kept for sure; that of `after` where it is all the way
  double kept_until(const Stepper& stepper, const State& before, const State& after, std::size_t halvings);
  /// The same of a whole step, in parts over which no hinge of a loop turns far.
  double kept_through(const Stepper& stepper, const State& after);
  [[nodiscard]] std::size_t independent_at(const State& state);
  /// A little further on along the rates of the start, or its accelerations where it is at rest; 0 where it stays
  /// there, or there is no closed state.
  [[nodiscard]] std::size_t rank_beside(const EquationsOfMotion& equations, const State& initial);

  const ClosedLoops* loops_;
  Work work_;
  State last_;
  std::vector<State> between_;  ///< one a halving
  State from_, to_;             ///< of a part of a step
  LoopRank rank_;               ///< at the start
  bool begins_singular_ = false;
};

/// What closing has changed in a run, in a sentence; empty of trees.
std::string closing_text(const EquationsOfMotion& equations, const Stepper& stepper);

}  // namespace withy
