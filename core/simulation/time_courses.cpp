#include "withy/core/simulation/time_courses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "withy/core/plugin/course_of_time.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {
namespace {

constexpr double any = std::numeric_limits<double>::infinity();
/// A change within an interval that is less of the size of a course is rounding; of the changes of a course from
/// interval to interval what is less of the size of the course itself.
constexpr double rounding = 1e-9, rounding_of_changes = 1e-11;
/// How many times its scale a change is announced ahead of itself, and how many it takes until steps have seen it: they
/// are as long as their errors allow from then on.
constexpr double ahead = 4, seen = 16;

std::vector<const CourseOfTime*> courses_of(const Model& model) {
  std::vector<const CourseOfTime*> all;
  const auto add = [&](const auto* part) {
    const auto* course = dynamic_cast<const CourseOfTime*>(part);
    if (course != nullptr && course->courses() > 0) all.push_back(course);
  };
  for (const LoadNode& node : model.loads()) add(node.load.get());
  for (const MotionNode& node : model.motions()) add(node.motion.get());
  if (model.measured() != nullptr)
    for (const SensorNode& node : *model.measured()) add(node.sensor.get());
  return all;
}

double size_of(std::span<const double> values) {
  double size = 0;
  for (const double x : values)
    if (std::isfinite(x)) size = std::max(size, std::abs(x));
  return size;
}

/// For each interval of a course, given at their ends, how many intervals it takes there to go through the range of
/// what it does between two rests; infinite where it rests, its change being no more than `least_change`.
void add_scales(std::span<const double> values, double least_change, std::span<double> scales) {
  const auto change = [&](std::size_t k) {
    const double d = std::abs(values[k + 1] - values[k]);
    return std::isfinite(d) && d > least_change ? d : 0.0;
  };
  for (std::size_t k = 0; k < scales.size();) {
    if (change(k) == 0) {
      ++k;
      continue;
    }
    const std::size_t first = k;
    double least = values[k], greatest = values[k];
    for (; k < scales.size() && change(k) > 0; ++k) {
      least = std::min(least, values[k + 1]);
      greatest = std::max(greatest, values[k + 1]);
    }
    for (std::size_t i = first; i < k; ++i) scales[i] = std::min(scales[i], (greatest - least) / change(i));
  }
}

/// Each interval gets the least scale of those that announce themselves there.
std::vector<double> announced(std::span<const double> scales) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < scales.size(); ++k)
    if (scales[k] < any) order.push_back(k);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return scales[a] < scales[b]; });
  std::vector<double> result(scales.size(), any);
  std::vector<std::size_t> open(scales.size() + 1);  // leads to the first interval at or after one that has none yet
  for (std::size_t k = 0; k < open.size(); ++k) open[k] = k;
  const auto first_open = [&](std::size_t k) {
    while (open[k] != k) k = open[k] = open[open[k]];
    return k;
  };
  for (const std::size_t k : order) {
    const auto reach = static_cast<std::size_t>(std::min(ahead * scales[k], static_cast<double>(scales.size())));
    const std::size_t end = std::min(k + reach + 1, scales.size());
    for (std::size_t i = first_open(k > reach ? k - reach : 0); i < end; i = first_open(i)) {
      result[i] = scales[k];
      open[i] = i + 1;
    }
  }
  return result;
}

/// Leaves the scales of intervals before which there has not been one as short for long enough; infinite elsewhere.
void forget_seen(std::vector<double>& scales) {
  std::vector<std::size_t> longer;  // intervals behind which no scale has been as long, longest first
  std::vector<double> left(scales.size(), any);
  for (std::size_t k = 0; k < scales.size(); ++k) {
    while (!longer.empty() && scales[longer.back()] <= scales[k]) longer.pop_back();
    const auto after =
        std::partition_point(longer.begin(), longer.end(), [&](std::size_t i) { return scales[i] > 2 * scales[k]; });
    const double since = static_cast<double>(k - (after == longer.begin() ? 0 : *(after - 1)));
    if (since <= seen * scales[k]) left[k] = scales[k];
    longer.push_back(k);
  }
  scales = std::move(left);
}

}  // namespace

TimeCourses::TimeCourses(const Model& model, double start, double end) : start_(start) {
  const std::vector<const CourseOfTime*> all = courses_of(model);
  if (all.empty() || !std::isfinite(end) || !(end > start)) return;
  interval_ = (end - start) / static_cast<double>(intervals);
  std::vector<double> row, values(intervals + 1), scales(intervals, any);
  for (const CourseOfTime* course : all) {
    row.resize(course->courses());
    for (std::size_t c = 0; c < row.size(); ++c) {
      for (std::size_t k = 0; k <= intervals; ++k) {
        course->course(start + static_cast<double>(k) * interval_, row);
        values[k] = row[c];
      }
      const double size = size_of(values);
      add_scales(values, rounding * size, scales);
      // What goes on changing never rests: what it does beside that is seen in its changes.
      std::adjacent_difference(values.begin(), values.end(), values.begin());
      const std::span<const double> changes = std::span(values).subspan(1);
      add_scales(changes, std::max(rounding * size_of(changes), rounding_of_changes * size),
                 std::span(scales).first(intervals - 1));
    }
  }
  longest_ = announced(scales);
  forget_seen(longest_);
  if (std::all_of(longest_.begin(), longest_.end(), [](double l) { return l == any; })) {
    longest_.clear();
    return;
  }
  for (double& l : longest_) l *= interval_;
  limited_.resize(intervals);
  for (std::size_t k = intervals, first = intervals; k-- > 0;) limited_[k] = first = longest_[k] < any ? k : first;
}

bool TimeCourses::are_in(const Model& model) { return !courses_of(model).empty(); }

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
