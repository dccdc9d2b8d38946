/// \file
/// The history that CVODE's multistep methods rest on, as it can be kept and made again.
#pragma once

#include <stdexcept>
#include <vector>

#include "withy/core/plugin/memory.hpp"
#include "withy/core/plugin/state.hpp"

namespace withy {

/// CVODE begins anew after so many steps: few enough to be made again in a moment, so many that it costs less than 1 %.
inline constexpr std::size_t most_steps_of_history = 5000;

/// What made CVODE's history: the state it began at and the limit of each step since.
class CvodeHistory {
 public:
  /// Steps one after another with the same limit [s].
  struct Stretch {
    double limit = 0;
    std::size_t steps = 0;
  };

  CvodeHistory() { stretches_.reserve(most_steps_of_history); }  // steps do not allocate
  void begin(const State& state) {
    start_.time = state.time;
    start_.y.assign(state.y.begin(), state.y.end());
    stretches_.clear();
    steps_ = 0;
  }
  void add(double limit) {
    if (stretches_.empty() || stretches_.back().limit != limit) stretches_.push_back({limit, 0});
    ++stretches_.back().steps;
    ++steps_;
  }
  [[nodiscard]] const State& start() const { return start_; }
  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  [[nodiscard]] std::size_t steps() const { return steps_; }
  void remember(Memory& memory) {
    memory(start_.time);
    memory(start_.y);
    std::size_t count = stretches_.size();
    memory(count);
    if (memory.reading()) {
      if (count > most_steps_of_history) throw std::invalid_argument("more steps than CVODE makes without a new start");
      stretches_.resize(count);
    }
    for (Stretch& s : stretches_) {
      memory(s.limit);
      memory(s.steps);
    }
    memory(steps_);
  }

 private:
  State start_;
  std::vector<Stretch> stretches_;
  std::size_t steps_ = 0;
};

}  // namespace withy
