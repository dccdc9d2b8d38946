// Whether the rate and the acceleration of a motion are the derivatives that they are said to be.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/false_slope.hpp"

namespace withy {
namespace {

/// Parts of the time where no table has a row.
constexpr std::array<double, 4> compared_times = {0.1371742, 0.4142136, 0.6830127, 0.9318517};
/// Of the whole time; in no simple ratio to any period, so that what is fast does not seem to stand still.
constexpr double time_step = 1.1939e-2;
/// Of the whole time: jumps that are nearer leave no steps.
constexpr double nearest_jump = 1e-9;

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
  [[nodiscard]] std::string fault_at(std::size_t i, const Derivative& d) const {
    const double t = compared_times[i] * span_, said = points_[i].*d.value;
    if (!std::isfinite(points_[i].position)) return {};  // the motion is not for this time
    if (!std::isfinite(said)) return said_text(t, d, said).str() + ", where its coordinate is finite";
    double greatest = 0;
    for (const MotionPoint& p : points_)
      if (std::isfinite(p.*d.value)) greatest = std::max(greatest, std::abs(p.*d.value));
    const double h = std::min(time_step * span_, nearest(t) / 6);
    if (!(h > nearest_jump * span_)) return {};
    const auto integral = [&](double s) -> Eigen::MatrixXd {
      return Eigen::MatrixXd::Constant(1, 1, motion_.at(t + s).*d.integral);
    };
    const auto number = [](double x) { return Eigen::RowVectorXd::Constant(1, x); };
    const auto wrong = false_slope({number(said), number(greatest), number(0)}, integral, h, t);
    if (!wrong) return {};
    std::ostringstream text = said_text(t, d, said);
    text << "; differences of its " << d.of << " give " << wrong->found(0, 0);
    return text.str();
  }

  /// How far a jump is away [s].
  [[nodiscard]] double nearest(double t) const {
    double distance = std::numeric_limits<double>::infinity();
    for (const double at : jumps_) distance = std::min(distance, std::abs(at - t));
    return distance;
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
