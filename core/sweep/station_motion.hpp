/// \file
/// Motion of a section relative to its body's frame, in the section's own axes: what hinges and carried bodies see.
#pragma once

#include <cmath>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/sweep/joint_step.hpp"
#include "withy/core/sweep/mass_table.hpp"
#include "withy/core/sweep/node.hpp"

namespace withy::sweep {

/// Pose of the section's frame S in the body frame B, and its motion relative to B in S axes: twist J q̇ and J̇ q̇.
template <class Space>
struct StationMotion {
  typename Space::Frame frame;
  typename Space::Twist rate;  ///< J q̇
  typename Space::Twist bias;  ///< J̇ q̇, component-wise in S
};

/// detail::ExponentialCoefficients of a scalar.
template <class S>
struct ExponentialOf : detail::ExponentialCoefficients<S> {
  using detail::ExponentialCoefficients<S>::ExponentialCoefficients;
};
template <>
struct ExponentialOf<Lanes> {
  Lanes a, b, c, db, dc;
  explicit ExponentialOf(const Lanes& s) {
    for (std::size_t i = 0; i < cases_at_once; ++i) {
      const detail::ExponentialCoefficients<double> k(s[i]);
      a.set(i, k.a), b.set(i, k.b), c.set(i, k.c), db.set(i, k.db), dc.set(i, k.dc);
    }
  }
};

/// Evaluates a section at q, q̇; J receives n twists. R(q) = exp(θ̂) with θ = Ψq + ½qᵀΘq; in S axes the angular velocity
/// is T θ̇ with the right Jacobian T = 1 − b θ̂ + c θ̂².
template <class Space, int N>
inline void station_motion(const Fields<Space>& f, int modes, const typename Space::Scalar* q,
                           const typename Space::Scalar* q_dot, StationMotion<Space>& out, typename Space::Twist* J) {
  using Twist = typename Space::Twist;
  const int n = count<N>(modes);
  Twist displacement = Twist::zero(), rate = Twist::zero(), bias = Twist::zero();
  for (int i = 0; i < n; ++i) J[i] = f.first[static_cast<std::size_t>(i)];
  if (!f.second.empty()) {
    const Twist* second = f.second.data();
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j, ++second) {
        J[i] += *second * q[j];
        if (i != j) J[j] += *second * q[i];
        bias += *second * ((i == j ? 1.0 : 2.0) * q_dot[i] * q_dot[j]);
      }
    }
  }
  for (int i = 0; i < n; ++i) {
    displacement += (f.first[static_cast<std::size_t>(i)] + J[i]) * (0.5 * q[i]);
    rate += J[i] * q_dot[i];
  }
  if constexpr (Space::angular == 1) {
    sine_cosine(displacement.w, out.frame.R.s, out.frame.R.c);
    out.frame.p = {f.X.x + displacement.x, f.X.y + displacement.y};
    const auto turn = [&](const Twist& V) { return Twist::of(V.w, Space::unrotate(out.frame.R, {V.x, V.y})); };
    for (int i = 0; i < n; ++i) J[i] = turn(J[i]);
    out.rate = turn(rate);
    const Twist b = turn(bias);
    out.bias = {b.w, b.x + out.rate.w * out.rate.y, b.y - out.rate.w * out.rate.x};
  } else {
    using Scalar = typename Space::Scalar;
    using Triple = typename Space::Triple;
    using Block = typename Space::Block;
    const Triple t = displacement.w;
    const Scalar s = dot(t, t);
    const ExponentialOf<Scalar> k(s);
    // 1 + a θ̂ + b θ̂², with θ̂² = θθᵀ − s 1.
    const auto polynomial = [&](const Scalar& a, const Scalar& b) {
      const Scalar d = 1 - b * s;
      Block m = {{Triple(d, a * t[2], -a * t[1]), Triple(-a * t[2], d, a * t[0]), Triple(a * t[1], -a * t[0], d)}};
      m.subtract_outer(t * -b, t);
      return m;
    };
    out.frame.R = polynomial(k.a, k.b);
    out.frame.p = f.X + displacement.v;
    const Block right = polynomial(-k.b, k.c);
    const Block back = transpose(out.frame.R);
    for (int i = 0; i < n; ++i) J[i] = {right * J[i].w, back * J[i].v};
    out.rate = {right * rate.w, back * rate.v};
    // Ṫ θ̇ with θ̇ × θ̇ = 0.
    const Scalar s_rate = 2 * dot(t, rate.w);
    const Triple x = cross(t, rate.w);
    const Triple turning = cross(t, x) * (k.dc * s_rate) - x * (k.db * s_rate) + cross(rate.w, x) * k.c;
    out.bias = {turning + right * bias.w, back * bias.v - cross(out.rate.w, out.rate.v)};
  }
}

}  // namespace withy::sweep
