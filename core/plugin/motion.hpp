/// \file
/// The interface of prescribed motions.
#pragma once

#include <vector>

namespace withy {

/// A coordinate and its derivatives [rad, rad/s, rad/s² or m, m/s, m/s²].
struct MotionPoint {
  double position = 0;
  double rate = 0;
  double acceleration = 0;
};

/// A motion that a hinge is made to follow, whatever effort that takes. Immutable.
class Motion {
 public:
  virtual ~Motion() = default;
  /// Whether the motion holds any hinge where the simulation begins, at rest; `at` is then not asked. Otherwise it is
  /// one of a hinge with one coordinate.
  [[nodiscard]] virtual bool locks() const = 0;
  /// The coordinate at time t [s]; called in every evaluation: no allocation.
  [[nodiscard]] virtual MotionPoint at(double t) const noexcept = 0;
  /// Times [s], increasing, where the acceleration or one of its first derivatives jumps: integrators land on them.
  [[nodiscard]] virtual std::vector<double> discontinuities() const = 0;
  /// Time [s] at which the motion has done what it is for; 0 where it has no end of its own.
  [[nodiscard]] virtual double end() const = 0;
};

}  // namespace withy
