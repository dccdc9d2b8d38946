/// \file
/// Some of the states that a run goes through, for what is looked up along its motion afterwards.
#pragma once

#include <cstddef>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/memory.hpp"

namespace withy {

/// Keeps every n-th accepted state of a run, n the least power of two that makes them `most`, an even number, or fewer:
/// steps are short where much happens, so there are more states there. The same states on every machine, at every
/// output interval. Allocates nothing after construction.
class StatesAlong {
 public:
  /// \param size of a state; 0: keeps none
  StatesAlong(std::size_t size, std::size_t most) : most_(most), row_(size > 0 ? size + 1 : 0), kept_(most * row_) {}
  /// At each accepted state, in the order of time.
  void observe(const State& state);
  /// Those before `last`, and `last` itself if it is `included`.
  [[nodiscard]] std::vector<State> until(const State& last, bool included) const;
  /// What has been kept so far.
  void remember(Memory& memory);

 private:
  std::size_t most_, row_;
  std::vector<double> kept_;  ///< rows of time and y
  std::size_t rows_ = 0, seen_ = 0, every_ = 1;
};

}  // namespace withy
