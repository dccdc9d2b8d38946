#include "withy/core/dynamics/rigid_inverse_dynamics.hpp"

namespace withy {
namespace {

/// What the outward pass leaves for the inward pass, in the caller's scratch space.
struct LinkScratch {
  LinkScratch(double* at, std::size_t speeds)
      : R(at), p(at + 9), V(at + 12), A(at + 18), F(at + 24), H(at + 30, 6, static_cast<Eigen::Index>(speeds)) {}
  static std::size_t size(std::size_t speeds) { return 30 + 6 * speeds; }
  Eigen::Map<Matrix3> R;         ///< R_PM
  Eigen::Map<Vector3> p;         ///< origin of M in P
  Eigen::Map<Spatial::Twist> V;  ///< velocity
  Eigen::Map<Spatial::Twist> A;  ///< acceleration less gravity
  Eigen::Map<Spatial::Twist> F;  ///< wrench that the hinge transmits
  Eigen::Map<Eigen::Matrix<double, 6, Eigen::Dynamic>> H;
};

using Rates = Eigen::Map<const Eigen::VectorXd>;

/// Pose of a frame in its body, undeformed: the section there has the body's axes.
Pose in_body(const Frame& frame) { return {frame.pose.R, frame.section.X + frame.pose.p}; }

/// Inertia of a point mass at r.
Spatial::Matrix point_inertia(double mass, const Vector3& r) {
  const Matrix3 c = skew<double>(r);
  Spatial::Matrix m;
  m << -mass * c * c, mass * c, -mass * c, mass * Matrix3::Identity();
  return m;
}

}  // namespace

RigidInverseDynamics::RigidInverseDynamics(const Model& model) : gravity_(model.gravity()) {
  struct Carried {
    int link;   ///< that carries the body; −1: world
    Pose X_LB;  ///< the body in that link's M
  };
  std::vector<Carried> carried;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodyNode& body = model.bodies()[b];
    const HingeNode& node = model.hinges()[b];
    int link = -1;
    Pose X_LF = node.offset;
    if (node.parent >= 0) {
      const auto parent = static_cast<std::size_t>(node.parent);
      link = carried[parent].link;
      const Frame& frame = model.bodies()[parent].frames[static_cast<std::size_t>(node.parent_frame)];
      X_LF = carried[parent].X_LB * in_body(frame) * node.offset;
    }
    const Pose X_MB = in_body(body.frames[static_cast<std::size_t>(node.child_frame)]).inverse();
    Pose X_LB = X_MB;
    if (node.hinge->speeds() == 0) {
      std::vector<double> x(node.hinge->coordinates());
      node.hinge->reference(x);
      HingeMotion motion;
      node.hinge->motion(x, {}, motion);
      X_LB = X_LF * motion.pose * X_MB;
    } else {
      links_.push_back({.hinge = node.hinge, .slot = model.layout().hinges[b], .parent = link, .X_PF = X_LF});
      links_.back().scratch = scratch_;
      link = static_cast<int>(links_.size()) - 1;
      scratch_ += LinkScratch::size(node.hinge->speeds());
    }
    carried.push_back({link, X_LB});
    if (link < 0) continue;
    Link& l = links_[static_cast<std::size_t>(link)];
    for (const Particle& particle : body.body->shape().particles)
      l.inertia += point_inertia(particle.mass, X_LB.R * particle.at.X + X_LB.p);
    for (const Section& section : body.body->shape().sections)
      l.inertia.topLeftCorner<3, 3>() += X_LB.R * section.inertia * X_LB.R.transpose();
  }
}

// Outward, for each link, parents first:  X_PM = X_PF X_FM(x),   V = X_MP V_P + H ẋ,
//   A = X_MP A_P + H ẍ + Ḣ ẋ + V × (H ẋ),   A_world = −g,   F = I A + V ×* (I V).
// Inward, children first:  τ = Hᵀ F,   F_P += X_PM* F.
void RigidInverseDynamics::efforts(std::span<const double> x, std::span<const double> u, std::span<const double> u_dot,
                                   std::span<double> efforts, std::span<double> scratch) const noexcept {
  HingeMotion motion;
  for (const Link& link : links_) {
    const auto speeds = static_cast<Eigen::Index>(link.slot.speeds);
    const std::span<const double> rates = u.subspan(link.slot.speed, link.slot.speeds);
    link.hinge->motion(x.subspan(link.slot.position, link.slot.positions), rates, motion);
    const Pose X_PM = link.X_PF * motion.pose;
    LinkScratch s(scratch.data() + link.scratch, link.slot.speeds);
    s.R = X_PM.R;
    s.p = X_PM.p;
    s.H = motion.H;
    const Spatial::Twist J = motion.H.lazyProduct(Rates(rates.data(), speeds));
    s.V = J;
    s.A << Vector3::Zero(), -X_PM.R.transpose() * gravity_;
    if (link.parent >= 0) {
      const Link& p = links_[static_cast<std::size_t>(link.parent)];
      const LinkScratch parent(scratch.data() + p.scratch, p.slot.speeds);
      const Spatial::Frame X = Spatial::make(X_PM);
      s.V += Spatial::to_child(X, parent.V);
      s.A = Spatial::to_child(X, parent.A);
    }
    s.A += motion.bias + motion.H.lazyProduct(Rates(u_dot.data() + link.slot.speed, speeds)) + Spatial::cross(s.V, J);
    s.F = link.inertia * s.A + Spatial::cross_force(s.V, link.inertia * s.V);
  }
  for (auto link = links_.rbegin(); link != links_.rend(); ++link) {
    const LinkScratch s(scratch.data() + link->scratch, link->slot.speeds);
    Eigen::Map<Eigen::VectorXd>(efforts.data() + link->slot.speed, s.H.cols()) = s.H.transpose().lazyProduct(s.F);
    if (link->parent < 0) continue;
    const Link& p = links_[static_cast<std::size_t>(link->parent)];
    const Spatial::Twist F = s.F;
    LinkScratch(scratch.data() + p.scratch, p.slot.speeds).F += Spatial::to_parent(Spatial::Frame{s.R, s.p}, F);
  }
}

}  // namespace withy
