/// \file
/// What is lost where accelerations are taken to efforts and back.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "withy/core/plugin/forward_dynamics.hpp"
#include "withy/core/simulation/accuracy.hpp"

namespace withy {

/// Takes accelerations to efforts and back, by the two recursions of a run, at the positions of a state and at rest.
/// The model and its equations must outlive it.
class RoundTrip {
 public:
  RoundTrip(const Model& model, const EquationsOfMotion& equations, const State& state)
      : equations_(equations),
        forward_(dynamic_cast<const ForwardDynamics*>(&equations)),
        y_(state.y),
        work_(equations.make_work()),
        there_(model.layout().speeds),
        efforts_(there_),
        back_(there_) {
    const auto speeds = y_.begin() + static_cast<std::ptrdiff_t>(model.layout().positions);
    std::fill(speeds, speeds + static_cast<std::ptrdiff_t>(there_.size()), 0.0);
    prescribed_.assign(there_.size(), false);
    for (const MotionNode& motion : model.motions()) {
      const Slot& slot = model.layout().hinges[static_cast<std::size_t>(motion.hinge)];
      for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i) prescribed_[i] = true;
    }
    find_units();
  }
  /// Whether the equations take efforts; else nothing below may be asked.
  [[nodiscard]] bool possible() const { return forward_ != nullptr; }

  /// False where nothing is accelerated. Where weight and stiffness balance, what is left of them is rounding, and no
  /// measure of its own error: the same accelerations are taken there and back beside these forces, and so large that
  /// the forces are nothing beside them.
  bool of(std::span<const double> accelerations, RoundingError& error) {
    double most = 0;
    for (std::size_t i = 0; i < there_.size(); ++i) most = std::max(most, units_[i] * std::abs(accelerations[i]));
    if (!(most > 0)) return false;
    RoundingError found = there_and_back(accelerations, 1);
    if (std::isfinite(most) && found.relative > 0) {
      const RoundingError alone = there_and_back(accelerations, std::ldexp(1.0, 100 - std::ilogb(most)));
      if (alone.relative < found.relative) found = alone;
    }
    if (found.relative > error.relative) error = found;
    return true;
  }
  /// Accelerations of the same size in all coordinates, of alternating signs in no simple order.
  [[nodiscard]] std::vector<double> everywhere() const {
    std::vector<double> a(units_.size());
    std::uint32_t bits = 1;
    for (std::size_t i = 0; i < a.size(); ++i) {
      bits = 1664525 * bits + 1013904223;
      if (units_[i] > 0 && !prescribed_[i]) a[i] = ((bits >> 31U) != 0 ? 1 : -1) / units_[i];
    }
    return a;
  }

 private:
  RoundingError there_and_back(std::span<const double> accelerations, double scale) {
    RoundingError error;
    double most = 0;
    for (std::size_t i = 0; i < there_.size(); ++i) {
      there_[i] = scale * accelerations[i];
      most = std::max(most, units_[i] * std::abs(there_[i]));
    }
    equations_.inverse_dynamics(y_, there_, efforts_, work_);
    std::copy(there_.begin(), there_.end(), back_.begin());  // what motions prescribe
    if (!forward_->forward_dynamics(y_, efforts_, back_, work_).ok()) {
      error.relative = std::numeric_limits<double>::infinity();
      return error;
    }
    for (std::size_t i = 0; i < there_.size(); ++i) {
      const double off = units_[i] * std::abs(back_[i] - there_[i]) / most;
      if (off <= error.relative) continue;
      error.relative = std::isfinite(off) ? off : std::numeric_limits<double>::infinity();
      error.speed = i;
    }
    return error;
  }

  /// √M_ii of every coordinate or, of many, of some between which the others have no unit and do not count.
  void find_units() {
    constexpr std::size_t most = 256;
    units_.assign(there_.size(), 0);
    const std::size_t stride = (there_.size() + most - 1) / most;
    for (std::size_t i = 0; i < there_.size(); i += stride) {
      there_[i] = 1;
      equations_.mass_times(y_, there_, efforts_, work_);
      units_[i] = std::sqrt(std::abs(efforts_[i]));
      there_[i] = 0;
    }
  }

  const EquationsOfMotion& equations_;
  const ForwardDynamics* forward_;
  std::vector<double> y_;  ///< at rest
  Work work_;
  std::vector<double> there_, efforts_, back_, units_;
  std::vector<bool> prescribed_;
};

}  // namespace withy
