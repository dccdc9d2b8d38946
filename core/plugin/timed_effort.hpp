/// \file
/// Loads that are a function of time alone.
#pragma once

#include <cstddef>
#include <memory>

namespace withy {

/// What a BoundLoad is as well whose `add` adds one effort, a function of time alone, to one speed and does nothing
/// else. Where cases are evaluated together, one that asks for a time again, or for that of another case with the same
/// law, gets the number that was found then: the same bits.
class TimedEffort {
 public:
  virtual ~TimedEffort() = default;
  /// Index of the speed.
  [[nodiscard]] virtual std::size_t speed() const = 0;
  /// The effort [N m, N] at time t [s].
  [[nodiscard]] virtual double effort(double t) const noexcept = 0;
  /// Equal for loads with one law: at each time their efforts are equal to the last bit. Who holds it may outlive the
  /// load, and what was found of it then holds for the next load that has it.
  [[nodiscard]] virtual std::shared_ptr<const void> law() const = 0;
};

}  // namespace withy
