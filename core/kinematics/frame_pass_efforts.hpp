/// \file
/// FramePaths::Pass: what wrenches at frames and forces on particles do to links and modes.
#pragma once

#include "withy/core/kinematics/frame_pass.hpp"

namespace withy {

template <class S>
inline void FramePaths::Pass<S>::push_particles(std::span<const Wrench> wrenches,
                                                std::span<double> efforts) requires(std::is_same_v<S, double>) {
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    const Place& at = paths_.frames_[i];
    const Section& section = paths_.sections_[at.section];
    if (section.turns) continue;
    const Link& link = paths_.links_[at.link];
    LinkMotion& m = links_[at.link];
    const Vector3 in_body = m.R_B.transpose() * wrenches[i].force;
    m.force += wrenches[i].force;
    m.moment += m.R_B * sections_[at.section].r.cross(in_body);
    const Spatial::Twist* J = partials_ + section.partials;
    for (Eigen::Index j = 0; section.moves && j < link.modes; ++j)
      efforts[link.modal.speed + static_cast<std::size_t>(j)] += frame_pass::vector(J[j].v).dot(in_body);
  }
}

template <class S>
inline void FramePaths::Pass<S>::push_particles(std::span<const Wrench> wrenches, std::span<double> efforts) {
  auto* const gathered = sweep::at<frame_pass::Gathered>(work_, paths_.gathered_offset_);
  auto* const by_mode = sweep::at<Matrix3>(work_, paths_.by_mode_offset_);
  for (std::size_t l = 0; l < paths_.links_.size(); ++l)
    gathered[l] = {Vector3::Zero(), Matrix3::Zero(), Matrix3::Zero(), Matrix3::Zero()};
  for (std::size_t k = 0; k < 2 * paths_.modes_; ++k) by_mode[k].setZero();
  const Pass<double> full(paths_, work_, paths_.full_offset_);
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    const Place& at = paths_.frames_[i];
    if (!paths_.sections_[at.section].turns)
      gather(at, wrenches[i].force, full, gathered[at.link], by_mode + 2 * paths_.links_[at.link].mode);
  }
  for (std::size_t l = 0; l < paths_.links_.size(); ++l)
    if (paths_.links_[l].particles) push(l, gathered[l], by_mode + 2 * paths_.links_[l].mode, efforts);
}

template <class S>
inline void FramePaths::Pass<S>::gather(const Place& at, const Vector3& force, const Pass<double>& full,
                                        frame_pass::Gathered& sums, Matrix3* by_mode) const {
  const Section& section = paths_.sections_[at.section];
  const Link& link = paths_.links_[at.link];
  sums.force += force;
  sums.reference += section.at.X * force.transpose();
  if (!section.moves) return;
  const double* q = full.q_ + link.mode;
  const Spatial::Twist* J = partials_ + section.partials;
  Vector3 first = Vector3::Zero();
  for (Eigen::Index j = 0; j < link.modes; ++j) {
    const Vector3 phi = section.at.phi.col(j);
    first += phi * q[j];
    by_mode[2 * j] += phi * force.transpose();
    by_mode[2 * j + 1] += (frame_pass::vector(J[j].v) - phi) * force.transpose();
  }
  sums.first += first * force.transpose();
  sums.second += (full.sections_[at.section].r - section.at.X - first) * force.transpose();
}

template <class S>
inline void FramePaths::Pass<S>::push(std::size_t l, const frame_pass::Gathered& sums, const Matrix3* by_mode,
                                      std::span<double> efforts) {
  const Link& link = paths_.links_[l];
  LinkMotion& m = links_[l];
  const S small = frame_pass::elastic<S>(1.0), smaller = small * small;
  const M3 K = sums.reference.template cast<S>() + M3(sums.first.template cast<S>() * small) +
               M3(sums.second.template cast<S>() * smaller);
  const M3 W = K * m.R_B;
  m.force += sums.force.template cast<S>();
  m.moment += m.R_B * V3(W(1, 2) - W(2, 1), W(2, 0) - W(0, 2), W(0, 1) - W(1, 0));
  for (Eigen::Index j = 0; j < link.modes; ++j) {
    const M3 P = by_mode[2 * j].template cast<S>() + M3(by_mode[2 * j + 1].template cast<S>() * small);
    S effort(0.0);
    for (Eigen::Index a = 0; a < 3; ++a)
      for (Eigen::Index b = 0; b < 3; ++b) effort += P(b, a) * m.R_B(a, b);
    efforts[link.modal.speed + static_cast<std::size_t>(j)] += frame_pass::on_mode(effort);
  }
}

template <class S>
inline void FramePaths::Pass<S>::attach(const Place& at, const V3& force, const V3& moment, std::span<double> efforts) {
  LinkMotion& m = links_[at.link];
  const SectionMotion& section = sections_[at.section];
  const V3 in_body = m.R_B.transpose() * force;
  const V3 offset = section.R * at.pose.p.template cast<S>();
  const V3 about_section = m.R_B.transpose() * moment + offset.cross(in_body);
  add_modal(paths_.links_[at.link], at.section, in_body, about_section, 1, efforts);
  m.force += force;
  m.moment += m.R_B * (about_section + section.r.cross(in_body));
}

template <class S>
inline void FramePaths::Pass<S>::add_modal(const Link& link, std::size_t index, const V3& force, const V3& moment,
                                           double sign, std::span<double> efforts) {
  const Section& section = paths_.sections_[index];
  if (!section.moves) return;
  const SectionMotion& motion = sections_[index];
  double* e = efforts.data() + link.modal.speed;
  if constexpr (std::is_same_v<S, double>) {
    if (link.rod != nullptr) {
      const Vector3 f = motion.R.transpose() * force, t = motion.R.transpose() * moment;
      const Spatial::Twist* J = partials_ + section.partials;
      for (Eigen::Index i = 0; i < link.modes; ++i)
        e[i] += sign * (frame_pass::vector(J[i].w).dot(t) + frame_pass::vector(J[i].v).dot(f));
      return;
    }
  }
  const V3 turning = motion.left.transpose() * moment;
  if constexpr (std::is_same_v<S, double>) {
    const Spatial::Twist* J = partials_ + section.partials;  // as expand has found them
    for (Eigen::Index i = 0; i < link.modes; ++i)
      e[i] += sign * (frame_pass::vector(J[i].v).dot(force) + frame_pass::vector(J[i].w).dot(turning));
    return;
  }
  const S* q = q_ + link.mode;
  const auto row = [&](const std::vector<Vector3>& pairs, Eigen::Index i) -> const Vector3* {
    if (pairs.empty() || link.order == StrainOrder::linear) return nullptr;
    return pairs.data() + i * link.modes;
  };
  for (Eigen::Index i = 0; i < link.modes; ++i) {
    S effort =
        S(section.at.phi.col(i).template cast<S>().dot(force) + section.at.psi.col(i).template cast<S>().dot(turning));
    const Vector3 *gamma = row(section.gamma, i), *turn = row(section.theta, i);
    for (Eigen::Index j = 0; gamma != nullptr && j < link.modes; ++j)
      effort += S(gamma[j].template cast<S>().dot(force)) * q[j];
    for (Eigen::Index j = 0; turn != nullptr && j < link.modes; ++j)
      effort += S(turn[j].template cast<S>().dot(turning)) * q[j];
    e[i] += sign * frame_pass::on_mode(effort);
  }
}

}  // namespace withy
