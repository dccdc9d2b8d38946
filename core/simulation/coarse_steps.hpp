/// \file
/// Steps whose number is known beforehand, for differences between models that have to be told at a given price.
#pragma once

#include <memory>
#include <vector>

#include "withy/core/plugin/integrator.hpp"

namespace withy {

/// A semi-implicit method of order 2 in equal steps, or in steps to given times. With the flexible tree as ẏ = H(t, y,
/// z) at z = y, the second argument what stiffness and damping act on (LinearlyImplicit), and γ = 1 − √½,
///   k₁ = H(t + γh, Y₁, y + γh k₁),   k₂ = H(t + h, Y₂, y + (1 − γ)h k₁ + γh k₂) at y_new:
/// L-stable, two evaluations. Y₁ and Y₂ follow the slopes at the start, which is k₂ of the step before, and of k₁.
/// There is no control of the error: who compares two models with common steps compares errors that both make.
class CoarseSteps final : public Integrator {
 public:
  /// \param step greatest one [s]; intervals between discontinuities are divided equally
  explicit CoarseSteps(double step) : step_(step) {}
  /// \param ends of steps [s], increasing; after the last a step goes to where it is limited. Where a run had short
  /// steps much happened, and ends at every so many of them are close.
  explicit CoarseSteps(std::vector<double> ends);
  /// The stepper keeps no memory: a run by it cannot be resumed.
  /// \throws std::invalid_argument where the equations are not linearly implicit.
  [[nodiscard]] std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override;
  [[nodiscard]] int order() const override { return 2; }

 private:
  double step_;
  std::vector<double> ends_;
};

}  // namespace withy
