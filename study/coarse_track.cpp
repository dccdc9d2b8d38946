#include "withy/study/coarse_track.hpp"

#include <algorithm>
#include <span>

namespace withy::study {
namespace {

/// The weight of one of these at a time, of the polynomial through all (Lagrange).
double weight(std::span<const State> states, std::size_t i, double t) {
  double w = 1;
  for (std::size_t j = 0; j < states.size(); ++j)
    if (j != i) w *= (t - states[j].time) / (states[i].time - states[j].time);
  return w;
}

}  // namespace

std::optional<State> CoarseTrack::at(double t) const {
  constexpr std::size_t most = 4;
  if (states_.empty() || t < states_.front().time || t > states_.back().time) return {};
  const auto after =
      std::lower_bound(states_.begin(), states_.end(), t, [](const State& s, double time) { return s.time < time; });
  const auto next = static_cast<std::size_t>(after - states_.begin());
  const std::size_t count = std::min(most, states_.size());
  const std::size_t first = std::min(next - std::min(next, most / 2), states_.size() - count);
  const std::span near(states_.data() + first, count);
  State state{t, std::vector<double>(states_.front().y.size(), 0.0)};
  for (std::size_t i = 0; i < count; ++i) {
    const double w = weight(near, i, t);
    for (std::size_t k = 0; k < state.y.size(); ++k) state.y[k] += w * near[i].y[k];
  }
  equations_.normalize(state.y);
  return state;
}

}  // namespace withy::study
