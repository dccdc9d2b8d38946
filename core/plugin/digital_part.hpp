/// \file
/// What else is known of discrete parts that work like a digital controller.
#pragma once

#include <span>

namespace withy {

/// A SampledPart may be this too.
class DigitalPart {
 public:
  virtual ~DigitalPart() = default;
  /// An instant of its clock at which the load is switched off: what is on its way, as in a delay, goes on without it.
  virtual void pass_idle(std::span<double> discrete) const noexcept = 0;
  /// Whether it has begun to wait for the next instant of its clock, and holds nothing until then.
  [[nodiscard]] virtual bool waits(std::span<const double> /*discrete*/) const { return false; }
  /// Whether what it gives moves in steps: it has no derivatives by what it measures.
  [[nodiscard]] virtual bool gives_steps() const = 0;
  /// Whether it draws numbers: what it holds is another after each sample, whatever it measures.
  [[nodiscard]] virtual bool draws() const { return false; }
  /// Count of its first discrete states that say what it does not depend on while it works: what outputs alone show, as
  /// an error.
  [[nodiscard]] virtual std::size_t told() const { return 0; }
};

}  // namespace withy
