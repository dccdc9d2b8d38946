#include "withy/study/corrected_equations.hpp"

#include <algorithm>
#include <cmath>

#include "withy/core/simulation/changing_equations.hpp"

namespace withy::study {

CorrectedEquations::CorrectedEquations(const std::vector<Rung>& rungs, std::size_t low, std::size_t high)
    : AddedRates(*rungs[low].equations, *rungs[high].equations),
      low_(low),
      high_(high),
      cheap_(*rungs[low].equations),
      dear_(*rungs[high].equations),
      cheap_work_(cheap_.make_work()),
      dear_work_(dear_.make_work()),
      last_(cheap_.size() - 1, 0.0),
      change_(last_),
      f_(cheap_.size()),
      g_(f_) {
  require_trees(rungs);
}

void CorrectedEquations::begin(const State& state) {
  std::fill(last_.begin(), last_.end(), 0.0);
  std::fill(change_.begin(), change_.end(), 0.0);
  time_ = state.time;
  span_ = 0;
  if (low_ == high_) return;
  sample(state);
  std::fill(change_.begin(), change_.end(), 0.0);
  span_ = 0;
}

void CorrectedEquations::sample(const State& state) {
  if (low_ == high_) return;
  ++samples_;
  if (!cheap_.derivatives(state.time, state.y, f_, cheap_work_).ok()) return;
  if (!dear_.derivatives(state.time, state.y, g_, dear_work_).ok()) return;
  double sum = 0;
  for (std::size_t i = 0; i < last_.size(); ++i) sum += g_[i] - f_[i];
  if (!std::isfinite(sum)) return;
  for (std::size_t i = 0; i < last_.size(); ++i) {
    const double d = g_[i] - f_[i];
    change_[i] = d - last_[i];
    last_[i] = d;
  }
  span_ = state.time - time_;
  time_ = state.time;
}

double CorrectedEquations::ahead(double t) const noexcept {
  return span_ > 0 ? std::clamp((t - time_) / span_, 0.0, 1.0) : 0;
}

void CorrectedEquations::add(double t, double factor, std::span<double> sum) const noexcept {
  const double a = ahead(t);
  for (std::size_t i = 0; i < last_.size(); ++i) sum[i] += factor * (last_[i] + a * change_[i]);
}

}  // namespace withy::study
