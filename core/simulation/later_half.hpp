/// \file
/// What the later half of a run's steps has gained.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/memory.hpp"

namespace withy {

/// Steps of a run, in two halves.
struct TwoHalves {
  double begun = 0, middle = 0, now = 0;  ///< when the first half began, the second did, and it has ended [s]
  std::size_t made = 0;                   ///< steps of both
  std::size_t later = 0;                  ///< of the second
};

/// Looks at a run each time that its steps have doubled: the mean of all of them does not tell one that has come to
/// where it crawls.
class LaterHalf {
 public:
  explicit LaterHalf(double start) : start_(start), half_time_(start) {}

  /// Nothing where the steps have not doubled since the last look, and before there are two thousand.
  /// \param stepper before each of its steps
  std::optional<TwoHalves> look(const Stepper& stepper) {
    const std::size_t made = this->made(stepper);
    ++looks_;
    if (made < 2 * half_) return {};
    const TwoHalves halves{start_, half_time_, stepper.state().time, made, made - half_};
    half_ = made;
    half_time_ = halves.now;
    return halves;
  }
  void remember(Memory& memory) {
    memory(half_);
    memory(half_time_);
    memory(looks_);
  }
  /// Steps made, as the stepper counts them or, where it counts none, as it was asked for them.
  [[nodiscard]] std::size_t made(const Stepper& stepper) const {
    return std::max(stepper.statistics().accepted, looks_);
  }

 private:
  double start_;
  std::size_t half_ = 1024;  ///< of the steps made, when they were looked at last
  double half_time_;         ///< when these were made [s]
  std::size_t looks_ = 0;
};

}  // namespace withy
