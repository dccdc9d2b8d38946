#include "withy/core/simulation/states_along.hpp"

#include <algorithm>

namespace withy {

void StatesAlong::observe(const State& state) {
  if (row_ == 0 || seen_++ % every_ != 0) return;
  const auto at = [&](std::size_t i) { return kept_.begin() + static_cast<std::ptrdiff_t>(i * row_); };
  if (rows_ == most_) {
    every_ *= 2;
    rows_ = most_ / 2;
    for (std::size_t i = 1; i < rows_; ++i) std::copy(at(2 * i), at(2 * i + 1), at(i));
  }
  *at(rows_) = state.time;
  std::copy(state.y.begin(), state.y.end(), at(rows_++) + 1);
}

std::vector<State> StatesAlong::until(const State& last, bool included) const {
  std::vector<State> states;
  if (row_ == 0) return states;
  for (std::size_t i = 0; i < rows_ && kept_[i * row_] < last.time; ++i) {
    const double* const from = kept_.data() + i * row_;
    states.push_back({*from, std::vector<double>(from + 1, from + row_)});
  }
  if (included) states.push_back(last);
  return states;
}

void StatesAlong::remember(Memory& memory) {
  memory(kept_);
  memory(rows_);
  memory(seen_);
  memory(every_);
}

}  // namespace withy
