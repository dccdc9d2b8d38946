/// \file
/// First derivatives of a section's partial velocities, for the truncations of first order.
#pragma once

#include "withy/core/shape/modal_shape.hpp"
#include "withy/core/sweep/node.hpp"

namespace withy::sweep {

/// ∂J_i/∂q_k of a section at q = 0 in its own axes, element k n + i: with θ̂ the section's rotation to first order, J is
/// (1 − θ̂)(Φ + Γq) and (1 − ½θ̂)(Ψ + Θq).
template <class Space>
std::vector<typename Space::Twist> first_slopes(const PointExpansion& e) {
  std::vector<typename Space::Twist> slopes;
  const Eigen::Index n = e.phi.cols();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Vector3 turn = e.psi.col(k);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vector3 psi = e.psi.col(i), phi = e.phi.col(i);
      Vector6 J;
      for (Eigen::Index c = 0; c < 3; ++c) {
        J[c] = e.theta[static_cast<std::size_t>(c)](i, k);
        J[3 + c] = e.gamma[static_cast<std::size_t>(c)](i, k);
      }
      J.head<3>() -= 0.5 * turn.cross(psi);
      J.tail<3>() -= turn.cross(phi);
      slopes.push_back(Space::Twist::of(J));
    }
  }
  return slopes;
}

}  // namespace withy::sweep
