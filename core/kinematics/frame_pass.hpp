/// \file
/// One pass over the links of FramePaths: their motion outward and the efforts of wrenches inward, in numbers or in
/// duals. For frame_paths.cpp.
#pragma once

#include <utility>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/kinematics/frame_paths.hpp"
#include "withy/core/spatial/jet.hpp"
#include "withy/core/sweep/rod/rod_terms.hpp"

namespace withy {
namespace frame_pass {

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

}  // namespace frame_pass

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
  void push_particles(std::span<const Wrench> wrenches, std::span<double> efforts) requires(std::is_same_v<S, double>) {
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
  /// The same in duals: what is linear in the forces is summed in numbers, so that duals are met once a link.
  void push_particles(std::span<const Wrench> wrenches, std::span<double> efforts) {
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

  /// Adds a force on a particle to the sums of its link, and Φ_j fᵀ and (Γq)_j fᵀ to those of each mode.
  void gather(const Place& at, const Vector3& force, const Pass<double>& full, frame_pass::Gathered& sums,
              Matrix3* by_mode) const {
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

  /// With R the link's frame and K = Σ r fᵀ the moment about its origin is that of K R in its axes, and the effort on a
  /// mode tr(Σ P fᵀ R).
  void push(std::size_t l, const frame_pass::Gathered& sums, const Matrix3* by_mode, std::span<double> efforts) {
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
  void deform(const Link& link, std::span<const double> positions, std::span<const double> speeds) {
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

  /// Theory (1), of a particle.
  void shift(const Link& link, const Section& section, const double* q, const double* q_dot, SectionMotion& out) {
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

  /// Theory (1), (2).
  void expand(const Link& link, const Section& section, const S* q, const double* q_dot, SectionMotion& out) {
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
        partials_[section.partials + static_cast<std::size_t>(i)] = {Triple(T[0], T[1], T[2]),
                                                                     Triple(P[0], P[1], P[2])};
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
  void attach(const Place& at, const V3& force, const V3& moment, std::span<double> efforts) {
    LinkMotion& m = links_[at.link];
    const SectionMotion& section = sections_[at.section];
    const V3 in_body = m.R_B.transpose() * force;
    const V3 offset = section.R * at.pose.p.template cast<S>();
    const V3 about_section = m.R_B.transpose() * moment + offset.cross(in_body);
    add_modal(paths_.links_[at.link], at.section, in_body, about_section, 1, efforts);
    m.force += force;
    m.moment += m.R_B * (about_section + section.r.cross(in_body));
  }

  /// Efforts sign·(P_iᵀ f + W_iᵀ m) of a wrench at a section, body axes.
  void add_modal(const Link& link, std::size_t index, const V3& force, const V3& moment, double sign,
                 std::span<double> efforts) {
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
      S effort = S(section.at.phi.col(i).template cast<S>().dot(force) +
                   section.at.psi.col(i).template cast<S>().dot(turning));
      const Vector3 *gamma = row(section.gamma, i), *turn = row(section.theta, i);
      for (Eigen::Index j = 0; gamma != nullptr && j < link.modes; ++j)
        effort += S(gamma[j].template cast<S>().dot(force)) * q[j];
      for (Eigen::Index j = 0; turn != nullptr && j < link.modes; ++j)
        effort += S(turn[j].template cast<S>().dot(turning)) * q[j];
      e[i] += sign * frame_pass::on_mode(effort);
    }
  }

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
