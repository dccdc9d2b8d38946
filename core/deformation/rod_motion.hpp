/// \file
/// Motion of the sections of a rod in exact kinematics, the plain way, for numbers and for numbers with derivatives.
#pragma once

#include <vector>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/deformation/rod_table.hpp"
#include "withy/core/spatial/jet.hpp"

namespace withy {

/// All sections of a rod at q, q̇, in the axes of its body. With u_i = R κ_i, e_i = R γ_i, ω = Σ w_i q̇_i and
/// s = R (e_x + γ),
///   r′ = s,  w_i′ = u_i,  P_i′ = w_i × s + e_i,  b′ = ω × Σ u_i q̇_i,  a′ = b × s + ω × (ω × s + 2 Σ e_i q̇_i):
/// positions, partial velocities and the biases b = Ẇ q̇, a = Ṗ q̇. What r, w_i, P_i are to first order is known,
/// X + Φ q, ψ_i, Φ_i; the rest is integrated. It is zero at x = 0 but where modes turn the root: there R = exp(θ̂) with
/// θ = Σ ψ_i q_i, w_i = T ψ_i and b = Ṫ θ̇, T(θ) the left Jacobian of the rotation group.
/// S is double or Jet.
template <class S>
class RodMotionOf {
 public:
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
  using RowVector = Eigen::Matrix<S, 1, Eigen::Dynamic>;

  /// The table must outlive the motion.
  RodMotionOf(const RodTable& table, const Vector& q, const Vector& q_dot);
  [[nodiscard]] PointMotionOf<S> at_node(std::size_t node) const;
  [[nodiscard]] PointMotionOf<S> at(double x) const;
  /// r(x) alone.
  [[nodiscard]] static Eigen::Matrix<S, 3, 1> position(const RodTable& table, const Vector& q, double x);

 private:
  [[nodiscard]] PointMotionOf<S> motion(const Eigen::Matrix<S, 3, 3>& R, const RowVector& integrals, double x,
                                        const RodSection& section) const;

  const RodTable& table_;
  Vector q_, q_dot_;
  RowVector root_;                         ///< what the integrals begin with at x = 0; empty: all with zero
  std::vector<Eigen::Matrix<S, 3, 3>> R_;  ///< at the nodes
  Matrix slopes_;                          ///< r′, w_i′, P_i′ but for what is known, b′, a′: one row a node
  Matrix at_nodes_;                        ///< their integrals
};

using RodMotion = RodMotionOf<double>;

}  // namespace withy
