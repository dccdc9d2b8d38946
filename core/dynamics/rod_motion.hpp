/// \file
/// Motion of the sections of a rod in exact kinematics, the plain way.
#pragma once

#include <vector>

#include "withy/core/shape/point_motion.hpp"
#include "withy/core/shape/rod_table.hpp"

namespace withy {

/// All sections of a rod at q, q̇, in the axes of its body. With u_i = R κ_i, ω = Σ w_i q̇_i and t = R e_x,
///   r′ = t,  w_i′ = u_i,  P_i′ = w_i × t,  b′ = ω × Σ u_i q̇_i,  a′ = b × t + ω × (ω × t),
/// all zero at x = 0: positions, partial velocities and the biases b = Ẇ q̇, a = Ṗ q̇. What r, w_i, P_i are to first
/// order is known, X + Φ q, ψ_i, Φ_i; the rest is integrated.
class RodMotion {
 public:
  /// The table must outlive the motion.
  RodMotion(const RodTable& table, const Eigen::VectorXd& q, const Eigen::VectorXd& q_dot);
  [[nodiscard]] PointMotionOf<double> at_node(std::size_t node) const;
  [[nodiscard]] PointMotionOf<double> at(double x) const;
  /// r(x) alone.
  [[nodiscard]] static Vector3 position(const RodTable& table, const Eigen::VectorXd& q, double x);

 private:
  [[nodiscard]] PointMotionOf<double> motion(const Matrix3& R, const Eigen::RowVectorXd& integrals, double x,
                                             const RodSection& section) const;

  const RodTable& table_;
  Eigen::VectorXd q_, q_dot_;
  std::vector<Matrix3> R_;    ///< at the nodes
  Eigen::MatrixXd slopes_;    ///< r′, w_i′, P_i′ but for what is known, b′, a′: one row a node
  Eigen::MatrixXd at_nodes_;  ///< their integrals
};

}  // namespace withy
