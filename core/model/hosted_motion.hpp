/// \file
/// Motions that a host sets between the steps of a simulation: what a hinge does then stands in discrete states.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/motion.hpp"

namespace withy {

/// A load without efforts that holds the law of a motion is this too (dynamic_cast); it has an InputPort.
class HostedMotion {
 public:
  virtual ~HostedMotion() = default;
  /// The speed that it prescribes: index among all.
  [[nodiscard]] virtual std::size_t speed() const noexcept = 0;
  /// Of the coordinate at time t [s]; at the end of a line that of the line.
  [[nodiscard]] virtual MotionPoint at(double t, std::span<const double> discrete) const noexcept = 0;
  /// Whether what the host sets may jump, as accelerations do. Positions and rates do not: they are reached at the end
  /// of a step, and InputPort::set with that end at once ends the line that there is: the rate stays.
  [[nodiscard]] virtual bool jumps() const noexcept = 0;
};

/// A Motion that holds its hinge by itself and has its law in a load is this too (dynamic_cast).
class MotionByLoad {
 public:
  virtual ~MotionByLoad() = default;
  /// The load, to be added to the model under the motion's name.
  [[nodiscard]] virtual std::unique_ptr<Load> load(const std::string& hinge) const = 0;
};

/// All of a model, which must outlive the object.
class HostedMotions {
 public:
  explicit HostedMotions(const Model& model);
  /// Sets the accelerations that they prescribe at (t, y), laid out as State::y, in u_dot, one a speed.
  void prescribe(double t, std::span<const double> y, std::span<double> u_dot) const noexcept {
    for (const Place& p : places_) u_dot[p.motion->speed()] = p.motion->at(t, y.subspan(p.first, p.count)).acceleration;
  }

 private:
  struct Place {
    const HostedMotion* motion;
    std::size_t first, count;  ///< of its states in y
  };
  std::vector<Place> places_;
};

/// The motion whose law a load holds; null where it holds none.
const HostedMotion* hosted_motion(const BoundLoad& load);

}  // namespace withy
