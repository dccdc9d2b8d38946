/// \file
/// Whether an integrator interpolates from where its steps begin to where they end.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "withy/core/plugin/integrator.hpp"
#include "withy/core/simulation/integrator_call.hpp"

namespace withy {

/// Compares, once, what a stepper gives at both ends of a step with the states there. One that leaves its argument as
/// it was, or gives the same state everywhere, would fill tables with states that never were. Allocates when it is made
/// alone.
class InsideCheck {
 public:
  /// \param start as the steps' states are \param moving of the first numbers in y that are compared; 0: none are
  InsideCheck(State start, std::size_t moving) : begun_(std::move(start)), inside_(begun_.y), moving_(moving) {}
  /// The next step begins here.
  void begin(const State& state) {
    if (moving_ > 0) begun_ = state;
  }
  /// After a step, before its inside is used. A step in which next to nothing changes leaves the question open.
  /// \throws IntegratorError where the step changes much and one of its ends is missed by half of that.
  void operator()(const Stepper& stepper) {
    const State& end = stepper.state();
    if (moving_ == 0 || !(end.time > begun_.time)) return;
    constexpr double next_to_nothing = 1e-9, share = 0.5;
    const double changed = apart(begun_.y, end.y);
    if (!(changed > next_to_nothing)) return;
    const auto misses = [&](const State& at, const State& other) {
      inside_ = other.y;  // what is left as it was is seen
      interpolate_step(stepper, at.time, inside_);
      return apart(inside_, at.y) > share * changed;
    };
    if (misses(begun_, end))
      throw IntegratorError(
          "does not interpolate from where its steps begin: at the start of one it gives another state than there was");
    if (misses(end, begun_))
      throw IntegratorError(
          "does not interpolate to where its steps end: at the end of one it gives another state than there is");
    moving_ = 0;
  }

 private:
  /// The greatest difference; what is no number counts nowhere.
  [[nodiscard]] double apart(std::span<const double> a, std::span<const double> b) const {
    double greatest = 0;
    for (std::size_t i = 0; i < moving_; ++i) greatest = std::max(greatest, std::abs(a[i] - b[i]));
    return greatest;
  }

  State begun_;
  std::vector<double> inside_;
  std::size_t moving_;
};

}  // namespace withy
