/// \file
/// The exact ∂ẏ/∂y of a model's equations of motion, for implicit integrators.
#pragma once

#include "withy/core/plugin/equations.hpp"
#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy {

/// With the residual r(δ, u, a) = M a − f − τ of TangentDynamics at a = u̇, and ẋ = N(x) u,
///   ∂u̇/∂u = −M⁻¹ ∂r/∂u,  ∂u̇/∂x = −M⁻¹ ∂r/∂δ N⁺,  ∂ẋ/∂u = N,  ∂ẋ/∂x = ∂(N u)/∂x,
/// N⁺ the pseudo-inverse; with continuous states z of loads, ż = g, also ∂u̇/∂z = −M⁻¹ ∂r/∂z, ∂ż/∂x = ∂g/∂δ N⁺ and
/// the derivatives of g; where g sees u̇, ∂g/∂u̇ times those of u̇ comes on top.
/// Accelerations that motions prescribe do not depend on y.
class StateJacobian final : public Linearization {
 public:
  StateJacobian(std::shared_ptr<const Model> model, Terms terms) : dynamics_(std::move(model), terms) {}
  Evaluation jacobian(double t, std::span<const double> y, std::span<const double> y_dot,
                      std::span<double> jacobian) const override;
  [[nodiscard]] std::vector<std::string> differenced(double t, std::span<const double> y) const override;

 private:
  TangentDynamics dynamics_;
};

}  // namespace withy
