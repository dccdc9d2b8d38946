/// \file
/// Equations of motion whose evaluations somebody else makes.
#pragma once

#include "withy/core/plugin/forward_dynamics.hpp"
#include "withy/core/plugin/forwarding_equations.hpp"

namespace withy::campaign {

/// Those of a model, but that `derivatives` asks: a run with them stops in the middle of a step and goes on when it has
/// been answered. The equations must outlive it.
class AskingEquations : public ForwardingEquations, public ForwardDynamics {
 public:
  /// Of equations that take efforts, as all that have lanes do.
  explicit AskingEquations(const EquationsOfMotion& own)
      : own_(own), forward_(dynamic_cast<const ForwardDynamics&>(own)) {}

  Evaluation forward_dynamics(std::span<const double> y, std::span<const double> efforts, std::span<double> u_dot,
                              Work& work) const noexcept override {
    return forward_.forward_dynamics(y, efforts, u_dot, work);
  }

 private:
  [[nodiscard]] const EquationsOfMotion& own() const noexcept override { return own_; }
  const EquationsOfMotion& own_;
  const ForwardDynamics& forward_;
};

}  // namespace withy::campaign
