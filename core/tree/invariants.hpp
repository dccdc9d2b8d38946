/// \file
/// Mass integrals of a node, expanded in its modal coordinates: constants made when a model is compiled.
#pragma once

#include <vector>

#include "withy/core/plugin/terms.hpp"
#include "withy/core/tree/tree.hpp"

namespace withy {

/// A node's kinetic energy is ½ Vᵀ I(q) V + Vᵀ C(q) q̇ + ½ q̇ᵀ G(q) q̇ with V the twist of its frame. These are the
/// coefficients that ruthless and strict truncation need: I to second order, C to first, G to zeroth; rigid bodies that
/// sections carry are included. Wrench and twist components angular first, node's axes and origin.
struct Invariants {
  RigidInertia I0;
  std::vector<RigidInertia> I1;     ///< ∂I/∂q_k; their mass is zero
  std::vector<RigidInertia> I2;     ///< ∂²I/∂q_k∂q_l, element k n + l
  Eigen::MatrixXd C0;               ///< 6×n
  std::vector<Eigen::MatrixXd> C1;  ///< ∂C/∂q_k, 6×n each
  Eigen::MatrixXd G0;               ///< n×n

  Invariants(const NodeSpec& node, StrainOrder order);
};

/// ∂G/∂q_k of the kinetic energy above, n×n each.
std::vector<Eigen::MatrixXd> modal_mass_slopes(const NodeSpec& node, StrainOrder order);
/// The node with Γ = Θ = 0 where the strain kinematics is linear.
NodeSpec in_strain_order(NodeSpec node, StrainOrder order);
/// The node with its frame moved to the hinge frame of a root that its modes move, by expansion to second order: exact
/// under ruthless and strict truncation.
NodeSpec rooted(NodeSpec node);

}  // namespace withy
