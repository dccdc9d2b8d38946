/// \file
/// One pass over the bodies of a model in any scalar: poses and twists outward, momenta and wrenches inward.
///
/// The scalar carries what is wanted of the same functions: a rate in time, the order in the elastic coordinates, or
/// both. Twists and wrenches are in the axes of their frame, angular part first, as in space.hpp.
#pragma once

#include <type_traits>
#include <vector>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/kinematics/sensed_plan.hpp"
#include "withy/core/spatial/jet.hpp"

namespace withy::sensed {

/// a + b τ with τ² = 0: a number and its rate, or a number and its first order in the elastic coordinates.
using First = DualNumber<double, 1>;
/// The same of these.
using Second = DualNumber<First, 1>;

constexpr int any_count = -1;  ///< of modes: not known when compiled

inline double number(double x) { return x; }
inline double number(const First& x) { return x.value(); }
inline double number(const Second& x) { return x.value().value(); }

inline First first(double value, double derivative) { return {value, {derivative}}; }

template <class S>
using V3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using M3 = Eigen::Matrix<S, 3, 3>;

template <class S>
struct TwistOf {
  V3<S> w = V3<S>::Zero(), v = V3<S>::Zero();
  TwistOf& operator+=(const TwistOf& b) { return w += b.w, v += b.v, *this; }
  friend TwistOf operator+(TwistOf a, const TwistOf& b) { return a += b; }
  friend TwistOf operator-(const TwistOf& a, const TwistOf& b) { return {a.w - b.w, a.v - b.v}; }
};

template <class S>
struct PoseOf {
  M3<S> R = M3<S>::Identity();
  V3<S> p = V3<S>::Zero();

  PoseOf() = default;
  PoseOf(const M3<S>& rotation, const V3<S>& position) : R(rotation), p(position) {}
  explicit PoseOf(const Pose& X) : R(X.R.cast<S>()), p(X.p.cast<S>()) {}

  friend PoseOf operator*(const PoseOf& A, const PoseOf& B) { return {A.R * B.R, A.p + A.R * B.p}; }
  [[nodiscard]] PoseOf inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
  /// Twist of the other frame on one rigid body, from that of this pose's outer frame; and back.
  [[nodiscard]] TwistOf<S> to_child(const TwistOf<S>& V) const {
    return {R.transpose() * V.w, R.transpose() * V3<S>(V.v + V.w.cross(p))};
  }
  [[nodiscard]] TwistOf<S> from_child(const TwistOf<S>& V) const {
    const V3<S> w = R * V.w;
    return {w, R * V.v - w.cross(p)};
  }
  /// Wrench or momentum about the outer frame's origin from that about the inner one's; and back.
  [[nodiscard]] TwistOf<S> to_parent(const TwistOf<S>& f) const {
    const V3<S> force = R * f.v;
    return {R * f.w + p.cross(force), force};
  }
  [[nodiscard]] TwistOf<S> from_parent(const TwistOf<S>& f) const {
    return {R.transpose() * V3<S>(f.w - p.cross(f.v)), R.transpose() * f.v};
  }
};

/// Of a section or a frame relative to the body, or of a hinge: pose, and twist in its own axes.
template <class S>
struct StepOf {
  PoseOf<S> X;
  TwistOf<S> V;
};

/// Of a body.
template <class S>
struct BodyMotionOf {
  PoseOf<S> WB;  ///< in the world
  PoseOf<S> PM;  ///< of its hinge's frame M in the parent's frame, and in its own
  PoseOf<S> BM;
  TwistOf<S> V, V_M;  ///< of its frame and of M
};

/// Values with their rates in time.
template <class S, int Columns>
Eigen::Matrix<S, 3, Columns> with_rates(const Eigen::Matrix<double, 3, Columns>& value,
                                        const Eigen::Matrix<double, 3, Columns>& rate) {
  Eigen::Matrix<S, 3, Columns> both;
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    if constexpr (std::is_same_v<S, double>) {
      both(i) = value(i);
    } else if constexpr (std::is_same_v<S, First>) {
      both(i) = first(value(i), rate(i));
    } else {
      both(i) = Second(First(value(i)), {First(rate(i))});
    }
  }
  return both;
}

/// Theory (1), (2); the section's angular velocity in its own axes is the right Jacobian times θ̇.
template <class S>
StepOf<S> expanded(const BodyPlan& plan, const SectionFields& section, const S* q, const S* u) {
  StepOf<S> step;
  const PointExpansion& e = section.at;
  step.X.p = e.X.cast<S>();
  if (!section.moves) return step;
  V3<S> theta = V3<S>::Zero(), theta_rate = V3<S>::Zero(), rate = V3<S>::Zero();
  const bool second = plan.order != StrainOrder::linear;
  for (Eigen::Index i = 0; i < plan.modes; ++i) {
    V3<S> P = e.phi.col(i).cast<S>(), T = e.psi.col(i).cast<S>();
    const V3<S> P_0 = P, T_0 = T;
    for (Eigen::Index j = 0; second && j < plan.modes; ++j) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        P[c] += q[j] * e.gamma[static_cast<std::size_t>(c)](i, j);
        T[c] += q[j] * e.theta[static_cast<std::size_t>(c)](i, j);
      }
    }
    const S half = q[i] * 0.5;
    step.X.p += (P_0 + P) * half;
    theta += (T_0 + T) * half;
    rate += P * u[i];
    theta_rate += T * u[i];
  }
  const detail::ExponentialCoefficients<S> k(S(theta.squaredNorm()));
  const M3<S> t = skew<S>(theta);
  const M3<S> tt = t * t;
  step.X.R += t * k.a + tt * k.b;
  step.V.w = theta_rate - V3<S>(t * theta_rate) * k.b + V3<S>(tt * theta_rate) * k.c;
  step.V.v = step.X.R.transpose() * rate;
  return step;
}

/// Memory and kinematics of a pass. Whoever uses it sets q, u and the hinges' steps, then goes outward.
template <class S>
class Pass {
 public:
  explicit Pass(const Plan& plan)
      : q(plan.modes),
        u(plan.modes),
        hinges(plan.bodies.size()),
        bodies(plan.bodies.size()),
        plan_(plan),
        first_section_(plan.bodies.size()),
        sections_(plan.sections),
        numbers_(2 * plan.most_modes),
        partials_(plan.most_modes),
        rods_(std::is_same_v<S, Second> ? 0 : plan.rod_packs) {
    std::size_t next = 0;
    for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
      first_section_[b] = next;
      next += plan.bodies[b].sections.size();
    }
  }

  std::vector<S> q, u;            ///< modal coordinates and their rates, of all bodies
  std::vector<StepOf<S>> hinges;  ///< M in F
  std::vector<BodyMotionOf<S>> bodies;

  void outward() {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const BodyPlan& plan = plan_.bodies[b];
      deform(b);
      BodyMotionOf<S>& body = bodies[b];
      const SectionFrame& root = plan.frames[plan.M];
      const StepOf<S>& own = section(b, root.section);
      const PoseOf<S> SM(root.pose);
      body.BM = own.X * SM;
      PoseOf<S> F(plan.F.pose);
      TwistOf<S> V_F;
      const bool at_world = plan.hinge->parent < 0;
      const auto parent = static_cast<std::size_t>(at_world ? 0 : plan.hinge->parent);
      if (!at_world) {
        const StepOf<S>& on = section(parent, plan.F.section);
        V_F = F.to_child(on.X.to_child(bodies[parent].V) + on.V);
        F = on.X * F;
      }
      body.PM = F * hinges[b].X;
      body.V_M = hinges[b].X.to_child(V_F) + hinges[b].V;
      body.V = own.X.from_child(SM.from_child(body.V_M) - own.V);
      const PoseOf<S> PB = body.PM * body.BM.inverse();
      body.WB = at_world ? PB : bodies[parent].WB * PB;
    }
  }

  [[nodiscard]] const StepOf<S>& section(std::size_t body, std::size_t index) const {
    return sections_[first_section_[body] + index];
  }
  /// Pose of a frame in its body and its twist, in its axes.
  [[nodiscard]] StepOf<S> frame(std::size_t body, std::size_t index) const {
    const SectionFrame& at = plan_.bodies[body].frames[index];
    const StepOf<S>& on = section(body, at.section);
    const PoseOf<S> SF(at.pose);
    return {on.X * SF, SF.to_child(on.X.to_child(bodies[body].V) + on.V)};
  }

  /// At the state it is at.
  [[nodiscard]] sweep::RodWork rod_work(const BodyPlan& plan) {
    return sweep::rod_work_at(plan.rod->kinematics, static_cast<int>(plan.modes), rods_.data() + plan.rod->work);
  }

 private:
  void deform(std::size_t b) {
    const BodyPlan& plan = plan_.bodies[b];
    StepOf<S>* out = sections_.data() + first_section_[b];
    if constexpr (!std::is_same_v<S, Second>) {
      if (plan.rod != nullptr) return deform_rod(plan, out);
    }
    const S* modes = q.data() + plan.first_mode;
    const S* rates = u.data() + plan.first_mode;
    for (const SectionFields& s : plan.sections) *out++ = expanded(plan, s, modes, rates);
  }

  static Vector3 vector(const Triple& t) { return {t[0], t[1], t[2]}; }

  /// Without derivatives, or with rates in time: a rod has no orders.
  void deform_rod(const BodyPlan& plan, StepOf<S>* out) requires(!std::is_same_v<S, Second>) {
    const auto n = static_cast<int>(plan.modes);
    double* x = numbers_.data();
    double* rates = x + n;
    for (int i = 0; i < n; ++i) {
      const std::size_t k = plan.first_mode + static_cast<std::size_t>(i);
      x[i] = number(q[k]);
      rates[i] = number(u[k]);
    }
    const sweep::RodWork work = rod_work(plan);
    sweep::rod_motion<any_count>(plan.rod->kinematics, n, x, rates, work);
    for (std::size_t s = 0; s < plan.sections.size(); ++s) {
      sweep::StationMotion<Spatial> m;
      sweep::rod_station_motion<any_count>(plan.rod->kinematics, s, work, n, x, rates, m, partials_.data());
      Matrix3 R;
      for (int c = 0; c < 3; ++c) R.col(c) = vector(m.frame.R.c[c]);
      const Vector3 p = vector(m.frame.p), w = vector(m.rate.w), v = vector(m.rate.v);
      StepOf<S>& step = out[s];
      if constexpr (std::is_same_v<S, double>) {
        step = {{R, p}, {w, v}};
      } else {
        Spatial::Twist slope = m.bias;
        for (int i = 0; i < n; ++i)
          slope += partials_[static_cast<std::size_t>(i)] *
                   u[plan.first_mode + static_cast<std::size_t>(i)].derivatives()[0];
        step.X = {with_rates<S>(R, Matrix3(R * skew<double>(w))), with_rates<S>(p, Vector3(R * v))};
        step.V = {with_rates<S>(w, vector(slope.w)), with_rates<S>(v, vector(slope.v))};
      }
    }
  }

  const Plan& plan_;
  std::vector<std::size_t> first_section_;
  std::vector<StepOf<S>> sections_;
  std::vector<double> numbers_;  ///< q, q̇ of a rod
  std::vector<Spatial::Twist> partials_;
  std::vector<Pack> rods_;
};

}  // namespace withy::sensed
