/// \file
/// What any flexible body boils down to once its modes are chosen: values only, made once.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "withy/core/spatial/pose.hpp"

namespace withy {

/// Second-order expansion of the motion of one material point in the modal coordinates q (theory (1), (2)):
///   r(q) = X + Φ q + ½ qᵀ Γ q   [m, body axes],   R(q) = exp(θ̂),  θ(q) = Ψ q + ½ qᵀ Θ q   [rad, body axes].
/// The undeformed section has the axes of the body frame. Γ and Θ are symmetric, one n×n matrix a component.
struct PointExpansion {
  Vector3 X = Vector3::Zero();
  Matrix3X phi;                          ///< Φ, 3×n
  std::array<Eigen::MatrixXd, 3> gamma;  ///< Γ, n×n each
  Matrix3X psi;                          ///< Ψ, 3×n
  std::array<Eigen::MatrixXd, 3> theta;  ///< Θ, n×n each

  /// A point that moves with the body frame: all fields zero.
  static PointExpansion rigid(const Vector3& X, Eigen::Index modes);
};

/// Part of the body's mass that moves as a point.
struct Particle {
  double mass = 0;  ///< [kg], ≥ 0
  PointExpansion at;
};

/// Rotary inertia carried by a section about its own axes, beside the particles' mass; it may be singular (a beam's
/// twist has inertia about x alone).
struct Section {
  Matrix3 inertia = Matrix3::Zero();  ///< [kg m²], section axes
  PointExpansion at;
};

/// A body as the dynamics sees it. Strain energy is ½ qᵀ K q, dissipation ½ q̇ᵀ D q̇.
struct ModalShape {
  std::vector<std::string> mode_names;  ///< as "bending_y[1]"; its size is the number of modes n
  std::vector<Particle> particles;      ///< quadrature of the mass
  std::vector<Section> sections;
  Eigen::MatrixXd stiffness;  ///< K, n×n, symmetric
  Eigen::MatrixXd damping;    ///< D, n×n, symmetric positive semidefinite
  double length = 0;          ///< characteristic length [m] that deflections are measured against; 0: none

  [[nodiscard]] Eigen::Index modes() const { return static_cast<Eigen::Index>(mode_names.size()); }
  /// How far a unit force displaces a point, summed over the three axes: tr Φ K⁻¹ Φᵀ [m/N]. A singular K counts as one
  /// that is stiffer by 10⁻¹² of its largest entry.
  [[nodiscard]] double compliance(const PointExpansion& at) const;
  /// Name of the most compliant of some points; of none that give, an empty one. \param points pairs of name and place
  template <class Points>
  [[nodiscard]] std::string most_compliant(const Points& points) const {
    std::string most;
    double greatest = 0;
    for (const auto& [name, at] : points) {
      const double c = compliance(at);
      if (c > greatest) most = name;
      greatest = std::max(greatest, c);
    }
    return most;
  }
};

/// A slender body cut across at a section: what lies beyond it, and how the section is strained.
struct BodyCut {
  PointExpansion at;                ///< motion of the section
  std::vector<Particle> particles;  ///< quadrature of the mass beyond
  std::vector<Section> sections;    ///< rotary inertia beyond
  Matrix3X curvature;               ///< κ of each coordinate [1/m], section axes: twist rate, then the two curvatures
  /// Moment of a curvature [N m²], section axes: GJ, EI_y, EI_z on the diagonal; zero where the body has no such
  /// strain.
  Matrix3 stiffness = Matrix3::Zero();
};

}  // namespace withy
