#include "withy/campaign/histories.hpp"

#include <cmath>
#include <limits>

namespace withy::campaign {
namespace {

/// Times that differ by less of themselves are one.
constexpr double one_time = 1e-9;

}  // namespace

std::vector<double> history_times(double start, double end, double every) {
  std::vector<double> times;
  const auto steps = static_cast<std::size_t>(std::ceil((end - start) / every * (1 - one_time)));
  for (std::size_t i = 0; i < steps; ++i) times.push_back(start + static_cast<double>(i) * every);
  times.push_back(end);
  return times;
}

void Histories::enter(double t, std::span<const double> row) {
  std::vector<double> now;
  for (const std::size_t c : columns_) now.push_back(row[c]);
  const std::size_t n = columns_.size();
  if (last_.empty()) last_ = now;
  for (std::size_t i = kept_.size() / n; i < times_->size(); ++i) {
    const double at = (*times_)[i];
    if (at > t + one_time * std::abs(t)) break;
    const double way = t > last_t_ ? (at - last_t_) / (t - last_t_) : 1;
    // At a row it is the row's number to the last bit.
    const bool here = std::abs(at - t) <= one_time * std::abs(t);
    for (std::size_t k = 0; k < n; ++k) kept_.push_back(here ? now[k] : last_[k] + way * (now[k] - last_[k]));
  }
  last_ = std::move(now);
  last_t_ = t;
}

std::vector<double> Histories::numbers() const {
  const std::size_t n = columns_.size(), reached = n > 0 ? kept_.size() / n : 0;
  std::vector<double> all;
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < times_->size(); ++i)
      all.push_back(i < reached ? kept_[i * n + k] : std::numeric_limits<double>::quiet_NaN());
  return all;
}

}  // namespace withy::campaign
