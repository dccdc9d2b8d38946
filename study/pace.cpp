#include "withy/study/pace.hpp"

#include <algorithm>
#include <limits>

namespace withy::study {

void Pace::note(double gone, double seconds) {
  if (!noted_.empty() && seconds < noted_.back().second) noted_.clear();
  noted_.emplace_back(gone, seconds);
}

void Pace::end() {
  if (!noted_.empty() && noted_.back().second > 0) ended_ = std::move(noted_);
  noted_.clear();
}

namespace {

/// Share of a run's cost that it has had when it has come so far.
double share_of(const std::vector<std::pair<double, double>>& run, double gone) {
  const auto after =
      std::upper_bound(run.begin(), run.end(), gone, [](double at, const auto& noted) { return at < noted.first; });
  if (after == run.end()) return 1;
  const auto [from, spent] = after == run.begin() ? std::pair(0.0, 0.0) : *(after - 1);
  const auto [to, by_then] = *after;
  return (spent + (by_then - spent) * (gone - from) / (to - from)) / run.back().second;
}

}  // namespace

double Pace::rest(double whole) const {
  if (noted_.empty()) return 0;
  const auto [gone, seconds] = noted_.back();
  if (!ended_.empty() && gone > 0 && gone < whole) {
    const double share = share_of(ended_, gone);
    if (share > 0) return seconds * (1 / share - 1);
  }
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
