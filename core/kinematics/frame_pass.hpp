/// \file
/// One pass over the links of FramePaths: their motion outward and the efforts of wrenches inward, in numbers or in
/// duals. For frame_paths.cpp. Deformation and the efforts of wrenches stand in the two headers included last.
#pragma once

#include <utility>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/kinematics/frame_pass_values.hpp"
#include "withy/core/kinematics/frame_paths.hpp"
#include "withy/core/sweep/rod/rod_terms.hpp"

namespace withy {

/// A rod with the stations that carry frames, and its place in the work memory.
struct FramePaths::Rod {
  sweep::RodKinematics<Spatial> kinematics;
  std::size_t work = 0;
};

template <class S>
class FramePaths::Pass {
  using HingeStep = frame_pass::HingeStep;
  using LinkMotion = frame_pass::LinkMotion<S>;
  using SectionMotion = frame_pass::SectionMotion<S>;
  using V3 = frame_pass::V3<S>;
  using M3 = frame_pass::M3<S>;

 public:
  static std::size_t take(const FramePaths& paths, sweep::WorkLayout& memory) {
    const std::size_t at = memory.take<LinkMotion>(paths.links_.size());
    memory.take<SectionMotion>(paths.sections_.size());
    memory.take<S>(paths.modes_);
    memory.take<double>(paths.modes_);
    return at;
  }
  Pass(const FramePaths& paths, std::byte* work, std::size_t offset) : paths_(paths), work_(work) {
    sweep::WorkLayout memory;
    links_ = sweep::at<LinkMotion>(work + offset, memory.take<LinkMotion>(paths.links_.size()));
    sections_ = sweep::at<SectionMotion>(work + offset, memory.take<SectionMotion>(paths.sections_.size()));
    q_ = sweep::at<S>(work + offset, memory.take<S>(paths.modes_));
    q_dot_ = sweep::at<double>(work + offset, memory.take<double>(paths.modes_));
    hinges_ = sweep::at<HingeStep>(work, paths.hinge_offset_);
    partials_ = sweep::at<Spatial::Twist>(work, paths.partials_offset_);
  }

  /// Poses, and velocities where S is a number.
  void outward(std::span<const double> positions, std::span<const double> speeds) {
    for (std::size_t l = 0; l < paths_.links_.size(); ++l) {
      const Link& link = paths_.links_[l];
      deform(link, positions, speeds);
      HingeStep& hinge = hinges_[l];
      LinkMotion& m = links_[l];
      if constexpr (std::is_same_v<S, double>) move(link, positions, speeds, hinge);
      M3 R_F = link.F.pose.R.template cast<S>();
      Vector3 p = link.F.pose.p, w = Vector3::Zero(), v = Vector3::Zero();
      m.arm_F.setZero();
      if (!link.at_world) {
        const LinkMotion& parent = links_[link.F.link];
        const SectionMotion& section = sections_[link.F.section];
        R_F = parent.R_B * (section.R * R_F);
        m.arm_F = parent.R_B * (section.r + section.R * link.F.pose.p.template cast<S>());
        if constexpr (std::is_same_v<S, double>) carry(parent, section, link.F.pose, m.arm_F, p, w, v);
      }
      m.R_M = R_F * hinge.R.template cast<S>();
      m.arm_h = R_F * hinge.p.template cast<S>();
      const SectionMotion& root = sections_[link.M.section];
      m.R_B = m.R_M * (root.R * link.M.pose.R.template cast<S>()).transpose();
      const V3 offset = root.R * link.M.pose.p.template cast<S>();
      m.arm_M = m.R_B * (root.r + offset);
      if constexpr (std::is_same_v<S, double>) {
        v += w.cross(m.arm_h) + m.R_M * hinge.v;
        w += m.R_M * hinge.w;
        m.w = w - m.R_B * root.w_rate;
        m.v = v - m.w.cross(m.arm_M) - m.R_B * (root.r_rate + root.w_rate.cross(offset));
        m.p = p + m.arm_h - m.arm_M;
      }
    }
  }

  [[nodiscard]] FrameMotion frame(const Place& at) const {
    const LinkMotion& link = links_[at.link];
    const SectionMotion& section = sections_[at.section];
    FrameMotion f;
    if (!paths_.sections_[at.section].turns) {
      const Vector3 arm = link.R_B * section.r;
      return {link.R_B, link.p + arm, link.w, link.v + link.w.cross(arm) + link.R_B * section.r_rate};
    }
    f.R = link.R_B * section.R * at.pose.R;
    carry(link, section, at.pose, link.R_B * (section.r + section.R * at.pose.p), f.position, f.angular_velocity,
          f.velocity);
    return f;
  }

  /// Accelerations of the links' frames where no speed changes, after `outward`.
  void turn(FrameAcceleration* of_links) const requires(std::is_same_v<S, double>) {
    for (std::size_t l = 0; l < paths_.links_.size(); ++l) {
      const Link& link = paths_.links_[l];
      const LinkMotion& m = links_[l];
      const HingeStep& hinge = hinges_[l];
      Vector3 w = Vector3::Zero();  // of F
      FrameAcceleration A;
      if (!link.at_world) {
        w = links_[link.F.link].w + links_[link.F.link].R_B * sections_[link.F.section].w_rate;
        A = acceleration(link.F, of_links);
      }
      const Vector3 turn = m.R_M * hinge.w, slide = m.R_M * hinge.v;
      A.linear += A.angular.cross(m.arm_h) + w.cross(w.cross(m.arm_h)) + 2 * w.cross(slide) + turn.cross(slide) +
                  m.R_M * hinge.bias.tail<3>();
      A.angular += w.cross(turn) + m.R_M * hinge.bias.head<3>();
      // The frame follows M.
      const Place root{l, link.M.section, link.M.pose};
      const auto [turned, moved] = relative(root, m.arm_M);
      of_links[l].angular = A.angular - turned;
      of_links[l].linear = A.linear - of_links[l].angular.cross(m.arm_M) - moved;
    }
  }
  [[nodiscard]] FrameAcceleration acceleration(const Place& at, const FrameAcceleration* of_links) const {
    const Vector3 arm = links_[at.link].R_B * (sections_[at.section].r + sections_[at.section].R * at.pose.p);
    const auto [turned, moved] = relative(at, arm);
    const FrameAcceleration& link = of_links[at.link];
    return {link.angular + turned, link.linear + link.angular.cross(arm) + moved};
  }

  void inward(std::span<const Wrench> wrenches, std::span<double> efforts) {
    for (std::size_t l = 0; l < paths_.links_.size(); ++l) {
      links_[l].force.setZero();
      links_[l].moment.setZero();
    }
    push_particles(wrenches, efforts);
    for (std::size_t i = 0; i < wrenches.size(); ++i)
      if (paths_.sections_[paths_.frames_[i].section].turns)
        attach(paths_.frames_[i], wrenches[i].force.template cast<S>(), wrenches[i].moment.template cast<S>(), efforts);
    for (std::size_t l = paths_.links_.size(); l-- > 0;) {
      const Link& link = paths_.links_[l];
      const LinkMotion& m = links_[l];
      const HingeStep& hinge = hinges_[l];
      const V3 force = m.force;
      // The frame follows M: what its own modes move there, they move the frame the other way.
      const V3 moment = m.moment - m.arm_M.cross(force);
      const V3 in_body = m.R_B.transpose() * force;
      const V3 offset = sections_[link.M.section].R * link.M.pose.p.template cast<S>();
      const V3 about_section = m.R_B.transpose() * moment + offset.cross(in_body);
      add_modal(link, link.M.section, in_body, about_section, -1, efforts);
      const V3 f = m.R_M.transpose() * force, t = m.R_M.transpose() * moment;
      for (std::size_t j = 0; j < link.slot.speeds; ++j) {
        const auto k = static_cast<Eigen::Index>(j);
        const V3 turn = hinge.angular.col(k).template cast<S>(), slide = hinge.linear.col(k).template cast<S>();
        efforts[link.slot.speed + j] += frame_pass::on_hinge(S(turn.dot(t) + slide.dot(f)));
      }
      if (!link.at_world) attach(link.F, force, moment + m.arm_h.cross(force), efforts);
    }
  }

 private:
  template <class>
  friend class Pass;

  /// Forces on particles, on the links and their modes.
  void push_particles(std::span<const Wrench> wrenches, std::span<double> efforts) requires(std::is_same_v<S, double>);
  /// The same in duals: what is linear in the forces is summed in numbers, so that duals are met once a link.
  void push_particles(std::span<const Wrench> wrenches, std::span<double> efforts);
  /// Adds a force on a particle to the sums of its link, and Φ_j fᵀ and (Γq)_j fᵀ to those of each mode.
  void gather(const Place& at, const Vector3& force, const Pass<double>& full, frame_pass::Gathered& sums,
              Matrix3* by_mode) const;
  /// With R the link's frame and K = Σ r fᵀ the moment about its origin is that of K R in its axes, and the effort on a
  /// mode tr(Σ P fᵀ R).
  void push(std::size_t l, const frame_pass::Gathered& sums, const Matrix3* by_mode, std::span<double> efforts);
  /// What of the accelerations of a frame at `arm` from its link's frame does not come from those of the latter.
  [[nodiscard]] std::pair<Vector3, Vector3> relative(const Place& at, const Vector3& arm) const {
    const LinkMotion& link = links_[at.link];
    const SectionMotion& s = sections_[at.section];
    const Vector3 offset = s.R * at.pose.p, spin = link.R_B * s.w_rate;
    const Vector3 slide = link.R_B * (s.r_rate + s.w_rate.cross(offset));
    const Vector3 bent = s.r_bias + s.w_bias.cross(offset) + s.w_rate.cross(s.w_rate.cross(offset));
    return {link.R_B * s.w_bias + link.w.cross(spin),
            link.w.cross(link.w.cross(arm)) + 2 * link.w.cross(slide) + link.R_B * bent};
  }

  /// q, q̇ as far as the truncation keeps them, and the sections' motion.
  void deform(const Link& link, std::span<const double> positions, std::span<const double> speeds);
  /// Theory (1), of a particle.
  void shift(const Link& link, const Section& section, const double* q, const double* q_dot, SectionMotion& out);
  /// Theory (1), (2).
  void expand(const Link& link, const Section& section, const S* q, const double* q_dot, SectionMotion& out);

  static void move(const Link& link, std::span<const double> positions, std::span<const double> speeds,
                   HingeStep& step) {
    HingeMotion motion;
    const auto n = static_cast<Eigen::Index>(link.slot.speeds);
    motion.H.resize(6, n);
    const auto rates = speeds.subspan(link.slot.speed, link.slot.speeds);
    link.hinge->hinge->motion(positions.subspan(link.slot.position, link.slot.positions), rates, motion);
    step.R = motion.pose.R;
    step.p = motion.pose.p;
    step.angular.leftCols(n) = motion.H.topRows<3>();
    step.linear.leftCols(n) = motion.H.bottomRows<3>();
    step.bias = motion.bias;
    step.w.setZero();
    step.v.setZero();
    for (Eigen::Index j = 0; j < n; ++j) {
      step.w += step.angular.col(j) * rates[static_cast<std::size_t>(j)];
      step.v += step.linear.col(j) * rates[static_cast<std::size_t>(j)];
    }
  }

  /// Position and velocities of a frame at `pose` in a section, `arm` from the link's frame to it.
  static void carry(const LinkMotion& link, const SectionMotion& section, const Pose& pose, const Vector3& arm,
                    Vector3& p, Vector3& w, Vector3& v) {
    p = link.p + arm;
    w = link.w + link.R_B * section.w_rate;
    v = link.v + link.w.cross(arm) + link.R_B * (section.r_rate + section.w_rate.cross(section.R * pose.p));
  }

  /// A wrench about the origin of a frame at `at`, on the link's modes and its frame.
  void attach(const Place& at, const V3& force, const V3& moment, std::span<double> efforts);
  /// Efforts sign·(P_iᵀ f + W_iᵀ m) of a wrench at a section, body axes.
  void add_modal(const Link& link, std::size_t index, const V3& force, const V3& moment, double sign,
                 std::span<double> efforts);

  const FramePaths& paths_;
  std::byte* work_;
  LinkMotion* links_;
  SectionMotion* sections_;
  S* q_;
  double* q_dot_;
  HingeStep* hinges_;
  Spatial::Twist* partials_;
};

}  // namespace withy

#include "withy/core/kinematics/frame_pass_efforts.hpp"
#include "withy/core/kinematics/frame_pass_sections.hpp"
