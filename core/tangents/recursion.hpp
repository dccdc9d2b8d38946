/// \file
/// Inverse dynamics of a tree in any scalar: the recursive Newton–Euler algorithm (Luh, Walker & Paul 1980) with modal
/// coordinates, for the derivatives of analyses. It allocates. Vectors are in world axes.
///
/// Outward, with V, A the velocity and acceleration of frames: the root section of each body from its hinge, the body
/// frame from that section, then every particle. Inward, with the wrench (f, n) that a body needs, at the frame's
/// origin: the residual of the modes Σ Pᵀ f + Wᵀ n, that of the hinge Hᵀ (n, f), the rest to the parent.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "withy/core/deformation/rod_motion.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/tangents/body_integrals.hpp"

namespace withy::analysis {

/// a + εb with ε² = 0, in numbers T.
template <class T>
using Dual = DualNumber<T, 1>;

/// A hinge at one state: HingeMotion, its rates and their derivatives.
template <class S>
struct HingeState {
  Eigen::Matrix<S, 3, 3> R;
  Eigen::Matrix<S, 3, 1> p;
  Eigen::Matrix<S, 6, Eigen::Dynamic> H;
  Eigen::Matrix<S, 6, 1> bias;
  Eigen::Matrix<S, Eigen::Dynamic, 1> rates, accelerations;
};

/// A body at one state. `rod` is its exact kinematics or null.
template <class S>
struct BodyState {
  StrainOrder order = StrainOrder::quadratic;
  const RodTable* rod = nullptr;
  bool plain = false;  ///< q, q̇ carry no derivatives: its sections and particles move in plain numbers
  Eigen::Matrix<S, Eigen::Dynamic, 1> q, q_dot, q_ddot;
};

/// A frame's axes, position, angular velocity and velocity, as FrameMotion.
template <class S>
struct FrameState {
  Eigen::Matrix<S, 3, 3> R;
  Eigen::Matrix<S, 3, 1> p, w, v;
};

/// A scalar without the derivatives of an analysis: with those of a truncation alone, or none.
template <class S>
struct PlainScalar {
  using Type = S;
};
template <>
struct PlainScalar<Jet> {
  using Type = double;
};
template <>
struct PlainScalar<Dual<Jet>> {
  using Type = Dual<double>;
};

/// A wrench of a load and where it acts.
template <class S>
struct AppliedWrench {
  FrameIndex at;
  Eigen::Matrix<S, 3, 1> moment, force;
};

/// What is known of a body whose q, q̇ carry no derivatives, in plain numbers T: for all directions once.
template <class T>
struct PlainBody {
  std::optional<RodMotionOf<double>> rod;  ///< of a body in exact kinematics
  std::optional<BodyIntegrals<T>> integrals;
};
/// One a body.
template <class T>
using PlainBodies = std::vector<PlainBody<T>>;

/// Motion of a body frame in its own axes: a point fixed to the body at r accelerates by a + turn r less gravity, one
/// that moves at ṙ in it by twice ṙ = 2 ω × ṙ more.
template <class S>
struct Turning {
  Eigen::Matrix<S, 3, 1> w, alpha, a;
  Eigen::Matrix<S, 3, 3> ww, turn, twice;  ///< ww = ω ωᵀ
};

/// What a body needs to move as it does, about its frame's origin, and on its modes.
template <class S>
struct BodyLoad {
  Eigen::Matrix<S, 3, 1> force = Eigen::Matrix<S, 3, 1>::Zero(), moment = force;
  Eigen::Matrix<S, Eigen::Dynamic, 1> modes;
};

/// The recursion of one state. Members are defined in recursion_members.hpp and instantiated in files of their own:
/// numbers that carry derivatives take a compiler long.
template <class S>
class Recursion {
 public:
  using V3 = Eigen::Matrix<S, 3, 1>;
  using M3 = Eigen::Matrix<S, 3, 3>;
  using VX = Eigen::Matrix<S, Eigen::Dynamic, 1>;

  using Plain = typename PlainScalar<S>::Type;

  /// One state a hinge and a body, in the model's order. \param known of the bodies in plain numbers, at the same q, q̇
  /// for all recursions that share it: what one has found the next ones know
  Recursion(const Model& model, std::vector<HingeState<S>> hinges, std::vector<BodyState<S>> bodies,
            std::shared_ptr<PlainBodies<Plain>> known = nullptr);
  ~Recursion();

  /// Σ m Jᵀ (a − g) + Σ J_ωᵀ (I α + ω × I ω): the efforts that the accelerations need beside those of stiffness and
  /// damping, less what the wrenches give.
  [[nodiscard]] VX efforts(const std::vector<AppliedWrench<S>>& wrenches) const;
  [[nodiscard]] FrameState<S> frame_state(FrameIndex at) const;
  /// Position of a frame of a body in the world, and the displacement r − X of its section in the body frame.
  [[nodiscard]] std::pair<V3, V3> frame_position(int body, int frame) const;

  friend Eigen::VectorXd sizes_of(const Recursion<double>& tree, const std::vector<AppliedWrench<double>>& wrenches);

 private:
  static constexpr bool truncating = !std::is_same_v<S, double> && !std::is_same_v<S, Jet>;

  struct Frame {
    M3 R = M3::Identity();
    V3 p = V3::Zero(), w = V3::Zero(), v = V3::Zero(), alpha = V3::Zero(), a = V3::Zero();
  };
  using Load = BodyLoad<S>;

  static constexpr bool has_plain = !std::is_same_v<S, Plain>;
  using PlainVector = Eigen::Matrix<Plain, Eigen::Dynamic, 1>;

  /// The frame that moves as `m` in B.
  static Frame outward(const Frame& B, const PointMotionOf<S>& m, const VX& q_ddot);
  /// A frame that stands in B at `arm` (world axes) with axes R there; no derivatives of R, nor of `arm` where it is
  /// zero.
  static Frame carried(const Frame& B, const M3& R, const V3& arm);
  /// The body frame whose frame M moves as `m` in it.
  static Frame inward(const Frame& M, const PointMotionOf<S>& m, const VX& q_ddot);
  static Frame across(const Frame& F, const HingeState<S>& h);
  [[nodiscard]] PointMotionOf<S> section(std::size_t b, const PointExpansion& e) const;
  [[nodiscard]] PointMotionOf<S> relative(int body, int frame, const Pose& offset) const;
  [[nodiscard]] Turning<S> turning(std::size_t b) const;
  /// What a particle needs to move as it does, weight counted, and a section to turn; body axes.
  static V3 force_on(const Turning<S>& t, const PointMotionOf<S>& m, double mass, const VX& q_ddot);
  static V3 moment_on(const Turning<S>& t, const PointMotionOf<S>& m, const Matrix3& inertia, const VX& q_ddot);
  template <class OfParticle, class OfSection>
  void for_mass(std::size_t b, OfParticle&& particle, OfSection&& section) const;
  [[nodiscard]] Load own_load(std::size_t b) const;
  /// Of a body whose q, q̇ carry no derivatives.
  [[nodiscard]] const BodyIntegrals<Plain>& integrals(std::size_t b) const;

  const Model& model_;
  std::vector<HingeState<S>> hinges_;
  std::vector<BodyState<S>> states_;
  std::vector<std::optional<RodMotionOf<std::conditional_t<truncating, double, S>>>> rods_;
  std::shared_ptr<PlainBodies<Plain>> known_;       ///< of bodies in plain numbers
  std::vector<PlainVector> plain_q_, plain_q_dot_;  ///< of these
  std::vector<PointMotionOf<S>> parent_, child_;    ///< of each hinge: F in the parent, M in the child
  std::vector<Frame> hinge_frames_, frames_;        ///< M of each hinge, B of each body
};

/// What the efforts are made of amounts to where each force pulls along the partial velocities of the speeds: sums of
/// magnitudes, one a speed, against which rounding and imbalance are small or not.
Eigen::VectorXd sizes_of(const Recursion<double>& tree, const std::vector<AppliedWrench<double>>& wrenches);

extern template class Recursion<double>;
extern template class Recursion<Jet>;
extern template class Recursion<Dual<double>>;
extern template class Recursion<Dual<Jet>>;

}  // namespace withy::analysis
