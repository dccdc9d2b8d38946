/// \file
/// What a formulation keeps: a strain kinematics times a truncation (theory, section 2).
#pragma once

#include <memory>

namespace withy {

class StrainKinematics;

/// Which terms of the expansion r = X + Φq + ½qᵀΓq, θ = Ψq + ½qᵀΘq a strain kinematics keeps.
enum class StrainOrder {
  linear,     ///< Φ, Ψ alone
  quadratic,  ///< Φ, Ψ, Γ, Θ
  exact       ///< no expansion: a rod (rod.hpp); truncated to order 0 or 1 it is `quadratic`
};

/// How elastic coordinates enter the equations.
enum class Truncation {
  ruthless,   ///< order 0: inertia, velocity terms and loads at q = 0, q̇ = 0
  strict,     ///< order 1 of the equations: linear in (q, q̇, q̈)
  symmetric,  ///< order 1 of the kinetic energy: M linear in q, all equations from it by Lagrange's
  none        ///< all terms
};

struct Terms {
  StrainOrder strain = StrainOrder::quadratic;
  Truncation truncation = Truncation::none;
  /// Whether inertia forces that are products of speeds are kept, Coriolis and centrifugal ones among them. All bodies
  /// of a model do or none does, so that only the terms of the whole formulation say it; without truncation alone.
  bool products_of_speeds = true;
  /// What makes the second-order maps Γ, Θ of every body anew; null: they are the bodies' own, the complete ones.
  /// Model::in_kinematics.
  std::shared_ptr<const StrainKinematics> kinematics = nullptr;
};

}  // namespace withy
