/// \file
/// A rod at the nodes of a quadrature: the discretization of exact kinematics, the same for every way to evaluate it.
#pragma once

#include <optional>
#include <vector>

#include "withy/core/plugin/rod.hpp"
#include "withy/core/shape/modal_shape.hpp"
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
///
/// Strains with kinks, as functions of a beam with a stiffness table have, end panels there. Where none then spans more
/// than 1.2 wave-number lengths, a panel has 8 nodes: a strain is interpolated to k⁸/(2⁷ 8!), at k = 0.6 to 3e-9.
///
/// Where the rows of a mass table would make more panels, panels go over them and span half as much: a node's mass is
/// then ∫ μ ℓ over the panel, ℓ the polynomial of degree 15 that is one there and zero at its other nodes. A product of
/// two functions, k = 2.4, is so integrated as a strain is interpolated. Masses that change abruptly could become
/// negative so: then panels end at the rows.
struct RodTable {
  static constexpr Eigen::Index order = 16, short_order = 8;
  static constexpr Eigen::Index turn_order = 8;

  /// A piece of the rod in which strains are smooth.
  struct Piece {
    double from, to;
    Eigen::MatrixXd strains;  ///< at the nodes of `turn` scaled to it: row 3j + c holds component c at node j
  };

  explicit RodTable(const Rod& rod);
  /// Strains along a piece, one column a mode.
  [[nodiscard]] Eigen::MatrixXd strains_between(double from, double to) const;
  /// What lies between two points of the rod, cut where strains have kinks.
  [[nodiscard]] std::vector<Piece> pieces_between(double from, double to) const;

  const Rod* rod;
  PanelQuadrature quadrature;
  std::optional<PointExpansion> root;       ///< where modes turn it: ψ_i(0), all other fields zero
  std::vector<RodSection> sections;         ///< at the nodes
  std::vector<double> masses;               ///< of the nodes [kg]
  std::vector<Matrix3> inertias;            ///< rotary, of the nodes, about their centres, section axes [kg m²]
  PanelQuadrature turn;                     ///< on [0, 1], for the rotation between two nodes
  std::vector<std::vector<Piece>> to_node;  ///< pieces_between the node before, or the root, and each node

  /// What of the nodes is beyond a point of the rod.
  struct Part {
    std::vector<double> shares;     ///< of the masses
    std::vector<Matrix3> inertias;  ///< as those of the whole
  };
  /// x in [0, length].
  [[nodiscard]] Part beyond(double x) const;

 private:
  void add_sections();

  std::vector<double> kinks_;  ///< of the strains
  std::vector<double> over_;   ///< edges of panels that go over kinks of the mass; empty: none does
};

}  // namespace withy
