#include "withy/study/level_steps.hpp"

#include <algorithm>
#include <cmath>

namespace withy::study {
namespace {

/// Of the time that is left: what a level may be expected to cost that is further from the last one than that was.
constexpr double jump_share = 0.5;

}  // namespace

/// Modes that the next run of a series has more.
int LevelSteps::after(int modes) const { return goal_.leaps && goal_.kinds == 1 ? next_step(modes) : 1; }

/// Modes that a run has more than the one before it.
int LevelSteps::last(int modes) const {
  const std::vector<int> all = upper_half(modes);
  return all.size() < 2 ? 1 : all.back() - all[all.size() - 2];
}

std::vector<int> LevelSteps::upper_half(int modes) const {
  std::vector<int> all;
  for (int n = goal_.first.modes; n < modes; n += after(n))
    if (2 * n >= modes - 1) all.push_back(n);
  all.push_back(modes);
  return all;
}

Point LevelSteps::finer(Point point) const {
  point.tolerance = std::max(goal_.finer * point.tolerance, goal_.tightest);
  if (point.modes == 0) return integrations_.on(point);
  const auto with = [&](int step) {
    Point more = point;
    more.modes += step;
    return integrations_.on(more);
  };
  const Point next = with(after(point.modes));
  return costs_little(next) ? next : with(last(point.modes));
}

Point LevelSteps::between(Point point) const {
  point.modes -= last(point.modes) / 2;
  return integrations_.on(point);
}

bool LevelSteps::costs_little(const Point& point) const {
  const double seconds = integrations_.expected_seconds(point);
  return !goal_.left || seconds <= jump_share * goal_.left() || std::isinf(seconds);
}

}  // namespace withy::study
