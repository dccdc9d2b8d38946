/// \file
/// Motions of one coordinate as functions of time: what slews and controllers follow, and hinges are driven along.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "withy/core/plugin/course_of_time.hpp"
#include "withy/core/plugin/motion.hpp"

namespace withy {

/// Stays where it is.
struct Hold {
  double position = 0;
  MotionPoint operator()(double /*t*/) const noexcept { return {position, 0, 0}; }
  std::vector<double> jumps() const { return {}; }
  double end() const { return 0; }
};

/// From rest to rest, x = from + change · (10 r³ − 15 r⁴ + 6 r⁵), r = t / duration.
struct Quintic {
  double from = 0;
  double change = 0;
  double duration = 1;  ///< [s]
  MotionPoint operator()(double t) const noexcept {
    if (!(t > 0)) return {from, 0, 0};
    if (t >= duration) return {from + change, 0, 0};
    const double r = t / duration;
    return {from + change * r * r * r * (10 + r * (-15 + 6 * r)), change * 30 * r * r * (1 - r) * (1 - r) / duration,
            change * 60 * r * (1 - r) * (1 - 2 * r) / (duration * duration)};
  }
  std::vector<double> jumps() const { return {0, duration}; }
  double end() const { return duration; }
};

/// From rest to rest with the acceleration 4 change / duration² in the first half and its opposite in the second: the
/// least possible greatest acceleration.
struct BangBang {
  double from = 0;
  double change = 0;
  double duration = 1;  ///< [s]
  MotionPoint operator()(double t) const noexcept {
    if (t < 0) return {from, 0, 0};
    if (t >= duration) return {from + change, 0, 0};
    const double a = 4 * change / (duration * duration);
    if (t < 0.5 * duration) return {from + 0.5 * a * t * t, a * t, a};
    const double left = duration - t;
    return {from + change - 0.5 * a * left * left, a * left, -a};
  }
  std::vector<double> jumps() const { return {0, 0.5 * duration, duration}; }
  double end() const { return duration; }
};

/// x = center + amplitude · sin(2π frequency t + phase).
struct SineMotion {
  double center = 0;
  double amplitude = 0;
  double frequency = 1;  ///< [Hz]
  double phase = 0;      ///< [rad]
  MotionPoint operator()(double t) const noexcept {
    const double w = 2 * std::numbers::pi * frequency;
    const double s = amplitude * std::sin(w * t + phase), c = amplitude * std::cos(w * t + phase);
    return {center + s, w * c, -w * w * s};
  }
  std::vector<double> jumps() const { return {}; }
  double end() const { return 0; }
};

/// Through given points: the cubic spline with given rates in the first and the last, kept before and after; at rest
/// where none are given.
class Spline {
 public:
  /// Times [s] must increase; one point is a hold.
  Spline(std::vector<double> times, std::vector<double> positions, double start_rate = 0, double end_rate = 0)
      : times_(std::move(times)),
        positions_(std::move(positions)),
        start_rate_(start_rate),
        end_rate_(end_rate),
        curvature_(times_.size()) {
    const std::size_t n = times_.size();
    if (n < 2) return;
    // Continuity of the rate at each point, in the accelerations c there:
    //   h₋ c₋ + 2 (h₋ + h₊) c + h₊ c₊ = 6 (slope₊ − slope₋),  outside with h 0 and the rate there for the slope.
    std::vector<double> diagonal(n);
    const auto h = [&](std::size_t i) { return times_[i + 1] - times_[i]; };
    const auto slope = [&](std::size_t i) { return (positions_[i + 1] - positions_[i]) / h(i); };
    for (std::size_t i = 0; i < n; ++i) {
      const bool first = i == 0, last = i == n - 1;
      diagonal[i] = 2 * ((first ? 0 : h(i - 1)) + (last ? 0 : h(i)));
      curvature_[i] = 6 * ((last ? end_rate : slope(i)) - (first ? start_rate : slope(i - 1)));
      if (first) continue;
      const double factor = h(i - 1) / diagonal[i - 1];
      diagonal[i] -= factor * h(i - 1);
      curvature_[i] -= factor * curvature_[i - 1];
    }
    curvature_[n - 1] /= diagonal[n - 1];
    for (std::size_t i = n - 1; i-- > 0;) curvature_[i] = (curvature_[i] - h(i) * curvature_[i + 1]) / diagonal[i];
  }
  MotionPoint operator()(double t) const noexcept {
    if (!(t >= times_.front())) return {positions_.front() + start_rate_ * (t - times_.front()), start_rate_, 0};
    if (t >= times_.back()) return {positions_.back() + end_rate_ * (t - times_.back()), end_rate_, 0};
    const auto i = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin());
    const double h = times_[i] - times_[i - 1];
    const double a = (times_[i] - t) / h, b = (t - times_[i - 1]) / h;
    const double c0 = curvature_[i - 1], c1 = curvature_[i];
    return {a * positions_[i - 1] + b * positions_[i] + (a * (a * a - 1) * c0 + b * (b * b - 1) * c1) * h * h / 6,
            (positions_[i] - positions_[i - 1]) / h + ((1 - 3 * a * a) * c0 + (3 * b * b - 1) * c1) * h / 6,
            a * c0 + b * c1};
  }
  std::vector<double> jumps() const { return times_.size() < 2 ? std::vector<double>{} : times_; }
  double end() const { return times_.size() < 2 ? 0 : times_.back(); }

 private:
  std::vector<double> times_, positions_;
  double start_rate_, end_rate_;
  std::vector<double> curvature_;  ///< accelerations at the points
};

/// A motion that a plugin brings, its time running faster by a factor. It must not be one that locks.
struct PluginMotion {
  std::shared_ptr<const Motion> motion;
  double time_scale = 1;
  MotionPoint operator()(double t) const noexcept {
    const MotionPoint p = motion->at(time_scale * t);
    return {p.position, time_scale * p.rate, time_scale * time_scale * p.acceleration};
  }
  std::vector<double> jumps() const {
    std::vector<double> times = motion->discontinuities();
    for (double& t : times) t /= time_scale;
    return times;
  }
  double end() const { return motion->end() / time_scale; }
};

/// A motion of one coordinate. Jumps are those of the acceleration or of its derivative; `end` is when a motion that
/// ends has come to rest, else 0.
using Trajectory = std::variant<Hold, Quintic, BangBang, SineMotion, Spline, PluginMotion>;

inline MotionPoint at(const Trajectory& trajectory, double t) noexcept {
  return std::visit([t](const auto& motion) { return motion(t); }, trajectory);
}

/// The formula of the time that a trajectory follows; null where it follows none.
inline const CourseOfTime* course_in(const Trajectory& trajectory) {
  const auto* plugin = std::get_if<PluginMotion>(&trajectory);
  return plugin == nullptr ? nullptr : dynamic_cast<const CourseOfTime*>(plugin->motion.get());
}

/// What follows a trajectory has the courses of that.
inline std::size_t courses_of(const Trajectory& trajectory) {
  const CourseOfTime* course = course_in(trajectory);
  return course == nullptr ? 0 : course->courses();
}
/// \param values as many as courses_of says
inline void course_of(const Trajectory& trajectory, double t, std::span<double> values) noexcept {
  if (const CourseOfTime* course = course_in(trajectory); course != nullptr && !values.empty())
    course->course(std::get<PluginMotion>(trajectory).time_scale * t, values);
}

}  // namespace withy
