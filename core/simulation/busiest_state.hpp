/// \file
/// The state of a stretch of a run in which most happens, found at the price of a few numbers a step.
#pragma once

#include <cstddef>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/memory.hpp"

namespace withy {

/// Of the accepted states since the last look that with the greatest Σᵢ (u̇ᵢ/âᵢ)² + (uᵢ/ûᵢ)², where âᵢ and ûᵢ are the
/// greatest |u̇ᵢ| and |uᵢ| of the run up to there: forces on bodies are greatest where accelerations or rates are. u̇ is
/// a difference over the two steps around a state, for which nothing is evaluated, so a state is judged once the next
/// is there. Coordinates are compared with themselves alone: units change nothing. Allocates nothing after
/// construction.
class BusiestState {
 public:
  /// \param first of the speeds among the elements of y
  /// \param size of y
  BusiestState(std::size_t first, std::size_t speeds, std::size_t size);
  /// At the start, and where speeds jump: what comes next is no acceleration since then.
  void begin_at(const State& state);
  /// At each accepted state, in the order of time.
  void observe(const State& state);
  /// Null: none has been judged since the last look.
  [[nodiscard]] const State* found() const { return busyness_ > 0 ? &busiest_ : nullptr; }
  void look_taken() { busyness_ = 0; }
  /// What has been seen so far.
  void remember(Memory& memory);

 private:
  /// Of the last state, which lies between the one before and `next`.
  double busyness(const State& next);

  std::size_t first_;
  std::vector<double> greatest_rates_, greatest_speeds_;
  State last_;
  double before_ = 0;  ///< time of the state before that [s]
  std::vector<double> speeds_before_;
  bool judged_ = false;  ///< there is a state before the last one
  State busiest_;
  double busyness_ = 0;
};

}  // namespace withy
