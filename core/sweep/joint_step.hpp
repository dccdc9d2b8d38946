/// \file
/// What the sweeps do at a hinge: its motion on the way out, and the rates between State and the aligned axes.
#pragma once

#include "withy/core/sweep/node.hpp"
#include "withy/core/sweep/sine_cosine.hpp"

namespace withy::sweep {

/// A hinge at one state.
template <class Space>
struct JointMotion {
  typename Space::Frame SM;    ///< pose of M in the frame that holds the hinge on the parent
  typename Space::Twist rate;  ///< H ẋ in M
  typename Space::Twist bias;  ///< Ḣ ẋ, component-wise in M; zero unless `has_bias`
};

/// Whether the hinge has one rate along one row of the twist.
constexpr bool single(Joint kind) { return kind == Joint::rotate || kind == Joint::slide; }

/// Whether Ḣ ẋ may differ from zero.
constexpr bool has_bias(Joint kind) { return !single(kind) && kind != Joint::fixed; }

/// H ẍ of a hinge with one rate, for its local rate.
template <class Space>
inline typename Space::Twist along(Joint kind, typename Space::Scalar rate) {
  return kind == Joint::rotate ? Space::Twist::turning(rate) : Space::Twist::sliding(rate);
}

/// Hᵀ F of a hinge with one rate.
template <class Space>
inline typename Space::Scalar component(Joint kind, const typename Space::Twist& F) {
  return kind == Joint::rotate ? F.turn() : F.slide();
}

/// Columns of a hinge's motion subspace H in M, for hinges with several rates; Eigen, as the hinge gives them.
inline HingeMotion general_motion(const JointData<Spatial>& joint, const double* x, const double* u) {
  HingeMotion m;
  m.H.resize(6, static_cast<Eigen::Index>(joint.speeds));
  joint.hinge->motion({x, joint.positions}, {u, joint.speeds}, m);
  return m;
}

/// joint_motion of a hinge with several rates, apart: no pass has its code more than once.
[[gnu::noinline]] inline void general_joint_motion(const JointData<Spatial>& joint, const double* x, const double* u,
                                                   JointMotion<Spatial>& out) {
  const HingeMotion m = general_motion(joint, x, u);
  out.SM = Spatial::compose(joint.F, Spatial::make(m.pose));
  Vector6 rate = Vector6::Zero();
  for (Eigen::Index i = 0; i < m.H.cols(); ++i) rate += m.H.col(i) * u[i];
  out.rate = Spatial::Twist::of(rate);
  out.bias = Spatial::Twist::of(m.bias);
}

/// Pose, rate and bias of a hinge at coordinates x and rates u (its own, not the whole State's).
template <class Space>
inline void joint_motion(const JointData<Space>& joint, const typename Space::Scalar* x,
                         const typename Space::Scalar* u, JointMotion<Space>& out) {
  using Twist = typename Space::Twist;
  out.rate = out.bias = Twist::zero();
  switch (joint.kind) {
    case Joint::fixed:
      out.SM = joint.F;
      return;
    case Joint::rotate: {
      out.rate = Twist::turning(joint.direction * u[0]);
      out.SM.p = joint.F.p;
      out.SM.R = joint.F.R;
      if (!joint.pose_matters) return;
      typename Space::Scalar sine, cosine;
      sine_cosine(joint.direction * x[0], sine, cosine);
      if constexpr (Space::angular == 1) {
        out.SM.R = Space::compose(joint.F.R, {cosine, sine});
      } else {
        const auto& F = joint.F.R;
        out.SM.R.c[0] = F.c[0] * cosine + F.c[1] * sine;
        out.SM.R.c[1] = F.c[1] * cosine - F.c[0] * sine;
      }
      return;
    }
    case Joint::slide: {
      const Twist along = Twist::sliding(joint.direction * x[0]);
      out.SM.R = joint.F.R;
      if constexpr (Space::angular == 1) {
        out.SM.p = joint.F.p + Space::rotate(joint.F.R, {along.x, along.y});
      } else {
        out.SM.p = joint.F.p + Space::rotate(joint.F.R, along.v);
      }
      out.rate = Twist::sliding(joint.direction * u[0]);
      return;
    }
    default:
      break;
  }
  if constexpr (has_general_hinges<Space>) general_joint_motion(joint, x, u, out);
}

/// V × H ẋ of a hinge, `rate` its H ẋ.
template <class Space>
inline typename Space::Twist cross_rate(Joint kind, const typename Space::Twist& V, const typename Space::Twist& rate) {
  if constexpr (in_lanes<Space> && Space::angular == 3) {
    // Three components are three operations there: none with the rate's zeros.
    if (kind == Joint::fixed) return Space::Twist::zero();
    const Lanes r = kind == Joint::rotate ? rate.turn() : rate.slide();
    if (kind == Joint::rotate) return {{V.w[1] * r, -V.w[0] * r, 0.0}, {V.v[1] * r, -V.v[0] * r, 0.0}};
    return {LaneTriple::zero(), {0.0, V.w[2] * r, -V.w[1] * r}};
  } else {
    return Space::cross(V, rate);
  }
}

/// H a of a driven hinge at coordinates x and rates u (its own) for the accelerations a of its rates.
template <class Space>
[[gnu::noinline]] typename Space::Twist driven_acceleration(const JointData<Space>& joint,
                                                            const typename Space::Scalar* x,
                                                            const typename Space::Scalar* u,
                                                            const typename Space::Scalar* a) {
  if (single(joint.kind)) return along<Space>(joint.kind, joint.direction * a[0]);
  auto A = Space::Twist::zero();
  if constexpr (has_general_hinges<Space>) {
    const HingeMotion m = general_motion(joint, x, u);
    for (Eigen::Index i = 0; i < m.H.cols(); ++i) A += Space::Twist::of(m.H.col(i)) * a[i];
  }
  return A;
}

/// Sets the efforts Hᵀ F on its rates, F the wrench that it passes on.
template <class Space>
[[gnu::noinline]] void driven_efforts(const JointData<Space>& joint, const typename Space::Scalar* x,
                                      const typename Space::Scalar* u, const typename Space::Twist& F,
                                      typename Space::Scalar* efforts) {
  if (single(joint.kind)) {
    efforts[0] = joint.direction * component<Space>(joint.kind, F);
    return;
  }
  if constexpr (has_general_hinges<Space>) {
    const HingeMotion m = general_motion(joint, x, u);
    for (Eigen::Index i = 0; i < m.H.cols(); ++i) efforts[i] = Space::dot(Space::Twist::of(m.H.col(i)), F);
  }
}

/// Adds the effort that a reflected inertia takes at acceleration a of the hinge's only rate.
template <class Space>
inline void add_reflected(const JointData<Space>& joint, const typename Space::Scalar& a,
                          typename Space::Scalar* efforts) {
  if (joint.speeds == 1) efforts[0] += joint.reflected * a;
}

}  // namespace withy::sweep
