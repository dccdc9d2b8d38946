/// \file
/// Wrenches that hinges carry, by one pass inward: the rate of momentum of all that hangs on a hinge, less its weight
/// and the loads on it.
///
/// With h the momentum about the hinge frame M, in its axes, and V the twist of M, a hinge with six free speeds has
///   f = ḣ + V ×* h
/// in its row of the equations. In the scalar of a truncation, h is made of the twists, shapes and rates that it keeps,
/// so that f is what that formulation's own equations say of such a hinge: of first order in (q, q̇, q̈) under strict,
/// from the kinetic energy of first order under symmetric truncation.
#pragma once

#include "withy/core/kinematics/frame_pass.hpp"
#include "withy/core/kinematics/sensed_pass.hpp"

namespace withy::sensed {

template <class T>
T now(const DualNumber<T, 1>& x) {
  return x.value();
}
template <class T>
T rate(const DualNumber<T, 1>& x) {
  return x.derivatives()[0];
}
template <class T>
V3<T> now(const V3<DualNumber<T, 1>>& v) {
  return {now(v[0]), now(v[1]), now(v[2])};
}
template <class T>
V3<T> rate(const V3<DualNumber<T, 1>>& v) {
  return {rate(v[0]), rate(v[1]), rate(v[2])};
}

/// What the rows of a hinge keep.
template <class T>
Vector3 on_hinge(const V3<T>& v) {
  return {frame_pass::on_hinge(v[0]), frame_pass::on_hinge(v[1]), frame_pass::on_hinge(v[2])};
}

/// Place of a generalized particle times its coefficient, and its velocity relative to the body.
template <class S>
struct PointMotion {
  V3<S> r, rate;
  PointMotion(const PointFields& fields, std::size_t modes, const S* q, const S* u) {
    r = fields.first[0].cast<S>();
    rate.setZero();
    for (std::size_t i = 0; i < modes; ++i) {
      const Vector3& phi = fields.first[i + 1];
      for (Eigen::Index c = 0; c < 3; ++c) {
        if (phi[c] == 0) continue;
        r[c] += q[i] * phi[c];
        rate[c] += u[i] * phi[c];
      }
    }
    if (fields.second.empty()) return;
    const Vector3* gamma = fields.second.data();
    for (std::size_t i = 0; i < modes; ++i) {
      for (std::size_t j = i; j < modes; ++j, ++gamma) {
        if (gamma->isZero(0)) continue;
        const S product = i == j ? S(q[i] * q[i] * 0.5) : S(q[i] * q[j]);
        const S change = i == j ? S(q[i] * u[i]) : S(q[i] * u[j] + u[i] * q[j]);
        for (Eigen::Index c = 0; c < 3; ++c) {
          r[c] += product * (*gamma)[c];
          rate[c] += change * (*gamma)[c];
        }
      }
    }
  }
};

/// Mass [kg] and first moment [kg m] of a body, in its axes.
template <class S>
struct MassMoment {
  double mass = 0;
  V3<S> moment = V3<S>::Zero();
};

/// Calls of(c, r, ṙ) for each of a rod's nodes; c its √mass, r and ṙ times it, with rates in time where S has them.
template <class S, class Of>
void each_rod_node(Pass<S>& pass, const BodyPlan& body, Of&& of) {
  using Rod = sweep::RodKinematics<Spatial>;
  const Rod& rod = body.rod->kinematics;
  const sweep::RodWork work = pass.rod_work(body);
  const int n = static_cast<int>(body.modes), packs = rod.integrals.packs;
  for (int k = 0; k < packs; ++k) {
    const Pack* y = work.value + k;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const double c = rod.integrals.root_mass[static_cast<std::size_t>(k)][lane];
      const auto at = [&](int function) {
        return Vector3(y[function * packs][lane], y[(function + 1) * packs][lane], y[(function + 2) * packs][lane]);
      };
      const Vector3 r = c * at(0);
      Vector3 v = Vector3::Zero(), a = Vector3::Zero();
      if constexpr (!std::is_same_v<S, double>) {
        a = c * at(Rod::a(n));
        for (int i = 0; i < n; ++i) {
          const Vector3 P = c * at(Rod::P(n) + 3 * i);
          const S& u = pass.u[body.first_mode + static_cast<std::size_t>(i)];
          v += P * now(u);
          a += P * rate(u);
        }
      }
      of(c, with_rates<S>(r, v), with_rates<S>(v, a), k, lane);
    }
  }
}

/// What of a rod's node belongs to a part: the share of its mass, and rotary inertia in the section's axes.
struct NodePart {
  double share = 1;
  const Matrix3& inertia;
};
inline NodePart part_of(const BodyPlan& whole, int pack, std::size_t lane) {
  return {1, whole.rod->inertias[lanes * static_cast<std::size_t>(pack) + lane]};
}
inline NodePart part_of(const CutPlan& cut, int pack, std::size_t lane) {
  const std::size_t k = lanes * static_cast<std::size_t>(pack) + lane;
  return {cut.of_rod.shares[k], cut.of_rod.inertias[k]};
}

template <class S, class Mass>
MassMoment<S> mass_moment(Pass<S>& pass, const BodyPlan& body, const Mass& part) {
  MassMoment<S> m;
  if (body.modes == 0) return {part.rigid.mass, part.rigid.moment.template cast<S>()};
  if constexpr (!std::is_same_v<S, Second>) {
    if (body.rod != nullptr) {
      each_rod_node(pass, body, [&](double c, const V3<S>& r, const V3<S>&, int k, std::size_t lane) {
        const double share = part_of(part, k, lane).share;
        m.mass += c * c * share;
        m.moment += r * S(c * share);
      });
      return m;
    }
  }
  const auto modes = static_cast<std::size_t>(body.modes);
  for (const PointFields& fields : part.points) {
    if (fields.constant == 0) continue;
    const S* q = pass.q.data() + body.first_mode;
    m.mass += fields.constant * fields.constant;
    m.moment += PointMotion<S>(fields, modes, q, q).r * S(fields.constant);
  }
  return m;
}

/// Momentum of a body about its frame, in its axes, and what its relative velocities do along it: with V the twist of
/// the frame, T = ½ (V · h + along).
template <class S>
struct MomentumOf {
  TwistOf<S> h;
  S along = S(0.0);
};

/// The momentum of a generalized particle about the body's frame, whose twist is V.
template <class S>
MomentumOf<S> of_point(double c, const V3<S>& r, const V3<S>& relative, const TwistOf<S>& V) {
  V3<S> v = V.w.cross(r) + relative;
  if (c != 0) v += V.v * S(c);
  return {{r.cross(v), v * S(c)}, relative.dot(v)};
}

/// Momentum of a rod's node with this rotary inertia in its section's axes.
inline MomentumOf<First> rod_turning(Pass<First>& pass, const BodyPlan& body, int k, std::size_t lane,
                                     const Matrix3& inertia, const TwistOf<First>& V) {
  using Rod = sweep::RodKinematics<Spatial>;
  const Rod& rod = body.rod->kinematics;
  if (rod.axes_each == 0) return {};
  const sweep::RodWork work = pass.rod_work(body);
  const int n = static_cast<int>(body.modes), packs = rod.integrals.packs;
  const auto at = [&](const Pack* first, int function) {
    const Pack* f = first + function * packs + k;
    return Vector3(f[0][lane], f[packs][lane], f[2 * packs][lane]);
  };
  Vector3 w = Vector3::Zero(), slope = at(work.value, Rod::b(n));
  for (int i = 0; i < n; ++i) {
    const Vector3 wi = at(work.value, Rod::w + 3 * i);
    const First& u = pass.u[body.first_mode + static_cast<std::size_t>(i)];
    w += wi * now(u);
    slope += wi * rate(u);
  }
  const Pack turn = work.rotation[4 * k + static_cast<int>(lane)];
  const Matrix3 R = Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]).toRotationMatrix();
  const Matrix3 J = R * inertia * R.transpose();
  const V3<First> relative = with_rates<First>(w, slope), spin = V.w + relative;
  // d/dt (J ω), with J fixed to the section, which turns with w.
  const Vector3 h_now = J * now(spin);
  const V3<First> h = with_rates<First>(h_now, Vector3(w.cross(h_now) + J * (rate(spin) - w.cross(now(spin)))));
  return {{h, V3<First>::Zero()}, relative.dot(h)};
}

/// Momentum of a body's own mass, or of a part of it, about its frame, in its axes. `Mass`: BodyPlan or CutPlan.
template <class S, class Mass>
MomentumOf<S> own_momentum(Pass<S>& pass, std::size_t index, const BodyPlan& body, const Mass& part) {
  const TwistOf<S>& V = pass.bodies[index].V;
  MomentumOf<S> sum;
  if (body.modes == 0) {
    const V3<S> moment = part.rigid.moment.template cast<S>();
    return {{part.rigid.inertia.template cast<S>() * V.w + moment.cross(V.v),
             V.v * S(part.rigid.mass) + V.w.cross(moment)}};
  }
  if constexpr (std::is_same_v<S, First>) {
    if (body.rod != nullptr) {
      each_rod_node(pass, body, [&](double c, const V3<S>& r, const V3<S>& v, int k, std::size_t lane) {
        const NodePart here = part_of(part, k, lane);
        const S share(here.share);
        const MomentumOf<S> own = of_point(c, r, v, V), turning = rod_turning(pass, body, k, lane, here.inertia, V);
        sum.h += TwistOf<S>{own.h.w * share + turning.h.w, own.h.v * share};
        sum.along += own.along * share + turning.along;
      });
      return sum;
    }
  }
  const S* q = pass.q.data() + body.first_mode;
  const S* u = pass.u.data() + body.first_mode;
  for (const PointFields& fields : part.points) {
    const PointMotion<S> m(fields, static_cast<std::size_t>(body.modes), q, u);
    const MomentumOf<S> own = of_point(fields.constant, m.r, m.rate, V);
    sum.h += own.h;
    sum.along += own.along;
  }
  for (const RotarySection& rotary : part.rotary) {
    const StepOf<S> step = expanded(body, rotary.section, q, u);
    const V3<S> spin = step.X.R.transpose() * V.w + step.V.w;
    const V3<S> h = rotary.inertia.cast<S>() * spin;
    sum.h.w += step.X.R * h;
    sum.along += step.V.w.dot(h);
  }
  return sum;
}

/// ḣ + V ×* h of a momentum about a frame with the twist V: what drives it, as far as a hinge's rows keep it.
template <class S>
TwistOf<double> driving(const TwistOf<S>& h, const TwistOf<S>& V) {
  const auto w = now(V.w), v = now(V.v), moment = now(h.w), force = now(h.v);
  return {on_hinge(decltype(w)(rate(h.w) + w.cross(moment) + v.cross(force))),
          on_hinge(decltype(w)(rate(h.v) + w.cross(force)))};
}

/// Gathers the momenta, or the wrenches, of all bodies inward: `total[b]`, about the frame of body b, comes to be that
/// of all that hangs on its hinge.
template <class S>
void gather(const Pass<S>& pass, const Plan& plan, std::vector<TwistOf<S>>& total) {
  for (std::size_t b = plan.bodies.size(); b-- > 0;) {
    const int parent = plan.bodies[b].hinge->parent;
    if (parent < 0) continue;
    const BodyMotionOf<S>& body = pass.bodies[b];
    total[static_cast<std::size_t>(parent)] += body.PM.to_parent(body.BM.from_parent(total[b]));
  }
}

/// Weight of a body, or of a part of it, about its frame.
template <class S, class Mass>
TwistOf<S> weight(Pass<S>& pass, std::size_t index, const Plan& plan, const Mass& part) {
  const V3<S> g = pass.bodies[index].WB.R.transpose() * plan.model.gravity().cast<S>();
  const MassMoment<S> m = mass_moment(pass, plan.bodies[index], part);
  return {m.moment.cross(g), g * S(m.mass)};
}

/// A wrench about the origin of a frame, world axes, about the frame of the body.
template <class S>
TwistOf<S> on_body(const Pass<S>& pass, const Plan& plan, FrameIndex at, const Wrench& wrench) {
  const auto b = static_cast<std::size_t>(at.body);
  const V3<S> p = pass.frame(b, plan.bodies[b].frame(at.frame)).X.p;
  const M3<S> back = pass.bodies[b].WB.R.transpose();
  const V3<S> force = back * V3<S>(wrench.force.cast<S>());
  return {back * V3<S>(wrench.moment.cast<S>()) + p.cross(force), force};
}

}  // namespace withy::sensed
