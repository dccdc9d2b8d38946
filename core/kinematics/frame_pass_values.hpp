/// \file
/// Scalars and values of FramePaths::Pass.
#pragma once

#include <type_traits>

#include "withy/core/spatial/jet.hpp"
#include "withy/core/spatial/pack.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy::frame_pass {

template <class S>
using V3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using M3 = Eigen::Matrix<S, 3, 3>;

/// a + εb with ε² = 0: the first order in the elastic coordinates.
using Dual = DualNumber<double, 1>;

/// The same of duals: with εq + δq for q the coefficient of εδ is twice the second order.
using Second = DualNumber<Dual, 1>;

/// An elastic coordinate in a scalar.
template <class S>
inline S elastic(double q) {
  if constexpr (std::is_same_v<S, double>) {
    return q;
  } else if constexpr (std::is_same_v<S, Dual>) {
    Dual d(0.0);
    d.derivatives()[0] = q;
    return d;
  } else {
    Second d(elastic<Dual>(q));
    d.derivatives()[0] = Dual(q);
    return d;
  }
}

/// What a mode's row keeps of an expansion: all, or the first order.
inline double on_mode(double x) { return x; }
inline double on_mode(const Dual& x) { return x.value() + x.derivatives()[0]; }
inline double on_mode(const Second& x) { return x.value().value() + x.derivatives()[0].value(); }
/// A hinge's row: the second order as well where both come from one potential.
inline double on_hinge(double x) { return x; }
inline double on_hinge(const Dual& x) { return on_mode(x); }
inline double on_hinge(const Second& x) { return on_mode(x) + 0.5 * x.derivatives()[0].derivatives()[0]; }

/// The hinge's motion, found once for all scalars.
struct HingeStep {
  Matrix3 R;
  Vector3 p, w, v;  ///< twist of M relative to F in M axes
  Vector6 bias;     ///< its derivative there where the rates do not change
  Eigen::Matrix<double, 3, 6> angular, linear;
};

template <class S>
struct LinkMotion {
  M3<S> R_B, R_M;
  V3<S> arm_F, arm_h, arm_M;  ///< from the parent's frame to F, from F to M, from this frame to M; world axes [m]
  Vector3 p, w, v;            ///< of this frame; in numbers alone
  V3<S> force, moment;        ///< gathered on the way inward: at this frame's origin, world axes
};

/// A section relative to its body, body axes.
template <class S>
struct SectionMotion {
  V3<S> r;
  M3<S> R, left;  ///< left Jacobian of the rotation
  Vector3 r_rate, w_rate;
  Vector3 r_bias, w_bias;  ///< r̈ and ẇ where the rates do not change; of untruncated paths, in numbers
};

/// Forces on the particles of a link, with the places r = X + Φq + ½qᵀΓq where they act: sums over the particles.
struct Gathered {
  Vector3 force;                     ///< Σ f, world axes
  Matrix3 reference, first, second;  ///< Σ X fᵀ, Σ Φq fᵀ, Σ ½qᵀΓq fᵀ
};

inline Vector3 vector(const Triple& t) { return {t[0], t[1], t[2]}; }

constexpr int any_count = -1;  ///< of modes: not known when compiled

}  // namespace withy::frame_pass
