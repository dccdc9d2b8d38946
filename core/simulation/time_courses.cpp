#include "withy/core/simulation/time_courses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/plugin/course_of_time.hpp"

namespace withy {
namespace {

constexpr double any = std::numeric_limits<double>::infinity();
/// An interval in which a course changes by less of its range limits nothing.
constexpr double least_share = 1.0 / 64;

std::vector<const CourseOfTime*> courses_of(const Model& model) {
  std::vector<const CourseOfTime*> all;
  const auto add = [&](const auto* part) {
    const auto* course = dynamic_cast<const CourseOfTime*>(part);
    if (course != nullptr && course->courses() > 0) all.push_back(course);
  };
  for (const LoadNode& node : model.loads()) add(node.load.get());
  for (const MotionNode& node : model.motions()) add(node.motion.get());
  return all;
}

}  // namespace

TimeCourses::TimeCourses(const Model& model, double start, double end) : start_(start) {
  const std::vector<const CourseOfTime*> all = courses_of(model);
  if (all.empty() || !std::isfinite(end) || !(end > start)) return;
  interval_ = (end - start) / static_cast<double>(intervals);
  std::vector<double> values, row;
  std::vector<double> longest(intervals, any);
  for (const CourseOfTime* course : all) {
    const std::size_t count = course->courses();
    values.assign((intervals + 1) * count, 0);
    row.resize(count);
    for (std::size_t k = 0; k <= intervals; ++k) {
      course->course(start + static_cast<double>(k) * interval_, row);
      std::copy(row.begin(), row.end(), values.begin() + static_cast<std::ptrdiff_t>(k * count));
    }
    for (std::size_t c = 0; c < count; ++c) {
      double least = any, greatest = -any, size = 0;
      for (std::size_t k = 0; k <= intervals; ++k) {
        const double x = values[k * count + c];
        if (!std::isfinite(x)) continue;
        least = std::min(least, x), greatest = std::max(greatest, x), size = std::max(size, std::abs(x));
      }
      const double range = greatest - least;
      if (!(range > 1e-9 * size)) continue;
      for (std::size_t k = 0; k < intervals; ++k) {
        const double change = std::abs(values[(k + 1) * count + c] - values[k * count + c]);
        if (change >= least_share * range) longest[k] = std::min(longest[k], range / change * interval_);
      }
    }
  }
  if (std::all_of(longest.begin(), longest.end(), [](double l) { return l == any; })) return;
  longest_ = std::move(longest);
  limited_.resize(intervals);
  for (std::size_t k = intervals, first = intervals; k-- > 0;) limited_[k] = first = longest_[k] < any ? k : first;
}

double TimeCourses::latest_end(double t) const {
  double latest = any;
  if (longest_.empty()) return latest;
  const double at = std::max(std::floor((t - start_) / interval_), 0.0);
  for (auto k = static_cast<std::size_t>(std::min(at, static_cast<double>(intervals))); k < intervals; ++k) {
    k = limited_[k];
    const double begin = start_ + static_cast<double>(k) * interval_;
    if (k == intervals || begin >= latest) break;
    // A step may end where the interval begins, or go on into it.
    latest = std::min(latest, std::max(begin, t + longest_[k]));
  }
  return latest;
}

}  // namespace withy
