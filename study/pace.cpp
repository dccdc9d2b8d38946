#include "withy/study/pace.hpp"

#include <algorithm>
#include <limits>

namespace withy::study {

void Pace::note(double gone, double seconds) {
  if (!noted_.empty() && seconds < noted_.back().second) noted_.clear();
  noted_.emplace_back(gone, seconds);
}

double Pace::rest(double whole) const {
  if (noted_.empty()) return 0;
  const auto [gone, seconds] = noted_.back();
  const auto later = std::upper_bound(noted_.begin(), noted_.end(), 0.5 * seconds,
                                      [](double half, const auto& noted) { return half < noted.second; });
  // The last note of the first half; the start of the run where there is none.
  const auto [from, spent] = later == noted_.begin() ? std::pair(0.0, 0.0) : *(later - 1);
  if (gone >= whole) return 0;
  if (!(gone > from)) return std::numeric_limits<double>::infinity();
  return (whole - gone) * (seconds - spent) / (gone - from);
}

bool may_go_on(double seconds, double rest, double left) {
  constexpr double first_look = 0.1;
  if (seconds > left) return false;
  return seconds < first_look * left || seconds + rest <= left;
}

}  // namespace withy::study
