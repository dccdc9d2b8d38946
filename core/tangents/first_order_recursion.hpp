/// \file
/// Inverse dynamics of the kinetic energy of first order (truncation `symmetric`) in any scalar, by a recursion over
/// particles: independent of the sweep, which works with integrals over bodies, and of the dense reference. It
/// allocates. Vectors are in world axes.
///
/// With ε marking q in all poses and Jacobians but not the rates, velocities V = J(x, εq) u are none of the poses:
/// these move with V − (1 − ε)Vᴱ, Vᴱ = J_E q̇ the share of the modes. Of a particle with p = m v, what all that hangs
/// inward of it sees is (theory (7))
///   f = m v̇,   n = (x − o) × f − (1 − ε) vᴱ × p,
/// and with the momentum P, h about the same point, the rows of a hinge's rates and of the modes of a section S are
///   Hᵀ ((n, f) + (1 − ε) Vᴱ ×* (h, P)),     J_Sᵀ ((n, f) − (1 − ε)(V − Vᴱ) ×* (h, P)),
/// summed over both orders. Weight and wrenches have a potential of second order: J to the second order in the rows of
/// hinges, to the first in those of modes.
#pragma once

#include <vector>

#include "withy/core/tangents/recursion.hpp"
#include "withy/core/tangents/series.hpp"

namespace withy::analysis {

/// The recursion of one state; a ruthless body among the others has q = q̇ = 0 in it.
template <class T>
class FirstOrderRecursion {
 public:
  using V3 = Eigen::Matrix<T, 3, 1>;
  using M3 = Eigen::Matrix<T, 3, 3>;
  using VX = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  /// One state a hinge and a body, in the model's order.
  FirstOrderRecursion(const Model& model, std::vector<HingeState<T>> hinges, std::vector<BodyState<T>> bodies);

  /// d/dt ∂T/∂u − ∂T/∂π less what weight and the wrenches give: the efforts that the accelerations need beside those of
  /// stiffness and damping.
  [[nodiscard]] VX efforts(const std::vector<AppliedWrench<T>>& wrenches) const;

 private:
  using Place = Series<V3, 3>;
  using Turn = Series<M3, 3>;
  using Vector = Series<V3, 2>;

  struct Frame {
    Turn R = Turn::constant(M3::Identity());
    Place p = Place::zero();
    Vector w = Vector::zero(), v = w, w_modes = w, v_modes = w, alpha = w, a = w;  ///< `modes`: the share of q̇
  };
  /// Motion of a section relative to its body, body axes; partial velocities one a mode.
  struct Relative {
    Turn R;
    Place r;
    std::vector<Vector> P, W;
    Vector rate, spin;          ///< P q̇, W q̇
    Vector r_change, w_change;  ///< d/dt of these in axes that stand: P q̈ + ε P′[q̇] q̇, and of W
  };
  /// What a body passes on, about its frame's origin.
  struct Load {
    Vector force = Vector::zero(), moment = force;   ///< f, n
    Vector momentum = force, spin_momentum = force;  ///< P, h
    V3 dead_force = V3::Zero();                      ///< weight and wrenches
    Place dead_moment = Place::zero();
    VX modes;
  };

  static Frame outward(const Frame& B, const Relative& m);
  static Frame inward(const Frame& M, const Relative& m);
  static Frame across(const Frame& F, const HingeState<T>& h);
  [[nodiscard]] Relative section(std::size_t b, const PointExpansion& e, bool turns) const;
  [[nodiscard]] Relative relative(int body, int frame, const Pose& offset) const;
  [[nodiscard]] Load own_load(std::size_t b) const;
  void add_particle(Load& load, const Frame& B, const Relative& m, double mass) const;
  void add_section(Load& load, const Frame& B, const Relative& m, const Matrix3& inertia) const;
  static void add_wrench(Load& load, const Frame& B, const Relative& m, const AppliedWrench<T>& wrench);
  /// Adds ± what `carried`, about the frame A fixed to the section that moves as m in B, does on B's modes.
  static void add_rows(VX& modes, const Frame& B, const Relative& m, const Frame& A, const Load& carried, double sign);
  /// The same wrenches about another point.
  static Load about(Load load, const Place& arm);

  const Model& model_;
  std::vector<HingeState<T>> hinges_;
  std::vector<BodyState<T>> states_;
  std::vector<Relative> parent_, child_;                     ///< of each hinge: F in the parent, M in the child
  std::vector<Frame> outer_frames_, hinge_frames_, frames_;  ///< F and M of each hinge, B of each body
};

extern template class FirstOrderRecursion<double>;
extern template class FirstOrderRecursion<Jet>;

}  // namespace withy::analysis
