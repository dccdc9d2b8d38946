/// \file
/// Lagrange's equations of the kinetic energy of first order, T = ½ uᵀ (M₀(x) + M₁(x, q)) u (truncation `symmetric`),
/// from explicit Jacobians of every particle: what the sweep and the tangents are checked against.
///
/// In dual numbers, J(ε) = J(x, εq) with the rates u not scaled, v = J(ε) u, and ⟨·⟩ the sum of value and derivative,
/// T = ⟨Σ ½ m v²⟩. Since D_i J_k = D_k J_i for a coordinate s_k = εq_k of the deformation and any direction i,
/// d/dt ∂T/∂u_r − ∂T/∂π_r is
///   ⟨Σ m (J_r · v̇ + (1 − ε) v · d_r)⟩,   d_r = −D[q̇] J_r of a hinge's rate,  d_k = D_k (J_R ẋ) of a mode's,
///   v̇ = J u̇ + a_R + (1 + ε) D[q̇](J_R ẋ) + ε D[q̇](J_E) q̇,
/// with a_R the acceleration at constant ẋ and frozen shape. Weight and loads are −∂/∂(x, q) of a potential of second
/// order in q: the rows of hinges have J to the second order, those of modes to the first.
#pragma once

#include <span>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/terms.hpp"

namespace withy::reference {

/// A wrench of a load and where it acts.
struct PlacedWrench {
  FrameIndex at;
  Wrench wrench;
};

/// M and f of M u̇ = f without stiffness and damping, and the efforts of the wrenches.
struct FirstOrderSystem {
  Eigen::MatrixXd M;
  Eigen::VectorXd f, applied;
};

/// The system at y. A ruthless body among the others has q = q̇ = 0 in it. `terms`: one a body.
FirstOrderSystem first_order_system(const Model& model, const std::vector<Terms>& terms, std::span<const double> y,
                                    const std::vector<PlacedWrench>& wrenches);

}  // namespace withy::reference
