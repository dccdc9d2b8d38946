#include "withy/core/simulation/tree_motion.hpp"

namespace withy {
namespace {

using Vector = Eigen::Map<const Eigen::VectorXd>;

Matrix3 exponential(const Vector3& theta) {
  const double angle = theta.norm();
  if (angle < 1e-12) return Matrix3::Identity() + skew<double>(theta);
  return Eigen::AngleAxisd(angle, theta / angle).toRotationMatrix();
}

/// Motion of a frame on a body that moves, m relative to it.
template <class Relative>
BodyMotion outward(const BodyMotion& B, const Relative& m) {
  BodyMotion F;
  const Vector3 arm = B.R * m.r, rate = B.R * m.r_rate, spin = B.R * m.w;
  F.R = B.R * m.R;
  F.p = B.p + arm;
  F.rate = B.rate + spin;
  F.spin_up = B.spin_up + B.rate.cross(spin) + B.R * m.w_dot;
  F.acceleration = B.acceleration + B.spin_up.cross(arm) + B.rate.cross(B.rate.cross(arm)) + 2 * B.rate.cross(rate) +
                   B.R * m.r_second;
  return F;
}

/// Of the hinge's other frame. \param local, second its velocities and accelerations relative to F, in its own axes
BodyMotion across(const BodyMotion& F, const HingeMotion& h, const Vector6& local, const Vector6& second) {
  BodyMotion M;
  M.R = F.R * h.pose.R;
  const Vector3 arm = F.R * h.pose.p;
  const Vector3 w = M.R * local.head<3>(), v = M.R * local.tail<3>();
  M.p = F.p + arm;
  M.rate = F.rate + w;
  M.spin_up = F.spin_up + F.rate.cross(w) + M.R * second.head<3>();
  M.acceleration = F.acceleration + F.spin_up.cross(arm) + F.rate.cross(F.rate.cross(arm)) + 2 * F.rate.cross(v) +
                   M.R * second.tail<3>() + w.cross(v);
  return M;
}

/// Of the body that frame M is on, m relative to it: the inverse of `outward`.
template <class Relative>
void inward(const BodyMotion& M, const Relative& m, BodyMotion& B) {
  B.R = M.R * m.R.transpose();
  const Vector3 arm = B.R * m.r, rate = B.R * m.r_rate, spin = B.R * m.w;
  B.p = M.p - arm;
  B.rate = M.rate - spin;
  B.spin_up = M.spin_up - B.rate.cross(spin) - B.R * m.w_dot;
  B.acceleration = M.acceleration - B.spin_up.cross(arm) - B.rate.cross(B.rate.cross(arm)) - 2 * B.rate.cross(rate) -
                   B.R * m.r_second;
}

}  // namespace

TreeMotion::TreeMotion(const Model& model) : model_(model), bodies_(model.bodies().size()) {
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const ModalShape& shape = model.bodies()[b].body->shape();
    Mass mass;
    mass.modal = Matrix3X::Zero(3, shape.modes());
    for (const Particle& particle : shape.particles) {
      mass.mass += particle.mass;
      mass.moment += particle.mass * particle.at.X;
      mass.modal += particle.mass * particle.at.phi;
    }
    masses_.push_back(std::move(mass));
    slots_.push_back(model.layout().modes(b));
    hinges_.emplace_back();
    hinges_.back().H.resize(6, static_cast<Eigen::Index>(model.layout().hinges[b].speeds));
  }
}

TreeMotion::Relative TreeMotion::frame(std::size_t body, int index, const Pose& offset) const {
  const Frame& f = model_.bodies()[body].frames[static_cast<std::size_t>(index)];
  Relative m;
  m.r = f.section.X;
  m.r_rate = m.r_second = m.w = m.w_dot = Vector3::Zero();
  if (const Slot* slot = slots_[body]; slot != nullptr) {
    const auto n = static_cast<Eigen::Index>(slot->speeds);
    const Vector q(y_.data() + slot->position, n), rate(y_.data() + model_.layout().positions + slot->speed, n),
        second(u_dot_.data() + slot->speed, n);
    m.r += f.section.phi * q;
    m.r_rate = f.section.phi * rate;
    m.r_second = f.section.phi * second;
    m.R = exponential(f.section.psi * q);
    m.w = f.section.psi * rate;
    m.w_dot = f.section.psi * second;
  }
  const Vector3 arm = m.R * (f.pose.p + f.pose.R * offset.p);
  m.r += arm;
  m.r_rate += m.w.cross(arm);
  m.r_second += m.w_dot.cross(arm);
  m.R = m.R * f.pose.R * offset.R;
  return m;
}

// The formulas are those of outward, across and inward in core/reference/reference.cpp, with u̇ in the accelerations.
void TreeMotion::update(std::span<const double> y, std::span<const double> u_dot) {
  y_ = y;
  u_dot_ = u_dot;
  const Layout& layout = model_.layout();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const HingeNode& hinge = model_.hinges()[b];
    BodyMotion F;
    F.acceleration = -model_.gravity();
    if (hinge.parent < 0) {
      F.R = hinge.offset.R;
      F.p = hinge.offset.p;
    } else {
      const BodyMotion& B = bodies_[static_cast<std::size_t>(hinge.parent)];
      const Relative m = frame(static_cast<std::size_t>(hinge.parent), hinge.parent_frame, hinge.offset);
      F = outward(B, m);
    }
    const Slot& slot = layout.hinges[b];
    const auto rates = y.subspan(layout.positions + slot.speed, slot.speeds);
    HingeMotion& h = hinges_[b];
    hinge.hinge->motion(y.subspan(slot.position, slot.positions), rates, h);
    const auto n = static_cast<Eigen::Index>(slot.speeds);
    Vector6 local = Vector6::Zero(), second = h.bias;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      local += h.H.col(i) * rates[k];
      second += h.H.col(i) * u_dot[slot.speed + k];
    }
    const BodyMotion M = across(F, h, local, second);
    const Relative m = frame(b, hinge.child_frame, Pose{});
    BodyMotion& B = bodies_[b];
    inward(M, m, B);
    const Mass& mass = masses_[b];
    const Vector3 moment = B.R * mass.moment;
    B.mass = mass.mass;
    B.mass_moment = mass.mass * B.p + moment;
    B.force = mass.mass * B.acceleration + B.spin_up.cross(moment) + B.rate.cross(B.rate.cross(moment));
    if (const Slot* modes = slots_[b]; modes != nullptr) {
      for (std::size_t i = 0; i < modes->speeds; ++i)
        B.force += B.R * mass.modal.col(static_cast<Eigen::Index>(i)) * u_dot[modes->speed + i];
    }
  }
  for (std::size_t b = bodies_.size(); b-- > 0;) {
    const int parent = model_.hinges()[b].parent;
    if (parent < 0) continue;
    BodyMotion& P = bodies_[static_cast<std::size_t>(parent)];
    P.mass += bodies_[b].mass;
    P.mass_moment += bodies_[b].mass_moment;
    P.force += bodies_[b].force;
  }
}

}  // namespace withy
