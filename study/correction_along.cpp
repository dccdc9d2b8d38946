#include "withy/study/correction_along.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace withy::study {

CorrectionAlong::CorrectionAlong(const EquationsOfMotion& beyond, const EquationsOfMotion& used,
                                 std::span<const State> states)
    : AddedRates(beyond, used), size_(beyond.size() - 1) {
  Work beyond_work = beyond.make_work(), used_work = used.make_work();
  std::vector<double> f(beyond.size()), g(f);
  for (const State& state : states) {
    if (!beyond.derivatives(state.time, state.y, f, beyond_work).ok()) continue;
    if (!used.derivatives(state.time, state.y, g, used_work).ok()) continue;
    double sum = 0;
    for (std::size_t i = 0; i < size_; ++i) sum += g[i] -= f[i];
    if (!std::isfinite(sum)) continue;
    times_.push_back(state.time);
    d_.insert(d_.end(), g.begin(), g.begin() + static_cast<std::ptrdiff_t>(size_));
  }
  if (times_.empty()) throw std::invalid_argument("no state of the run has rates");
}

void CorrectionAlong::add(double t, double factor, std::span<double> sum) const noexcept {
  const auto next = std::upper_bound(times_.begin(), times_.end(), t);
  const auto i = static_cast<std::size_t>(next - times_.begin());
  const std::size_t to = std::min(i, times_.size() - 1), from = i > 0 ? i - 1 : 0;
  const double a = to > from ? (t - times_[from]) / (times_[to] - times_[from]) : 0;
  const double *const p = d_.data() + from * size_, *const q = d_.data() + to * size_;
  for (std::size_t k = 0; k < size_; ++k) sum[k] += factor * ((1 - a) * p[k] + a * q[k]);
}

}  // namespace withy::study
