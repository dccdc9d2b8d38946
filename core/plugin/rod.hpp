/// \file
/// What a body offers for the `exact` strain kinematics.
#pragma once

#include <vector>

#include "withy/core/spatial/pose.hpp"

namespace withy {

/// A section of a rod.
struct RodSection {
  Matrix3X strain;             ///< κ_i [1/m], section axes, 3×n
  Matrix3X rotation;           ///< ψ_i = ψ_i(0) + ∫₀ˣ κ_i, 3×n
  Matrix3X deflection;         ///< Φ_i = Φ_i(0) + ∫₀ˣ ψ_i × e_x + γ_i [m], 3×n
  double mass_per_length;      ///< [kg/m]
  Matrix3 inertia_per_length;  ///< rotary inertia about the section's centre [kg m], section axes, semidefinite
  Matrix3X elongation = {};  ///< γ_i: extension and the strains of shear, section axes, 3×n; empty: the rod has none
};

/// A rod along x of its body's frame. Twist rate and curvatures κ = Σ κ_i(x) q_i and, where it has them, extension and
/// shear γ = Σ γ_i(x) q_i are linear in the modal coordinates; the sections' rotation R and the axis r follow without
/// expansion (theory, section 2; Simo 1985):
///   R′ = R κ̂,  r′ = R (e_x + γ),  R(0) = exp(Σ ψ̂_i(0) q_i),  r(0) = Σ Φ_i(0) q_i.
/// Most rods are clamped to the body's frame, ψ_i(0) = 0 and Φ_i(0) = 0; modes of a pinned root turn it, those of a
/// free one move it too. ψ_i(0) below 1e-9 of the greatest ψ_i is rounding, and turns nothing. Stations and particles
/// of the body with coordinate X.x lie on the axis at x = X.x, and the second-order expansion of their motion is their
/// PointExpansion. Immutable, as its body.
class Rod {
 public:
  virtual ~Rod() = default;
  [[nodiscard]] virtual Eigen::Index modes() const = 0;
  [[nodiscard]] virtual double length() const = 0;  ///< [m]
  /// Greatest wave number [1/m] of the strains: the quadrature is chosen by it. At most most_waves / length().
  [[nodiscard]] virtual double wave_number() const = 0;
  /// Where sections change without being smooth, between 0 and the length, increasing: the quadrature has its panels
  /// between them.
  [[nodiscard]] virtual std::vector<double> kinks() const { return {}; }
  /// The same where mass and inertia per length alone do, as at the rows of a table: panels may go over them.
  [[nodiscard]] virtual std::vector<double> mass_kinks() const { return {}; }
  /// The section at x in [0, length].
  [[nodiscard]] virtual RodSection section(double x) const = 0;
};

}  // namespace withy
