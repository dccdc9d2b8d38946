/// \file
/// A rod at the nodes of a quadrature: the discretization of exact kinematics, the same for every way to evaluate it.
#pragma once

#include <vector>

#include "withy/core/plugin/rod.hpp"
#include "withy/core/shape/panel_quadrature.hpp"

namespace withy {

/// The rod's mass is that of its nodes. What is linear in q comes from the rod itself; only the rest of an integral ∫₀ˣ
/// is that of the interpolant in each panel, so that the discretization leaves nothing at small q.
///
/// A panel has 16 Gauss nodes and spans at most 4.75 wave-number lengths, so that two modes of a clamped beam fit one.
/// On [−1, 1] a function of wave number k is interpolated to k¹⁶/(2¹⁵ 16!): 2e-12 for a strain (k = 2.4), 1e-7 for a
/// product of two, which has an angle for a factor. Products of two strains' integrals are integrated over the panel to
/// rounding, of four, k = 9.5, to (ke/32)³² ≈ 1e-3,
/// with angles to the fourth power for amplitude.
struct RodTable {
  static constexpr Eigen::Index order = 16;
  static constexpr Eigen::Index turn_order = 8;

  explicit RodTable(const Rod& rod);
  /// Strains at the nodes of `turn` scaled to [from, to]: row 3j + c holds component c at node j, one column a mode.
  [[nodiscard]] Eigen::MatrixXd strains_between(double from, double to) const;

  const Rod* rod;
  PanelQuadrature quadrature;
  std::vector<RodSection> sections;      ///< at the nodes
  PanelQuadrature turn;                  ///< on [0, 1], for the rotation between two nodes
  std::vector<Eigen::MatrixXd> to_node;  ///< strains_between the node before, or the root, and each node
};

}  // namespace withy
