#include "withy/core/simulation/busiest_state.hpp"

#include <algorithm>
#include <cmath>

namespace withy {

BusiestState::BusiestState(std::size_t first, std::size_t speeds, std::size_t size)
    : first_(first),
      greatest_rates_(speeds),
      greatest_speeds_(speeds),
      last_{0, std::vector<double>(size)},
      speeds_before_(speeds),
      busiest_(last_) {}

void BusiestState::begin_at(const State& state) {
  last_ = state;
  judged_ = false;
}

double BusiestState::busyness(const State& next) {
  const double span = next.time - before_;
  const double *const u = last_.y.data() + first_, *const u_next = next.y.data() + first_;
  const auto share = [](double size, double& greatest) {
    greatest = std::max(greatest, size);
    const double share = greatest > 0 ? size / greatest : 0;
    return share * share;
  };
  double sum = 0;
  for (std::size_t i = 0; i < speeds_before_.size(); ++i)
    sum += share(std::abs(u_next[i] - speeds_before_[i]) / span, greatest_rates_[i]) +
           share(std::abs(u[i]), greatest_speeds_[i]);
  return sum;
}

void BusiestState::observe(const State& state) {
  if (!(state.time > last_.time)) return begin_at(state);
  if (judged_) {
    if (const double here = busyness(state); here > busyness_) {
      busyness_ = here;
      busiest_ = last_;
    }
  }
  before_ = last_.time;
  std::copy_n(last_.y.begin() + static_cast<std::ptrdiff_t>(first_), speeds_before_.size(), speeds_before_.begin());
  judged_ = true;
  last_ = state;
}

void BusiestState::remember(Memory& memory) {
  memory(greatest_rates_);
  memory(greatest_speeds_);
  memory(last_.time);
  memory(last_.y);
  memory(before_);
  memory(speeds_before_);
  memory(judged_);
  memory(busiest_.time);
  memory(busiest_.y);
  memory(busyness_);
}

}  // namespace withy
