/// \file
/// What else is known of loads whose law changes as time goes on.
#pragma once

namespace withy {

/// A BoundLoad may be this too (dynamic_cast).
class ChangingLaw {
 public:
  virtual ~ChangingLaw() = default;
  /// Whether the same signals and states give another command at another time, and not by a sum alone: its gain is that
  /// of an instant, and a linear form of it holds there.
  [[nodiscard]] virtual bool changes_gain() const = 0;
};

}  // namespace withy
