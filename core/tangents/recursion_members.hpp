/// \file
/// Members of Recursion, for the files that instantiate it.
#pragma once

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/tangents/plain_bodies.hpp"
#include "withy/core/tangents/recursion.hpp"

namespace withy::analysis {

template <class S>
Recursion<S>::Recursion(const Model& model, std::vector<HingeState<S>> hinges, std::vector<BodyState<S>> bodies,
                        std::shared_ptr<PlainBodies<Plain>> known)
    : model_(model), hinges_(std::move(hinges)), states_(std::move(bodies)), known_(std::move(known)) {
  if constexpr (has_plain) {
    if (known_ == nullptr) known_ = std::make_shared<PlainBodies<Plain>>();
    known_->resize(model.bodies().size());
  }
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const HingeNode& h = model.hinges()[b];
    const BodyState<S>& state = states_[b];
    rods_.emplace_back();
    plain_q_.emplace_back();
    plain_q_dot_.emplace_back();
    if constexpr (has_plain) {
      if (state.plain) {
        plain_q_.back() = state.q.unaryExpr([](const S& x) { return plain(x); });
        plain_q_dot_.back() = state.q_dot.unaryExpr([](const S& x) { return plain(x); });
      }
    }
    // A rod in a scalar that carries a truncation has been refused by the formulation.
    if constexpr (!truncating) {
      if (state.rod != nullptr) {
        if constexpr (has_plain) {
          if (state.plain && !(*known_)[b].rod)
            (*known_)[b].rod.emplace(*state.rod, plain_q_.back(), plain_q_dot_.back());
        }
        if (!state.plain) rods_.back().emplace(*state.rod, state.q, state.q_dot);
      }
    }
    Frame F;
    parent_.emplace_back();
    if (h.parent < 0) {
      F.R = h.offset.R.cast<S>();
      F.p = h.offset.p.cast<S>();
    } else {
      parent_.back() = relative(h.parent, h.parent_frame, h.offset);
      const auto p = static_cast<std::size_t>(h.parent);
      F = outward(frames_[p], parent_.back(), states_[p].q_ddot);
    }
    hinge_frames_.push_back(across(F, hinges_[b]));
    child_.push_back(relative(static_cast<int>(b), h.child_frame, Pose{}));
    frames_.push_back(inward(hinge_frames_[b], child_[b], state.q_ddot));
  }
}

template <class S>
Recursion<S>::~Recursion() = default;

template <class S>
typename Recursion<S>::VX Recursion<S>::efforts(const std::vector<AppliedWrench<S>>& wrenches) const {
  const Layout& layout = model_.layout();
  VX result = VX::Zero(static_cast<Eigen::Index>(layout.speeds));
  std::vector<Load> loads(frames_.size());
  for (std::size_t b = 0; b < frames_.size(); ++b) loads[b] = own_load(b);
  for (const AppliedWrench<S>& w : wrenches) {
    const auto b = static_cast<std::size_t>(w.at.body);
    const M3& R = frames_[b].R;
    const PointMotionOf<S> m = relative(w.at.body, w.at.frame, Pose{});
    loads[b].force -= w.force;
    loads[b].moment -= w.moment + V3(R * m.r).cross(w.force);
    loads[b].modes -= m.P.transpose() * V3(R.transpose() * w.force) + m.W.transpose() * V3(R.transpose() * w.moment);
  }
  for (std::size_t b = frames_.size(); b-- > 0;) {
    const HingeNode& h = model_.hinges()[b];
    const Frame& B = frames_[b];
    const Frame& M = hinge_frames_[b];
    Load& load = loads[b];
    const V3 f = load.force;
    const V3 n = load.moment - V3(M.p - B.p).cross(f);  // about M
    load.modes -= child_[b].P.transpose() * V3(B.R.transpose() * f) + child_[b].W.transpose() * V3(B.R.transpose() * n);
    if (load.modes.size() > 0) {
      const Slot& slot = *layout.modes(b);
      result.segment(static_cast<Eigen::Index>(slot.speed), load.modes.size()) = load.modes;
    }
    Eigen::Matrix<S, 6, 1> wrench;
    wrench << M.R.transpose() * n, M.R.transpose() * f;
    const Slot& slot = layout.hinges[b];
    result.segment(static_cast<Eigen::Index>(slot.speed), static_cast<Eigen::Index>(slot.speeds)) =
        hinges_[b].H.transpose() * wrench;
    if (h.parent < 0) continue;
    const auto p = static_cast<std::size_t>(h.parent);
    const Frame& P = frames_[p];
    const V3 arm = P.R * parent_[b].r;
    const V3 moment = n + V3(M.p - P.p - arm).cross(f);  // about F, which is fixed to the parent's section
    loads[p].force += f;
    loads[p].moment += moment + arm.cross(f);
    loads[p].modes +=
        parent_[b].P.transpose() * V3(P.R.transpose() * f) + parent_[b].W.transpose() * V3(P.R.transpose() * moment);
  }
  return result;
}

template <class S>
FrameState<S> Recursion<S>::frame_state(FrameIndex at) const {
  const auto b = static_cast<std::size_t>(at.body);
  const Frame A = outward(frames_[b], relative(at.body, at.frame, Pose{}), states_[b].q_ddot);
  return {A.R, A.p, A.w, A.v};
}

template <class S>
std::pair<typename Recursion<S>::V3, typename Recursion<S>::V3> Recursion<S>::frame_position(int body,
                                                                                             int frame) const {
  const auto b = static_cast<std::size_t>(body);
  const PointMotionOf<S> m = relative(body, frame, Pose{});
  const PointExpansion& e = model_.bodies()[b].frames[static_cast<std::size_t>(frame)].section;
  return {frames_[b].p + frames_[b].R * m.r, section(b, e).r - e.X.cast<S>()};
}

template <class S>
typename Recursion<S>::Frame Recursion<S>::outward(const Frame& B, const PointMotionOf<S>& m, const VX& q_ddot) {
  if (m.P.cols() == 0) return carried(B, m.R, B.R * m.r);
  Frame A;
  const V3 arm = B.R * m.r, rate = B.R * m.r_rate, spin = B.R * m.w_rate;
  A.R = B.R * m.R;
  A.p = B.p + arm;
  A.w = B.w + spin;
  A.v = B.v + B.w.cross(arm) + rate;
  A.alpha = B.alpha + B.w.cross(spin) + B.R * V3(m.w_bias + m.W * q_ddot);
  A.a = B.a + B.alpha.cross(arm) + B.w.cross(V3(B.w.cross(arm))) + S(2) * B.w.cross(rate) +
        B.R * V3(m.r_bias + m.P * q_ddot);
  return A;
}

template <class S>
typename Recursion<S>::Frame Recursion<S>::carried(const Frame& B, const M3& R, const V3& arm) {
  Frame A = B;
  if (R != M3::Identity()) A.R = B.R * R;
  if (arm == V3::Zero()) return A;
  A.p = B.p + arm;
  A.v = B.v + B.w.cross(arm);
  A.a = B.a + B.alpha.cross(arm) + B.w.cross(V3(B.w.cross(arm)));
  return A;
}

template <class S>
typename Recursion<S>::Frame Recursion<S>::inward(const Frame& M, const PointMotionOf<S>& m, const VX& q_ddot) {
  if (m.P.cols() == 0) {
    const M3 R = m.R.transpose();
    return carried(M, R, M.R * V3(R * V3(-m.r)));
  }
  Frame B;
  B.R = M.R * m.R.transpose();
  const V3 arm = B.R * m.r, rate = B.R * m.r_rate, spin = B.R * m.w_rate;
  B.p = M.p - arm;
  B.w = M.w - spin;
  B.v = M.v - B.w.cross(arm) - rate;
  B.alpha = M.alpha - B.w.cross(spin) - B.R * V3(m.w_bias + m.W * q_ddot);
  B.a = M.a - B.alpha.cross(arm) - B.w.cross(V3(B.w.cross(arm))) - S(2) * B.w.cross(rate) -
        B.R * V3(m.r_bias + m.P * q_ddot);
  return B;
}

template <class S>
typename Recursion<S>::Frame Recursion<S>::across(const Frame& F, const HingeState<S>& h) {
  Frame M;
  const V3 arm = F.R * h.p;
  M.R = F.R * h.R;
  M.p = F.p + arm;
  const Eigen::Matrix<S, 6, 1> local = h.H * h.rates;
  const Eigen::Matrix<S, 6, 1> change = h.H * h.accelerations + h.bias;
  const V3 w = M.R * V3(local.template head<3>()), v = M.R * V3(local.template tail<3>());
  M.w = F.w + w;
  M.v = F.v + F.w.cross(arm) + v;
  M.alpha = F.alpha + F.w.cross(w) + M.R * V3(change.template head<3>());
  M.a = F.a + F.alpha.cross(arm) + F.w.cross(V3(F.w.cross(arm))) + S(2) * F.w.cross(v) + w.cross(v) +
        M.R * V3(change.template tail<3>());
  return M;
}

template <class S>
PointMotionOf<S> Recursion<S>::section(std::size_t b, const PointExpansion& e) const {
  if constexpr (has_plain) {
    if constexpr (!truncating) {
      if (states_[b].plain && states_[b].rod != nullptr) return lifted<S>((*known_)[b].rod->at(e.X.x()));
    }
    if (states_[b].plain) return lifted<S>(point_motion<Plain>(e, states_[b].order, plain_q_[b], plain_q_dot_[b]));
  }
  if constexpr (!truncating) {
    if (rods_[b]) return rods_[b]->at(e.X.x());
  }
  return point_motion<S>(e, states_[b].order, states_[b].q, states_[b].q_dot);
}

template <class S>
PointMotionOf<S> Recursion<S>::relative(int body, int frame, const Pose& offset) const {
  const auto b = static_cast<std::size_t>(body);
  const FramePlace f = place_of(model_, {body, frame});
  return offset_motion<S>(section(b, f.section), f.pose * offset);
}

template <class S>
Turning<S> Recursion<S>::turning(std::size_t b) const {
  const Frame& B = frames_[b];
  const M3 to_body = B.R.transpose();
  Turning<S> t;
  t.w = to_body * B.w;
  t.alpha = to_body * B.alpha;
  t.a = to_body * V3(B.a - model_.gravity().template cast<S>());
  t.ww = t.w.lazyProduct(t.w.transpose());
  t.turn = skew<S>(t.alpha) + t.ww;
  const S square = t.w.squaredNorm();
  for (Eigen::Index i = 0; i < 3; ++i) t.turn(i, i) -= square;
  t.twice = S(2) * skew<S>(t.w);
  return t;
}

template <class S>
typename Recursion<S>::V3 Recursion<S>::force_on(const Turning<S>& t, const PointMotionOf<S>& m, double mass,
                                                 const VX& q_ddot) {
  return S(mass) * (t.a + t.turn * m.r + t.twice * m.r_rate + m.r_bias + m.P * q_ddot);
}

template <class S>
typename Recursion<S>::V3 Recursion<S>::moment_on(const Turning<S>& t, const PointMotionOf<S>& m,
                                                  const Matrix3& inertia, const VX& q_ddot) {
  const M3 I = m.R * inertia.cast<S>() * m.R.transpose();
  const V3 w = t.w + m.w_rate;
  return I * V3(t.alpha + t.w.cross(m.w_rate) + m.w_bias + m.W * q_ddot) + w.cross(V3(I * w));
}

/// Calls `particle` (motion, mass) and `section` (motion, inertia) for all that a body's mass is.
template <class S>
template <class OfParticle, class OfSection>
void Recursion<S>::for_mass(std::size_t b, OfParticle&& particle, OfSection&& section) const {
  const BodyState<S>& state = states_[b];
  if constexpr (!truncating) {
    if (state.rod != nullptr) {
      for (std::size_t k = 0; k < state.rod->sections.size(); ++k) {
        const Matrix3& inertia = state.rod->inertias[k];
        const PointMotionOf<S> m = rods_[b]->at_node(k);
        particle(m, state.rod->masses[k]);
        if (!inertia.isZero(0)) section(m, inertia);
      }
      return;
    }
  }
  const ModalShape& shape = model_.bodies()[b].body->shape();
  for (const Particle& p : shape.particles) particle(path_motion<S>(p.at, state.order, state.q, state.q_dot), p.mass);
  for (const Section& s : shape.sections) section(this->section(b, s.at), s.inertia);
}

template <class S>
const BodyIntegrals<typename Recursion<S>::Plain>& Recursion<S>::integrals(std::size_t b) const {
  std::optional<BodyIntegrals<Plain>>& found = (*known_)[b].integrals;
  if (found) return *found;
  const BodyState<S>& state = states_[b];
  const PlainVector &q = plain_q_[b], &q_dot = plain_q_dot_[b];
  BodyIntegrals<Plain>& sums = found.emplace(q.size());
  if constexpr (!truncating) {
    if (state.rod != nullptr) {
      for (std::size_t k = 0; k < state.rod->sections.size(); ++k) {
        const PointMotionOf<Plain> m = (*known_)[b].rod->at_node(k);
        sums.add_particle(m, state.rod->masses[k]);
        if (const Matrix3& inertia = state.rod->inertias[k]; !inertia.isZero(0)) sums.add_section(m, inertia);
      }
      return sums;
    }
  }
  const ModalShape& shape = model_.bodies()[b].body->shape();
  for (const Particle& p : shape.particles) sums.add_particle(path_motion<Plain>(p.at, state.order, q, q_dot), p.mass);
  for (const Section& s : shape.sections) sums.add_section(point_motion<Plain>(s.at, state.order, q, q_dot), s.inertia);
  return sums;
}

template <class S>
typename Recursion<S>::Load Recursion<S>::own_load(std::size_t b) const {
  const VX& q_ddot = states_[b].q_ddot;
  const Turning<S> t = turning(b);
  const auto in_world = [&](Load load) {
    load.force = (frames_[b].R * load.force).eval();
    load.moment = (frames_[b].R * load.moment).eval();
    return load;
  };
  if constexpr (has_plain) {
    if (states_[b].plain) return in_world(load_of<S>(integrals(b), t, q_ddot));
  }
  Load load;
  load.modes = VX::Zero(q_ddot.size());
  for_mass(
      b,
      [&](const PointMotionOf<S>& m, double mass) {
        const V3 f = force_on(t, m, mass, q_ddot);
        load.force += f;
        load.moment += m.r.cross(f);
        load.modes += m.P.transpose() * f;
      },
      [&](const PointMotionOf<S>& m, const Matrix3& inertia) {
        const V3 n = moment_on(t, m, inertia, q_ddot);
        load.moment += n;
        load.modes += m.W.transpose() * n;
      });
  return in_world(std::move(load));
}

}  // namespace withy::analysis
