// Whether the rate and the acceleration of a motion are the derivatives that they are said to be.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "withy/core/model/validate.hpp"

namespace withy {
namespace {

/// Parts of the time where no table has a row.
constexpr std::array<double, 4> compared_times = {0.1371742, 0.4142136, 0.6830127, 0.9318517};
/// Of the whole time; in no simple ratio to any period, so that what is fast does not seem to stand still.
constexpr std::array<double, 8> time_steps = {1.1939e-2, 1.2719e-3, 1.1173e-4, 1.3297e-5,
                                              1.0729e-6, 1.2347e-7, 1.1411e-8, 1.3163e-9};
/// Of the greatest: far above the error of the best of these differences, far below a factor that is forgotten.
constexpr double course_tolerance = 1e-4;

struct Derivative {
  const char* name;
  const char* of;
  double MotionPoint::*value;
  double MotionPoint::*integral;
};

constexpr std::array<Derivative, 2> motion_derivatives = {
    Derivative{"rate", "coordinate", &MotionPoint::rate, &MotionPoint::position},
    Derivative{"acceleration", "rate", &MotionPoint::acceleration, &MotionPoint::rate}};

/// What a motion says at some times, and how differences judge it.
class ComparedCourse {
 public:
  explicit ComparedCourse(const Motion& motion) : motion_(motion), jumps_(motion.discontinuities()) {
    const double end = motion.end(), last = jumps_.empty() ? 0 : jumps_.back();
    span_ = end > 0 && std::isfinite(end) ? end : last > 0 && std::isfinite(last) ? last : 1.0;
    for (std::size_t i = 0; i < compared_times.size(); ++i) points_[i] = motion.at(compared_times[i] * span_);
  }

  [[nodiscard]] std::string fault() const {
    for (const Derivative& d : motion_derivatives)
      for (std::size_t i = 0; i < points_.size(); ++i)
        if (std::string text = fault_at(i, d); !text.empty()) return text;
    return {};
  }

 private:
  /// One difference of what is differentiated, and what rounding may make of it.
  struct Difference {
    double value, rounding;
  };

  [[nodiscard]] std::string fault_at(std::size_t i, const Derivative& d) const {
    const double t = compared_times[i] * span_, said = points_[i].*d.value;
    if (!std::isfinite(points_[i].position)) return {};  // the motion is not for this time
    if (!std::isfinite(said)) return said_text(t, d, said).str() + ", where its coordinate is finite";
    double greatest = 0;
    for (const MotionPoint& p : points_)
      if (std::isfinite(p.*d.value)) greatest = std::max(greatest, std::abs(p.*d.value));
    Difference before = {std::numeric_limits<double>::quiet_NaN(), 0};
    bool together = false;  // the finest two that say something
    for (const double step : time_steps) {
      const double h = step * span_;
      if (leads_over_jump(t, h)) continue;
      const Difference found = difference(t, h, d);
      const double allowed = course_tolerance * std::max(greatest, std::abs(found.value));
      if (!(found.rounding <= allowed)) continue;
      if (std::abs(said - found.value) <= allowed) return {};
      together = agree_of_steps(before, found, step == time_steps.back());
      before = found;
    }
    if (!together) return {};
    std::ostringstream text = said_text(t, d, said);
    text << "; differences of its " << d.of << " give " << before.value;
    return text.str();
  }

  /// Nothing at all is found of what stands still, and of what is lost in rounding: that the finest step tells apart.
  static bool agree_of_steps(const Difference& coarse, const Difference& fine, bool finest) {
    const double allowed = course_tolerance * std::abs(fine.value);
    if (std::abs(coarse.value - fine.value) <= allowed && fine.rounding <= allowed) return true;
    return finest && std::abs(fine.value) <= fine.rounding && std::abs(coarse.value) <= coarse.rounding;
  }

  [[nodiscard]] Difference difference(double t, double h, const Derivative& d) const {
    const MotionPoint behind = motion_.at(t - h), ahead = motion_.at(t + h);
    const double from = behind.*d.integral, to = ahead.*d.integral, value = (to - from) / (2 * h);
    // Of both values, and of the times at which they are.
    constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
    return {value, rounding * (std::max(std::abs(from), std::abs(to)) + std::abs(t * value)) / h};
  }

  [[nodiscard]] bool leads_over_jump(double t, double h) const {
    return std::any_of(jumps_.begin(), jumps_.end(), [&](double at) { return std::abs(at - t) <= 1.01 * h; });
  }

  static std::ostringstream said_text(double t, const Derivative& d, double said) {
    std::ostringstream text;
    text << "at t = " << t << " s its " << d.name << " is " << said;
    return text;
  }

  const Motion& motion_;
  std::vector<double> jumps_;
  double span_ = 1;  ///< [s]
  std::array<MotionPoint, compared_times.size()> points_;
};

}  // namespace

std::string find_fault(const Motion& motion) {
  if (motion.locks()) return {};
  return ComparedCourse(motion).fault();
}

}  // namespace withy
