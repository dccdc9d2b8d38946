#include "withy/core/sweep/frame_paths.hpp"

#include <algorithm>
#include <new>
#include <unsupported/Eigen/AutoDiff>

#include "withy/core/shape/point_motion.hpp"
#include "withy/core/sweep/rod_terms.hpp"

namespace withy {
namespace {

template <class S>
using V3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using M3 = Eigen::Matrix<S, 3, 3>;

/// a + εb with ε² = 0: the first order in the elastic coordinates.
using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, 1, 1>>;

Dual dual(double value, double derivative) {
  Dual d(value);
  d.derivatives()[0] = derivative;
  return d;
}

/// What remains of an expansion to first order at ε = 1.
double total(double x) { return x; }
double total(const Dual& x) { return x.value() + x.derivatives()[0]; }

/// The hinge's motion, found once for all scalars.
struct HingeStep {
  Matrix3 R;
  Vector3 p, w, v;  ///< twist of M relative to F in M axes
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
};

Vector3 component(const std::array<Eigen::MatrixXd, 3>& m, Eigen::Index i, Eigen::Index j) {
  return {m[0](i, j), m[1](i, j), m[2](i, j)};
}

Vector3 vector(const Triple& t) { return {t[0], t[1], t[2]}; }

constexpr int any_count = -1;  ///< of modes: not known when compiled

}  // namespace

/// A rod with the stations that carry frames, and its place in the work memory.
struct FramePaths::Rod {
  sweep::RodKinematics<Spatial> kinematics;
  std::size_t work = 0;
};

template <class S>
class FramePaths::Pass {
 public:
  static std::size_t take(const FramePaths& paths, sweep::WorkLayout& memory) {
    const std::size_t at = memory.take<LinkMotion<S>>(paths.links_.size());
    memory.take<SectionMotion<S>>(paths.sections_.size());
    memory.take<S>(paths.modes_);
    memory.take<double>(paths.modes_);
    return at;
  }
  Pass(const FramePaths& paths, std::byte* work, std::size_t offset) : paths_(paths), work_(work) {
    sweep::WorkLayout memory;
    links_ = sweep::at<LinkMotion<S>>(work + offset, memory.take<LinkMotion<S>>(paths.links_.size()));
    sections_ = sweep::at<SectionMotion<S>>(work + offset, memory.take<SectionMotion<S>>(paths.sections_.size()));
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
      LinkMotion<S>& m = links_[l];
      if constexpr (std::is_same_v<S, double>) move(link, positions, speeds, hinge);
      M3<S> R_F = link.F.pose.R.template cast<S>();
      Vector3 p = link.F.pose.p, w = Vector3::Zero(), v = Vector3::Zero();
      m.arm_F.setZero();
      if (!link.at_world) {
        const LinkMotion<S>& parent = links_[link.F.link];
        const SectionMotion<S>& section = sections_[link.F.section];
        R_F = parent.R_B * (section.R * R_F);
        m.arm_F = parent.R_B * (section.r + section.R * link.F.pose.p.template cast<S>());
        if constexpr (std::is_same_v<S, double>) carry(parent, section, link.F.pose, m.arm_F, p, w, v);
      }
      m.R_M = R_F * hinge.R.template cast<S>();
      m.arm_h = R_F * hinge.p.template cast<S>();
      const SectionMotion<S>& root = sections_[link.M.section];
      m.R_B = m.R_M * (root.R * link.M.pose.R.template cast<S>()).transpose();
      const V3<S> offset = root.R * link.M.pose.p.template cast<S>();
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
    const LinkMotion<S>& link = links_[at.link];
    const SectionMotion<S>& section = sections_[at.section];
    FrameMotion f;
    f.R = link.R_B * section.R * at.pose.R;
    carry(link, section, at.pose, link.R_B * (section.r + section.R * at.pose.p), f.position, f.angular_velocity,
          f.velocity);
    return f;
  }

  void inward(std::span<const Wrench> wrenches, std::span<double> efforts) {
    for (std::size_t l = 0; l < paths_.links_.size(); ++l) {
      links_[l].force.setZero();
      links_[l].moment.setZero();
    }
    for (std::size_t i = 0; i < wrenches.size(); ++i)
      attach(paths_.frames_[i], wrenches[i].force.template cast<S>(), wrenches[i].moment.template cast<S>(), efforts);
    for (std::size_t l = paths_.links_.size(); l-- > 0;) {
      const Link& link = paths_.links_[l];
      const LinkMotion<S>& m = links_[l];
      const HingeStep& hinge = hinges_[l];
      const V3<S> force = m.force;
      // The frame follows M: what its own modes move there, they move the frame the other way.
      const V3<S> moment = m.moment - m.arm_M.cross(force);
      const V3<S> in_body = m.R_B.transpose() * force;
      const V3<S> offset = sections_[link.M.section].R * link.M.pose.p.template cast<S>();
      const V3<S> about_section = m.R_B.transpose() * moment + offset.cross(in_body);
      add_modal(link, link.M.section, in_body, about_section, -1, efforts);
      const V3<S> f = m.R_M.transpose() * force, t = m.R_M.transpose() * moment;
      for (std::size_t j = 0; j < link.slot.speeds; ++j) {
        const auto k = static_cast<Eigen::Index>(j);
        const V3<S> turn = hinge.angular.col(k).template cast<S>(), slide = hinge.linear.col(k).template cast<S>();
        efforts[link.slot.speed + j] += total(S(turn.dot(t) + slide.dot(f)));
      }
      if (!link.at_world) attach(link.F, force, moment + m.arm_h.cross(force), efforts);
    }
  }

 private:
  /// q, q̇ as far as the truncation keeps them, and the sections' motion.
  void deform(const Link& link, std::span<const double> positions, std::span<const double> speeds) {
    S* q = q_ + link.mode;
    double* q_dot = q_dot_ + link.mode;
    const double kept = link.truncation == Truncation::ruthless ? 0.0 : 1.0;
    for (Eigen::Index i = 0; i < link.modes; ++i) {
      const double value = kept * positions[link.modal.position + static_cast<std::size_t>(i)];
      if constexpr (std::is_same_v<S, double>) {
        q[i] = value;
      } else {
        q[i] = dual(0, value);
      }
      q_dot[i] = kept * speeds[link.modal.speed + static_cast<std::size_t>(i)];
    }
    if constexpr (std::is_same_v<S, double>) {
      if (link.rod != nullptr) {
        const auto& rod = link.rod->kinematics;
        const int n = static_cast<int>(link.modes);
        const sweep::RodWork memory = sweep::rod_work_at(rod, n, sweep::at<Pack>(work_, link.rod->work));
        sweep::rod_motion<any_count>(rod, n, q, q_dot, memory);
        for (const std::size_t s : link.sections) {
          const Section& section = paths_.sections_[s];
          sweep::StationMotion<Spatial> motion;
          sweep::rod_station_motion<any_count>(rod, section.station, memory, n, q, q_dot, motion,
                                               partials_ + section.partials);
          SectionMotion<S>& out = sections_[s];
          for (int c = 0; c < 3; ++c) out.R.col(c) = vector(motion.frame.R.c[c]);
          out.r = vector(motion.frame.p);
          out.r_rate = out.R * vector(motion.rate.v);
          out.w_rate = out.R * vector(motion.rate.w);
        }
        return;
      }
    }
    for (const std::size_t s : link.sections) expand(link, paths_.sections_[s], q, q_dot, sections_[s]);
  }

  /// Theory (1), (2).
  void expand(const Link& link, const Section& section, const S* q, const double* q_dot, SectionMotion<S>& out) {
    out.r = section.at.X.template cast<S>();
    out.R.setIdentity();
    out.left.setIdentity();
    out.r_rate.setZero();
    out.w_rate.setZero();
    if (!section.moves) return;
    V3<S> theta = V3<S>::Zero();
    Vector3 theta_rate = Vector3::Zero();
    for (Eigen::Index i = 0; i < link.modes; ++i) {
      V3<S> P = section.at.phi.col(i).template cast<S>(), T = section.at.psi.col(i).template cast<S>();
      const V3<S> P_0 = P, T_0 = T;
      if (link.order != StrainOrder::linear) {
        for (Eigen::Index j = 0; j < link.modes; ++j) {
          P += component(section.at.gamma, i, j).template cast<S>() * q[j];
          T += component(section.at.theta, i, j).template cast<S>() * q[j];
        }
      }
      out.r += (P_0 + P) * S(S(0.5) * q[i]);
      theta += (T_0 + T) * S(S(0.5) * q[i]);
      if constexpr (std::is_same_v<S, double>) {
        out.r_rate += P * q_dot[i];
        theta_rate += T * q_dot[i];
      }
    }
    const detail::ExponentialCoefficients<S> k(S(theta.squaredNorm()));
    const M3<S> t = skew<S>(theta);
    const M3<S> tt = t * t;
    out.left += t * k.b + tt * k.c;
    out.R += t * k.a + tt * k.b;
    if constexpr (std::is_same_v<S, double>) out.w_rate = out.left * theta_rate;
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
    step.w.setZero();
    step.v.setZero();
    for (Eigen::Index j = 0; j < n; ++j) {
      step.w += step.angular.col(j) * rates[static_cast<std::size_t>(j)];
      step.v += step.linear.col(j) * rates[static_cast<std::size_t>(j)];
    }
  }

  /// Position and velocities of a frame at `pose` in a section, `arm` from the link's frame to it.
  static void carry(const LinkMotion<double>& link, const SectionMotion<double>& section, const Pose& pose,
                    const Vector3& arm, Vector3& p, Vector3& w, Vector3& v) {
    p = link.p + arm;
    w = link.w + link.R_B * section.w_rate;
    v = link.v + link.w.cross(arm) + link.R_B * (section.r_rate + section.w_rate.cross(section.R * pose.p));
  }

  /// A wrench about the origin of a frame at `at`, on the link's modes and its frame.
  void attach(const Place& at, const V3<S>& force, const V3<S>& moment, std::span<double> efforts) {
    LinkMotion<S>& m = links_[at.link];
    const SectionMotion<S>& section = sections_[at.section];
    const V3<S> in_body = m.R_B.transpose() * force;
    const V3<S> offset = section.R * at.pose.p.template cast<S>();
    const V3<S> about_section = m.R_B.transpose() * moment + offset.cross(in_body);
    add_modal(paths_.links_[at.link], at.section, in_body, about_section, 1, efforts);
    m.force += force;
    m.moment += m.R_B * (about_section + section.r.cross(in_body));
  }

  /// Efforts sign·(P_iᵀ f + W_iᵀ m) of a wrench at a section, body axes.
  void add_modal(const Link& link, std::size_t index, const V3<S>& force, const V3<S>& moment, double sign,
                 std::span<double> efforts) {
    const Section& section = paths_.sections_[index];
    if (!section.moves) return;
    const SectionMotion<S>& motion = sections_[index];
    double* e = efforts.data() + link.modal.speed;
    if constexpr (std::is_same_v<S, double>) {
      if (link.rod != nullptr) {
        const Vector3 f = motion.R.transpose() * force, t = motion.R.transpose() * moment;
        const Spatial::Twist* J = partials_ + section.partials;
        for (Eigen::Index i = 0; i < link.modes; ++i) e[i] += sign * (vector(J[i].w).dot(t) + vector(J[i].v).dot(f));
        return;
      }
    }
    const V3<S> turning = motion.left.transpose() * moment;
    const S* q = q_ + link.mode;
    const auto along = [&](const Vector3& P, const Vector3& T) {
      return S(P.template cast<S>().dot(force) + T.template cast<S>().dot(turning));
    };
    for (Eigen::Index i = 0; i < link.modes; ++i) {
      S effort = along(section.at.phi.col(i), section.at.psi.col(i));
      if (link.order != StrainOrder::linear) {
        for (Eigen::Index j = 0; j < link.modes; ++j)
          effort += along(component(section.at.gamma, i, j), component(section.at.theta, i, j)) * q[j];
      }
      e[i] += sign * total(effort);
    }
  }

  const FramePaths& paths_;
  std::byte* work_;
  LinkMotion<S>* links_;
  SectionMotion<S>* sections_;
  S* q_;
  double* q_dot_;
  HingeStep* hinges_;
  Spatial::Twist* partials_;
};

FramePaths::FramePaths(const Model& model, Terms terms, const std::vector<FrameIndex>& frames)
    : link_of_(model.bodies().size(), -1) {
  for (const FrameIndex& f : frames) frames_.push_back(place(model, terms, f, Pose{}));
  sweep::WorkLayout memory;
  hinge_offset_ = memory.take<HingeStep>(links_.size());
  for (Link& link : links_) {
    strict_ = strict_ || (link.modes > 0 && link.truncation == Truncation::strict);
    if (link.order != StrainOrder::exact || link.truncation != Truncation::none || link.modes == 0) continue;
    // The rod wants its sections as stations of a node.
    NodeSpec node;
    node.modes = static_cast<std::size_t>(link.modes);
    node.rod = model.bodies()[static_cast<std::size_t>(link.hinge->child)].body->rod();
    for (const std::size_t s : link.sections) {
      sections_[s].station = node.stations.size();
      sections_[s].partials = partials_;
      partials_ += node.modes;
      node.stations.push_back({sections_[s].at, {}});
    }
    auto rod = std::make_shared<Rod>();
    rod->kinematics = sweep::RodKinematics<Spatial>(node);
    rod->work = memory.take<Pack>(sweep::rod_work(rod->kinematics, static_cast<int>(link.modes)));
    link.rod = std::move(rod);
  }
  partials_offset_ = memory.take<Spatial::Twist>(partials_);
  full_offset_ = Pass<double>::take(*this, memory);
  if (strict_) first_order_offset_ = Pass<Dual>::take(*this, memory);
  work_size_ = memory.size();
}

FramePaths::~FramePaths() = default;

void FramePaths::motions(std::span<const double> positions, std::span<const double> speeds,
                         std::span<FrameMotion> motions, std::byte* work) const noexcept {
  Pass<double> full(*this, work, full_offset_);
  full.outward(positions, speeds);
  for (std::size_t i = 0; i < frames_.size(); ++i) motions[i] = full.frame(frames_[i]);
  if (strict_) Pass<Dual>(*this, work, first_order_offset_).outward(positions, speeds);
}

void FramePaths::add_efforts(std::span<const Wrench> wrenches, std::span<double> efforts,
                             std::byte* work) const noexcept {
  if (strict_) {
    Pass<Dual>(*this, work, first_order_offset_).inward(wrenches, efforts);
  } else {
    Pass<double>(*this, work, full_offset_).inward(wrenches, efforts);
  }
}

std::size_t FramePaths::link(const Model& model, Terms terms, int body) {
  // Iterative, outermost body first: chains may be long.
  std::vector<int> missing;
  for (int b = body; b >= 0 && link_of_[static_cast<std::size_t>(b)] < 0;
       b = model.hinges()[static_cast<std::size_t>(b)].parent)
    missing.push_back(b);
  for (const int b : std::vector<int>(missing.rbegin(), missing.rend())) {
    const auto index = static_cast<std::size_t>(b);
    const BodyNode& node = model.bodies()[index];
    const HingeNode& hinge = model.hinges()[index];
    const Terms own = node.terms.value_or(terms);
    Link l{.hinge = &hinge,
           .slot = model.layout().hinges[index],
           .at_world = hinge.parent < 0,
           .F = {0, 0, hinge.offset},
           .M = {},
           .modes = node.body->shape().modes(),
           .modal = {},
           .mode = modes_,
           .order = own.strain,
           .truncation = own.truncation,
           .sections = {},
           .rod = nullptr};
    if (l.modes > 0) l.modal = *model.layout().body(node.name);
    modes_ += static_cast<std::size_t>(l.modes);
    if (!l.at_world) l.F = place(model, terms, {hinge.parent, hinge.parent_frame}, hinge.offset);
    link_of_[index] = static_cast<int>(links_.size());
    links_.push_back(std::move(l));
    links_.back().M = place(model, terms, {b, hinge.child_frame}, Pose{});
  }
  return static_cast<std::size_t>(link_of_[static_cast<std::size_t>(body)]);
}

FramePaths::Place FramePaths::place(const Model& model, Terms terms, FrameIndex frame, const Pose& offset) {
  const std::size_t l = link(model, terms, frame.body);
  const Frame& f = model.bodies()[static_cast<std::size_t>(frame.body)].frames[static_cast<std::size_t>(frame.frame)];
  const Pose pose = f.pose * offset;
  const auto same = [&](const PointExpansion& e) {
    bool equal = e.X == f.section.X && e.phi == f.section.phi && e.psi == f.section.psi;
    for (std::size_t c = 0; c < 3; ++c)
      equal = equal && e.gamma[c] == f.section.gamma[c] && e.theta[c] == f.section.theta[c];
    return equal;
  };
  for (const std::size_t s : links_[l].sections) {
    if (same(sections_[s].at)) return {l, s, pose};
  }
  bool moves = !f.section.phi.isZero(0) || !f.section.psi.isZero(0);
  for (std::size_t c = 0; c < 3; ++c) moves = moves || !f.section.gamma[c].isZero(0) || !f.section.theta[c].isZero(0);
  links_[l].sections.push_back(sections_.size());
  sections_.push_back({f.section, moves, 0, 0});
  return {l, sections_.size() - 1, pose};
}

}  // namespace withy
