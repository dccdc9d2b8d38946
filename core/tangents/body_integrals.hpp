/// \file
/// What a body's mass is to the motion of its frame, its shape and the rates of its modes being given: sums over
/// particles and sections that directions along which these do not change share.
#pragma once

#include <vector>

#include "withy/core/deformation/point_motion.hpp"

namespace withy::analysis {

/// In body axes about the origin of the body frame. With c the bias Ṗ q̇ of a particle, ω_r and β the rate of a
/// section's turn relative to the body and its bias Ẇ q̇, I its inertia.
template <class T>
struct BodyIntegrals {
  using V3 = Eigen::Matrix<T, 3, 1>;
  using M3 = Eigen::Matrix<T, 3, 3>;
  using M3X = Eigen::Matrix<T, 3, Eigen::Dynamic>;
  using MX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  using VX = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  double mass = 0;
  V3 r = V3::Zero(), r_rate = V3::Zero(), bias = V3::Zero(), r_bias = V3::Zero();  ///< Σ m r, m ṙ, m c, m r × c
  M3 rr = M3::Zero(), r_r_rate = M3::Zero();                                       ///< Σ m r rᵀ, m r ṙᵀ
  M3X P, r_P;                                                                      ///< Σ m P, m r × P
  std::vector<M3> P_r, P_r_rate;  ///< of each mode: Σ m P rᵀ, m P ṙᵀ
  VX P_bias;                      ///< Σ m Pᵀ c, and of sections
  MX PP;                          ///< Σ m PᵀP + WᵀIW
  // Of sections: n = I (α + ω × ω_r + β + W q̈) + (ω + ω_r) × I (ω + ω_r) as J α + ω × (J ω + h) + G ω + k + F q̈.
  bool turns = false;  ///< whether there are any
  M3 J = M3::Zero(), G = M3::Zero();
  V3 h = V3::Zero(), k = V3::Zero();
  M3X F;
  std::vector<M3> W_J;  ///< of each mode: X with Wᵀ(ω × I ω) = ωᵀ X ω
  M3X W_G;              ///< of each mode: what is linear in ω

  explicit BodyIntegrals(Eigen::Index modes)
      : P(M3X::Zero(3, modes)),
        r_P(P),
        P_r(static_cast<std::size_t>(modes), M3::Zero()),
        P_r_rate(P_r),
        P_bias(VX::Zero(modes)),
        PP(MX::Zero(modes, modes)),
        F(P),
        W_J(P_r),
        W_G(P) {}

  void add_particle(const PointMotionOf<T>& m, double weight) {
    mass += weight;
    const V3 at = T(weight) * m.r;
    r += at;
    r_rate += T(weight) * m.r_rate;
    bias += T(weight) * m.r_bias;
    r_bias += at.cross(m.r_bias);
    rr += at.lazyProduct(m.r.transpose());
    r_r_rate += at.lazyProduct(m.r_rate.transpose());
    for (Eigen::Index i = 0; i < P.cols(); ++i) {
      const V3 of_mode = m.P.col(i), p = T(weight) * of_mode;
      const auto mode = static_cast<std::size_t>(i);
      P.col(i) += p;
      r_P.col(i) += at.cross(of_mode);
      P_r[mode] += p.lazyProduct(m.r.transpose());
      P_r_rate[mode] += p.lazyProduct(m.r_rate.transpose());
      P_bias[i] += p.dot(m.r_bias);
      for (Eigen::Index j = 0; j < P.cols(); ++j) PP(i, j) += p.dot(V3(m.P.col(j)));
    }
  }

  void add_section(const PointMotionOf<T>& m, const Matrix3& inertia) {
    turns = true;
    const M3 turned = m.R.lazyProduct(inertia.cast<T>()), I = turned.lazyProduct(m.R.transpose());
    const M3 rate = skew<T>(m.w_rate);
    const V3 spin = I * m.w_rate;
    const V3 rest = I * m.w_bias + m.w_rate.cross(spin);
    J += I;
    h += spin;
    G += rate.lazyProduct(I) - I.lazyProduct(rate);
    k += rest;
    for (Eigen::Index i = 0; i < F.cols(); ++i) {
      const V3 W = m.W.col(i), IW = I * W;
      F.col(i) += IW;
      W_J[static_cast<std::size_t>(i)] -= skew<T>(W).lazyProduct(I);
      W_G.col(i) += spin.cross(W) + I * V3(W.cross(m.w_rate)) - IW.cross(m.w_rate);
      P_bias[i] += W.dot(rest);
      for (Eigen::Index j = 0; j < F.cols(); ++j) PP(i, j) += IW.dot(V3(m.W.col(j)));
    }
  }
};

}  // namespace withy::analysis
