/// \file
/// How much of a structure's mass each of its modes moves where its base shakes.
#pragma once

#include <Eigen/Core>
#include <array>

#include "withy/study/configuration.hpp"

namespace withy::study {

/// Of undamped modes φ of the free speeds, (K − ω² M) φ = 0 with the symmetric parts of K and M, about a state: a base
/// that shakes along the world's axis e pushes with φᵀ P e, P the momentum of unit speeds, and the effective mass of
/// the mode is (φᵀ P e)² / (φᵀ M φ).
struct EffectiveMasses {
  Eigen::VectorXd frequencies;     ///< [rad/s], lowest first; negative: √−ω² of a mode that grows
  Eigen::Matrix3Xd participation;  ///< φᵀ P / √(φᵀ M φ) [√kg], a column a mode
  double total = 0;                ///< of all bodies [kg]
  /// Whether the momentum of unit speeds is another along the world's axes as hinges go on that move: the shares are
  /// those of one angle, and a base that shakes is felt beside its own frequency.
  bool turning = false;
  /// Of each mode, along the world's axes [kg].
  [[nodiscard]] Eigen::Matrix3Xd masses() const { return participation.cwiseAbs2(); }
  /// Of all modes: the total where the free speeds let everything move along that axis; else what the modes leave of it
  /// moves with the base.
  [[nodiscard]] Eigen::Vector3d sum() const { return masses().rowwise().sum(); }
};

/// \throws std::domain_error where the mass matrix of the free speeds is not positive.
EffectiveMasses effective_masses(const Configuration& configuration);

}  // namespace withy::study
