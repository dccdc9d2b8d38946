/// \file
/// Times that the loops over steps share: where steps must end, when outputs are due, CPU time.
#pragma once

#include <time.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/same_instant.hpp"

namespace withy {

/// CPU time of this thread [s].
inline double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Times [s] at which loads or motions jump, increasing: steps must end there.
inline std::vector<double> discontinuities(const Model& model) {
  std::vector<double> times;
  const auto add = [&](const std::vector<double>& more) { times.insert(times.end(), more.begin(), more.end()); };
  for (const LoadNode& node : model.loads()) add(node.load->discontinuities());
  for (const MotionNode& node : model.motions()) add(node.motion->discontinuities());
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// A time [s]; where one of the jumps comes at the same instant, but by rounding later, the time of that: what is from
/// then on.
inline double from_jump_on(const std::vector<double>& jumps, double time) {
  const auto jump = std::upper_bound(jumps.begin(), jumps.end(), time);
  return jump != jumps.end() && same_instant(*jump, time) ? *jump : time;
}

/// The multiples of the interval after `start` and before `end`. Multiples that differ from either by rounding alone
/// are left out: both are outputs anyway.
class OutputTimes {
 public:
  OutputTimes(double start, double interval, double end) : interval_(interval), last_(end - 1e-9 * interval) {
    index_ = std::floor(start / interval + 1e-9) + 1;
  }
  /// Whether the next is at a time that steps have come to, or was before it. One that comes later by rounding alone is
  /// at it: what happens at that instant comes after the output, as it does where no rounding parts them.
  [[nodiscard]] bool due(double t) const { return (next() <= t || same_instant(next(), t)) && next() < last_; }
  [[nodiscard]] double next() const { return index_ * interval_; }
  void pass() { index_ += 1; }
  void remember(Memory& memory) { memory(index_); }

 private:
  double interval_;
  double last_;
  double index_;  ///< whole; a product does not accumulate rounding as a sum would
};

}  // namespace withy
