/// \file
/// The tree of the dense reference at one state, in any scalar: world motions of all frames and points with their
/// explicit Jacobians.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/deformation/rod_motion.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy::reference {

template <class S>
using V3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using M3 = Eigen::Matrix<S, 3, 3>;
template <class S>
using M3X = Eigen::Matrix<S, 3, Eigen::Dynamic>;
template <class S>
using VX = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S>
using MX = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;

/// Motion of a frame in the world, world axes: pose, velocities, their Jacobians over all generalized speeds, and the
/// accelerations that remain with u̇ = 0.
template <class S>
struct WorldMotion {
  M3<S> R = M3<S>::Identity();
  V3<S> p = V3<S>::Zero(), w = V3<S>::Zero(), v = V3<S>::Zero(), w_bias = V3<S>::Zero(), v_bias = V3<S>::Zero();
  M3X<S> JW, JV;
};

/// Motion of the point or frame that moves as `m` relative to the body frame B.
template <class S>
WorldMotion<S> outward(const WorldMotion<S>& B, const PointMotionOf<S>& m, Eigen::Index first_mode) {
  WorldMotion<S> A;
  const V3<S> arm = B.R * m.r;
  const V3<S> rate = B.R * m.r_rate;
  const V3<S> spin = B.R * m.w_rate;
  A.R = B.R * m.R;
  A.p = B.p + arm;
  A.w = B.w + spin;
  A.v = B.v + B.w.cross(arm) + rate;
  A.w_bias = B.w_bias + B.w.cross(spin) + B.R * m.w_bias;
  A.v_bias = B.v_bias + B.w_bias.cross(arm) + B.w.cross(B.w.cross(arm)) + S(2) * B.w.cross(rate) + B.R * m.r_bias;
  A.JW = B.JW;
  A.JV = B.JV - skew<S>(arm) * B.JW;
  A.JW.middleCols(first_mode, m.P.cols()) += B.R * m.W;
  A.JV.middleCols(first_mode, m.P.cols()) += B.R * m.P;
  return A;
}

/// The body frame B whose frame M, moving as `m` in B, has the world motion `M`: the inverse of `outward`.
template <class S>
WorldMotion<S> inward(const WorldMotion<S>& M, const PointMotionOf<S>& m, Eigen::Index first_mode) {
  WorldMotion<S> B;
  B.R = M.R * m.R.transpose();
  const V3<S> arm = B.R * m.r;
  const V3<S> rate = B.R * m.r_rate;
  const V3<S> spin = B.R * m.w_rate;
  B.p = M.p - arm;
  B.w = M.w - spin;
  B.v = M.v - B.w.cross(arm) - rate;
  B.w_bias = M.w_bias - B.w.cross(spin) - B.R * m.w_bias;
  B.v_bias = M.v_bias - B.w_bias.cross(arm) - B.w.cross(B.w.cross(arm)) - S(2) * B.w.cross(rate) - B.R * m.r_bias;
  B.JW = M.JW;
  B.JW.middleCols(first_mode, m.P.cols()) -= B.R * m.W;
  B.JV = M.JV;
  B.JV.middleCols(first_mode, m.P.cols()) -= B.R * m.P;
  B.JV += skew<S>(arm) * B.JW;
  return B;
}

/// Hinge frame M from F. With V_FM = Hẋ in M axes at M's origin and A's bias Ḣẋ component-wise in M.
template <class S>
WorldMotion<S> across(const WorldMotion<S>& F, const HingeMotion& h, std::span<const double> rates,
                      Eigen::Index first) {
  WorldMotion<S> M;
  const V3<S> arm = F.R * h.pose.p.cast<S>();
  M.R = F.R * h.pose.R.cast<S>();
  M.p = F.p + arm;
  const Eigen::Map<const Eigen::VectorXd> u(rates.data(), static_cast<Eigen::Index>(rates.size()));
  const Vector6 local = h.H * u;  // ω_FM and the velocity of M's origin in F, in M axes
  const V3<S> w = M.R * local.head<3>().cast<S>();
  const V3<S> v = M.R * local.tail<3>().cast<S>();
  M.w = F.w + w;
  M.v = F.v + F.w.cross(arm) + v;
  // d/dt of (R_M local) seen from F is R_M (Ḣẋ + ω_FM × local).
  const V3<S> wb = M.R * V3<S>(h.bias.head<3>().cast<S>());
  const V3<S> vb = M.R * V3<S>(h.bias.tail<3>().cast<S>()) + w.cross(v);
  M.w_bias = F.w_bias + F.w.cross(w) + wb;
  M.v_bias = F.v_bias + F.w_bias.cross(arm) + F.w.cross(F.w.cross(arm)) + S(2) * F.w.cross(v) + vb;
  M.JW = F.JW;
  M.JV = F.JV - skew<S>(arm) * F.JW;
  const Eigen::Index n = h.H.cols();
  M.JW.middleCols(first, n) += M.R * h.H.topRows<3>().cast<S>();
  M.JV.middleCols(first, n) += M.R * h.H.bottomRows<3>().cast<S>();
  return M;
}

/// How one body's elastic coordinates enter: its strain order, and the factor of q and q̇ (a dual ε, 0 or 1); a rod of
/// exact kinematics.
template <class S>
struct BodyTerms {
  StrainOrder order;
  S scale;
  const RodTable* rod = nullptr;
};

/// Everything about the tree at one state.
template <class S>
class ReferenceTree {
 public:
  /// Every body's q and q̇ times its factor.
  ReferenceTree(const Model& model, const std::vector<BodyTerms<S>>& terms, std::span<const double> y)
      : ReferenceTree(model, terms, y, scaled(model, terms, y, 0), scaled(model, terms, y, model.layout().positions)) {}
  /// The elastic coordinates and their rates as given, one vector a body; hinges as in y.
  ReferenceTree(const Model& model, std::vector<BodyTerms<S>> terms, std::span<const double> y, std::vector<VX<S>> q,
                std::vector<VX<S>> q_dot)
      : model_(model), terms_(std::move(terms)), q_(std::move(q)), q_dot_(std::move(q_dot)) {
    const Layout& layout = model.layout();
    const auto speeds = static_cast<Eigen::Index>(layout.speeds);
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      const HingeNode& h = model.hinges()[b];
      const Slot& hinge = layout.hinges[b];
      const Slot* modal = q_[b].size() > 0 ? layout.modes(b) : nullptr;
      first_mode_.push_back(modal != nullptr ? static_cast<Eigen::Index>(modal->speed) : 0);
      rods_.emplace_back();
      if constexpr (std::is_same_v<S, double>) {
        if (terms_[b].rod != nullptr) rods_.back().emplace(*terms_[b].rod, q_[b], q_dot_[b]);
      }
      WorldMotion<S> F;
      if (h.parent < 0) {
        F.JW = F.JV = M3X<S>::Zero(3, speeds);
        F.R = h.offset.R.template cast<S>();
        F.p = h.offset.p.template cast<S>();
      } else {
        F = frame(h.parent, h.parent_frame, h.offset);
      }
      HingeMotion motion;
      motion.H.resize(6, static_cast<Eigen::Index>(hinge.speeds));
      const auto x = y.subspan(hinge.position, hinge.positions);
      const auto rates = y.subspan(layout.positions + hinge.speed, hinge.speeds);
      h.hinge->motion(x, rates, motion);
      const WorldMotion<S> M = across<S>(F, motion, rates, static_cast<Eigen::Index>(hinge.speed));
      const auto child = static_cast<int>(b);
      bodies_.push_back(inward<S>(M, relative(child, h.child_frame, Pose{}), first_mode_[b]));
    }
  }

  [[nodiscard]] PointMotionOf<S> relative(int body, int frame_index, const Pose& offset) const {
    const auto b = static_cast<std::size_t>(body);
    const FramePlace f = place_of(model_, {body, frame_index});
    return offset_motion<S>(section(b, f.section), f.pose * offset);
  }
  [[nodiscard]] WorldMotion<S> frame(int body, int frame_index, const Pose& offset) const {
    const auto b = static_cast<std::size_t>(body);
    return outward<S>(bodies_[b], relative(body, frame_index, offset), first_mode_[b]);
  }
  /// Adds J_ωᵀ m + J_vᵀ f of a wrench at a frame.
  void add_efforts(FrameIndex at, const Wrench& wrench, VX<S>& efforts) const {
    const WorldMotion<S> A = frame(at.body, at.frame, Pose{});
    efforts += A.JW.transpose() * wrench.moment.template cast<S>() + A.JV.transpose() * wrench.force.template cast<S>();
  }
  /// Calls particle(mass, motion) and section(inertia, motion) for all mass of a body.
  template <class OfParticle, class OfSection>
  void each(std::size_t b, OfParticle&& particle, OfSection&& section_of) const {
    if constexpr (std::is_same_v<S, double>) {
      if (rods_[b]) {
        const RodTable& rod = *terms_[b].rod;
        for (std::size_t k = 0; k < rod.sections.size(); ++k) {
          const WorldMotion<S> A = outward<S>(bodies_[b], rods_[b]->at_node(k), first_mode_[b]);
          particle(rod.masses[k], A);
          section_of(rod.inertias[k], A);
        }
        return;
      }
    }
    const ModalShape& shape = model_.bodies()[b].body->shape();
    for (const Particle& p : shape.particles) particle(p.mass, point(b, p.at));
    for (const Section& s : shape.sections) section_of(s.inertia, point(b, s.at));
  }

  /// Products of three rows are taken lazily: the blocks of great ones would take ten seconds to compile.
  /// M = Σ m JᵀJ + Σ J_ωᵀ I J_ω and f = −Σ m Jᵀ(a_bias − g) − Σ J_ωᵀ(I α_bias + ω × Iω).
  void assemble(MX<S>& M, VX<S>& f) const {
    const auto n = static_cast<Eigen::Index>(model_.layout().speeds);
    M = MX<S>::Zero(n, n);
    f = VX<S>::Zero(n);
    const V3<S> g = model_.gravity().template cast<S>();
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      each(
          b,
          [&](double mass, const WorldMotion<S>& A) {
            const M3X<S> momenta = S(mass) * A.JV;
            M += momenta.transpose().lazyProduct(A.JV);
            f -= momenta.transpose().lazyProduct(A.v_bias - g);
          },
          [&](const Matrix3& inertia, const WorldMotion<S>& A) {
            const M3<S> I = A.R * inertia.template cast<S>() * A.R.transpose();
            const M3X<S> momenta = I * A.JW;
            M += A.JW.transpose().lazyProduct(momenta);
            f -= A.JW.transpose().lazyProduct(I * A.w_bias + A.w.cross(I * A.w));
          });
    }
  }

  [[nodiscard]] Energies energies() const {
    Energies e;
    V3<S> linear = V3<S>::Zero(), angular = V3<S>::Zero();
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const auto add_mass = [&](double mass, const V3<S>& p, const V3<S>& v) {
        e.kinetic += 0.5 * mass * v.squaredNorm();
        e.potential -= mass * model_.gravity().dot(p);
        linear += mass * v;
        angular += mass * p.cross(v);
      };
      const auto add_section = [&](const Matrix3& inertia, const WorldMotion<S>& A) {
        const V3<S> h = A.R * inertia * A.R.transpose() * A.w;
        e.kinetic += 0.5 * A.w.dot(h);
        angular += h;
      };
      const ModalShape& shape = model_.bodies()[b].body->shape();
      const WorldMotion<S>& B = bodies_[b];
      if (rods_[b]) {
        each(
            b, [&](double mass, const WorldMotion<S>& A) { add_mass(mass, A.p, A.v); }, add_section);
      } else {
        for (const Particle& particle : shape.particles) {
          const auto [r, r_rate] = point_velocity(particle.at, terms_[b].order, q_[b], q_dot_[b]);
          const V3<S> arm = B.R * r;
          add_mass(particle.mass, B.p + arm, B.v + B.w.cross(arm) + B.R * r_rate);
        }
        for (const Section& section : shape.sections) add_section(section.inertia, point(b, section.at));
      }
      if (q_[b].size() > 0) e.potential += 0.5 * q_[b].dot(shape.stiffness * q_[b]);
    }
    for (Eigen::Index i = 0; i < 3; ++i) {
      e.linear_momentum[static_cast<std::size_t>(i)] = linear[i];
      e.angular_momentum[static_cast<std::size_t>(i)] = angular[i];
    }
    return e;
  }

 private:
  /// The elements of y that belong to each body's modes, by position or from `first_speed` on by speed, times its
  /// factor.
  static std::vector<VX<S>> scaled(const Model& model, const std::vector<BodyTerms<S>>& terms,
                                   std::span<const double> y, std::size_t first_speed) {
    std::vector<VX<S>> all;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      all.emplace_back(model.bodies()[b].body->shape().modes());
      if (all.back().size() == 0) continue;
      const Slot& slot = *model.layout().modes(b);
      const std::size_t at = first_speed == 0 ? slot.position : first_speed + slot.speed;
      for (Eigen::Index i = 0; i < all.back().size(); ++i)
        all.back()[i] = terms[b].scale * S(y[at + static_cast<std::size_t>(i)]);
    }
    return all;
  }
  /// A section of a body relative to it.
  [[nodiscard]] PointMotionOf<S> section(std::size_t b, const PointExpansion& e) const {
    if constexpr (std::is_same_v<S, double>) {
      if (rods_[b]) return rods_[b]->at(e.X.x());
    }
    return point_motion<S>(e, terms_[b].order, q_[b], q_dot_[b]);
  }
  [[nodiscard]] WorldMotion<S> point(std::size_t b, const PointExpansion& e) const {
    return outward<S>(bodies_[b], section(b, e), first_mode_[b]);
  }

  const Model& model_;
  std::vector<BodyTerms<S>> terms_;
  std::vector<WorldMotion<S>> bodies_;
  std::vector<Eigen::Index> first_mode_;
  std::vector<VX<S>> q_, q_dot_;
  std::vector<std::optional<RodMotion>> rods_;
};

}  // namespace withy::reference
