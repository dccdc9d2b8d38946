/// \file
/// FramePaths::Pass: how bodies are deformed at a state, and their sections with them.
#pragma once

#include "withy/core/kinematics/frame_pass.hpp"

namespace withy {

template <class S>
inline void FramePaths::Pass<S>::deform(const Link& link, std::span<const double> positions,
                                        std::span<const double> speeds) {
  S* q = q_ + link.mode;
  double* q_dot = q_dot_ + link.mode;
  const double kept = link.truncation == Truncation::ruthless ? 0.0 : 1.0;
  for (Eigen::Index i = 0; i < link.modes; ++i) {
    const double value = kept * positions[link.modal.position + static_cast<std::size_t>(i)];
    q[i] = frame_pass::elastic<S>(value);
    q_dot[i] = kept * speeds[link.modal.speed + static_cast<std::size_t>(i)];
  }
  if constexpr (std::is_same_v<S, double>) {
    if (link.rod != nullptr) {
      const auto& rod = link.rod->kinematics;
      const int n = static_cast<int>(link.modes);
      const sweep::RodWork memory = sweep::rod_work_at(rod, n, sweep::at<Pack>(work_, link.rod->work));
      sweep::rod_motion<frame_pass::any_count>(rod, n, q, q_dot, memory);
      for (const std::size_t s : link.sections) {
        const Section& section = paths_.sections_[s];
        sweep::StationMotion<Spatial> motion;
        sweep::rod_station_motion<frame_pass::any_count>(rod, section.station, memory, n, q, q_dot, motion,
                                                         partials_ + section.partials);
        SectionMotion& out = sections_[s];
        for (int c = 0; c < 3; ++c) out.R.col(c) = frame_pass::vector(motion.frame.R.c[c]);
        out.r = frame_pass::vector(motion.frame.p);
        out.r_rate = out.R * frame_pass::vector(motion.rate.v);
        out.w_rate = out.R * frame_pass::vector(motion.rate.w);
        out.r_bias = out.R * frame_pass::vector(motion.bias.v) + out.w_rate.cross(out.r_rate);
        out.w_bias = out.R * frame_pass::vector(motion.bias.w);
      }
      return;
    }
  }
  for (const std::size_t s : link.sections) {
    if (paths_.sections_[s].turns) {
      expand(link, paths_.sections_[s], q, q_dot, sections_[s]);
    } else if constexpr (std::is_same_v<S, double>) {
      shift(link, paths_.sections_[s], q, q_dot, sections_[s]);
    }
  }
}

template <class S>
inline void FramePaths::Pass<S>::shift(const Link& link, const Section& section, const double* q, const double* q_dot,
                                       SectionMotion& out) {
  out = {section.at.X,    M3::Identity(),  M3::Identity(), Vector3::Zero(),
         Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  if (!section.moves) return;
  const bool bends = !section.gamma.empty() && link.order != StrainOrder::linear;
  for (Eigen::Index i = 0; i < link.modes; ++i) {
    const Vector3 phi = section.at.phi.col(i);
    Vector3 P = phi;
    const Vector3* gamma = bends ? section.gamma.data() + i * link.modes : nullptr;
    for (Eigen::Index j = 0; bends && j < link.modes; ++j) {
      P += gamma[j] * q[j];
      if (paths_.untruncated_) out.r_bias += gamma[j] * (q_dot[i] * q_dot[j]);
    }
    out.r += (phi + P) * (0.5 * q[i]);
    out.r_rate += P * q_dot[i];
    partials_[section.partials + static_cast<std::size_t>(i)] = {Triple(0, 0, 0), Triple(P[0], P[1], P[2])};
  }
}

template <class S>
inline void FramePaths::Pass<S>::expand(const Link& link, const Section& section, const S* q, const double* q_dot,
                                        SectionMotion& out) {
  out.r = section.at.X.template cast<S>();
  out.R.setIdentity();
  out.left.setIdentity();
  out.r_rate.setZero();
  out.w_rate.setZero();
  out.r_bias.setZero();
  out.w_bias.setZero();
  if (!section.moves) return;
  const auto row = [&](const std::vector<Vector3>& pairs, Eigen::Index i) -> const Vector3* {
    if (pairs.empty() || link.order == StrainOrder::linear) return nullptr;
    return pairs.data() + i * link.modes;
  };
  V3 theta = V3::Zero();
  Vector3 theta_rate = Vector3::Zero(), theta_bias = Vector3::Zero();
  for (Eigen::Index i = 0; i < link.modes; ++i) {
    V3 P = section.at.phi.col(i).template cast<S>(), T = section.at.psi.col(i).template cast<S>();
    const V3 P_0 = P, T_0 = T;
    const Vector3 *gamma = row(section.gamma, i), *turn = row(section.theta, i);
    for (Eigen::Index j = 0; gamma != nullptr && j < link.modes; ++j) P += gamma[j].template cast<S>() * q[j];
    for (Eigen::Index j = 0; turn != nullptr && j < link.modes; ++j) T += turn[j].template cast<S>() * q[j];
    out.r += (P_0 + P) * S(S(0.5) * q[i]);
    theta += (T_0 + T) * S(S(0.5) * q[i]);
    if constexpr (std::is_same_v<S, double>) {
      partials_[section.partials + static_cast<std::size_t>(i)] = {Triple(T[0], T[1], T[2]), Triple(P[0], P[1], P[2])};
      out.r_rate += P * q_dot[i];
      theta_rate += T * q_dot[i];
      for (Eigen::Index j = 0; paths_.untruncated_ && j < link.modes; ++j) {
        if (gamma != nullptr) out.r_bias += gamma[j] * (q_dot[i] * q_dot[j]);
        if (turn != nullptr) theta_bias += turn[j] * (q_dot[i] * q_dot[j]);
      }
    }
  }
  const detail::ExponentialCoefficients<S> k(S(theta.squaredNorm()));
  const M3 t = skew<S>(theta);
  const M3 tt = t * t;
  out.left += t * k.b + tt * k.c;
  out.R += t * k.a + tt * k.b;
  if constexpr (std::is_same_v<S, double>) {
    out.w_rate = out.left * theta_rate;
    if (!paths_.untruncated_) return;
    const Matrix3 turning = skew<double>(theta_rate);
    const Matrix3 left_rate =
        2 * theta.dot(theta_rate) * (k.db * t + k.dc * tt) + k.b * turning + k.c * (turning * t + t * turning);
    out.w_bias = left_rate * theta_rate + out.left * theta_bias;
  }
}

}  // namespace withy
