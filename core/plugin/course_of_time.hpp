/// \file
/// What of loads and motions follows the time by a formula that a user has written.
#pragma once

#include <cstddef>
#include <span>

namespace withy {

/// A BoundLoad, a Motion or a BoundSensor that loads measure may be this too (dynamic_cast). Nothing says how fast its
/// formula changes: at rest, steps that are as long as the motion allows pass over a pulse without a look at it. So a
/// run looks at the formula first (core/simulation/time_courses.hpp).
class CourseOfTime {
 public:
  virtual ~CourseOfTime() = default;
  /// Count of numbers that follow the time; 0: none does.
  [[nodiscard]] virtual std::size_t courses() const = 0;
  /// Sets them at t [s], of any unit; what else the formula depends on is the same at all times.
  virtual void course(double t, std::span<double> values) const noexcept = 0;
};

}  // namespace withy
