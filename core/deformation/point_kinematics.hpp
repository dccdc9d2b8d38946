/// \file
/// How the material points of one body move with its modal coordinates, in any strain kinematics.
#pragma once

#include <span>

#include "withy/core/shape/modal_shape.hpp"

namespace withy {

/// Motion of one material point relative to the body frame, in body axes, for given q and q̇.
struct PointMotion {
  Vector3 r = Vector3::Zero();       ///< position [m]
  Matrix3 R = Matrix3::Identity();   ///< rotation of the section
  Matrix3X P;                        ///< partial velocities ∂ṙ/∂q̇ = ∂r/∂q, 3×n
  Matrix3X W;                        ///< partial angular velocities ∂ω/∂q̇, 3×n
  Vector3 r_bias = Vector3::Zero();  ///< Ṗ q̇ [m/s²]
  Vector3 w_bias = Vector3::Zero();  ///< Ẇ q̇ [rad/s²]
};

/// Motion of a list of material points of one body as functions of its modal coordinates. Implementations are
/// immutable; several threads may evaluate one.
class PointKinematics {
 public:
  virtual ~PointKinematics() = default;
  [[nodiscard]] virtual Eigen::Index modes() const = 0;
  [[nodiscard]] virtual std::size_t points() const = 0;
  /// Fills one PointMotion a point. q, q̇: modal coordinates and rates, n each.
  virtual void evaluate(std::span<const double> q, std::span<const double> q_dot,
                        std::span<PointMotion> motions) const = 0;
};

}  // namespace withy
