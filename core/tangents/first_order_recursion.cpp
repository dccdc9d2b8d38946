#include "withy/core/tangents/first_order_recursion.hpp"

#include "withy/core/deformation/mass_points.hpp"

namespace withy::analysis {

template <class T>
FirstOrderRecursion<T>::FirstOrderRecursion(const Model& model, std::vector<HingeState<T>> hinges,
                                            std::vector<BodyState<T>> bodies)
    : model_(model), hinges_(std::move(hinges)), states_(std::move(bodies)) {
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const HingeNode& h = model.hinges()[b];
    Frame F;
    parent_.emplace_back();
    if (h.parent < 0) {
      F.R.order[0] = h.offset.R.template cast<T>();
      F.p.order[0] = h.offset.p.template cast<T>();
    } else {
      parent_.back() = relative(h.parent, h.parent_frame, h.offset);
      F = outward(frames_[static_cast<std::size_t>(h.parent)], parent_.back());
    }
    outer_frames_.push_back(F);
    hinge_frames_.push_back(across(F, hinges_[b]));
    child_.push_back(relative(static_cast<int>(b), h.child_frame, Pose{}));
    frames_.push_back(inward(hinge_frames_[b], child_[b]));
  }
}

template <class T>
typename FirstOrderRecursion<T>::VX FirstOrderRecursion<T>::efforts(
    const std::vector<AppliedWrench<T>>& wrenches) const {
  const Layout& layout = model_.layout();
  VX result = VX::Zero(static_cast<Eigen::Index>(layout.speeds));
  std::vector<Load> loads;
  for (std::size_t b = 0; b < frames_.size(); ++b) loads.push_back(own_load(b));
  for (const AppliedWrench<T>& w : wrenches) {
    const auto b = static_cast<std::size_t>(w.at.body);
    add_wrench(loads[b], frames_[b], relative(w.at.body, w.at.frame, Pose{}), w);
  }
  for (std::size_t b = frames_.size(); b-- > 0;) {
    const HingeNode& node = model_.hinges()[b];
    const Frame& M = hinge_frames_[b];
    const Load at_M = about(loads[b], frames_[b].p - M.p);
    VX modes = loads[b].modes;
    add_rows(modes, frames_[b], child_[b], M, at_M, -1);
    if (const Slot* slot = layout.modes(b); slot != nullptr)
      result.segment(static_cast<Eigen::Index>(slot->speed), modes.size()) = modes;

    const HingeState<T>& hinge = hinges_[b];
    const Vector moment =
        at_M.moment + less_raised<T>(cross<T>(M.w_modes, at_M.spin_momentum) + cross<T>(M.v_modes, at_M.momentum));
    const Vector force = at_M.force + less_raised<T>(cross<T>(M.w_modes, at_M.momentum));
    for (Eigen::Index k = 0; k < hinge.H.cols(); ++k) {
      const V3 turn = hinge.H.col(k).template head<3>(), slide = hinge.H.col(k).template tail<3>();
      const Place axis = M.R * Place::constant(turn), direction = M.R * Place::constant(slide);
      result[static_cast<Eigen::Index>(layout.hinges[b].speed) + k] =
          dot<T>(axis, moment) + dot<T>(direction, force) - dot<T>(axis, at_M.dead_moment) -
          dot<T>(direction, Place::constant(at_M.dead_force));
    }
    if (node.parent < 0) continue;
    const auto p = static_cast<std::size_t>(node.parent);
    const Frame& F = outer_frames_[b];
    add_rows(loads[p].modes, frames_[p], parent_[b], F, about(at_M, M.p - F.p), 1);
    const Load at_parent = about(at_M, M.p - frames_[p].p);
    loads[p].force += at_parent.force;
    loads[p].moment += at_parent.moment;
    loads[p].momentum += at_parent.momentum;
    loads[p].spin_momentum += at_parent.spin_momentum;
    loads[p].dead_force += at_parent.dead_force;
    loads[p].dead_moment += at_parent.dead_moment;
  }
  return result;
}

template <class T>
typename FirstOrderRecursion<T>::Frame FirstOrderRecursion<T>::outward(const Frame& B, const Relative& m) {
  Frame A;
  const Place reach = B.R * m.r;
  const Turn R = B.R;
  const Vector arm = low<T>(reach), rate = R * m.rate, spin = R * m.spin;
  const Vector turning = B.w - less_raised<T>(B.w_modes);  // of the pose
  A.R = B.R * m.R;
  A.p = B.p + reach;
  A.w = B.w + spin;
  A.v = B.v + cross<T>(B.w, arm) + rate;
  A.w_modes = B.w_modes + spin;
  A.v_modes = B.v_modes + cross<T>(B.w_modes, arm) + rate;
  A.alpha = B.alpha + cross<T>(turning, spin) + R * m.w_change;
  A.a = B.a + cross<T>(B.alpha, arm) + cross<T>(B.w, cross<T>(turning, arm) + raised<T>(rate)) +
        cross<T>(turning, rate) + R * m.r_change;
  return A;
}

template <class T>
typename FirstOrderRecursion<T>::Frame FirstOrderRecursion<T>::inward(const Frame& M, const Relative& m) {
  Frame B;
  B.R = M.R * transposed<T>(m.R);
  const Place reach = B.R * m.r;
  const Vector arm = low<T>(reach), rate = B.R * m.rate, spin = B.R * m.spin;
  B.p = M.p - reach;
  B.w = M.w - spin;
  B.v = M.v - cross<T>(B.w, arm) - rate;
  B.w_modes = M.w_modes - spin;
  B.v_modes = M.v_modes - cross<T>(B.w_modes, arm) - rate;
  const Vector turning = B.w - less_raised<T>(B.w_modes);
  B.alpha = M.alpha - cross<T>(turning, spin) - B.R * m.w_change;
  B.a = M.a - cross<T>(B.alpha, arm) - cross<T>(B.w, cross<T>(turning, arm) + raised<T>(rate)) -
        cross<T>(turning, rate) - B.R * m.r_change;
  return B;
}

template <class T>
typename FirstOrderRecursion<T>::Frame FirstOrderRecursion<T>::across(const Frame& F, const HingeState<T>& h) {
  Frame M;
  const Place reach = F.R * Place::constant(h.p);
  const Vector arm = low<T>(reach);
  M.R = F.R * Turn::constant(h.R);
  M.p = F.p + reach;
  const Eigen::Matrix<T, 6, 1> local = h.H * h.rates;
  const Eigen::Matrix<T, 6, 1> change = h.H * h.accelerations + h.bias;
  const auto in_world = [&](const V3& v) { return Vector(M.R * Vector::constant(v)); };
  const Vector w = in_world(local.template head<3>()), v = in_world(local.template tail<3>());
  const Vector turning = F.w - less_raised<T>(F.w_modes);
  M.w = F.w + w;
  M.v = F.v + cross<T>(F.w, arm) + v;
  M.w_modes = F.w_modes;
  M.v_modes = F.v_modes + cross<T>(F.w_modes, arm);
  M.alpha = F.alpha + cross<T>(turning, w) + in_world(change.template head<3>());
  M.a = F.a + cross<T>(F.alpha, arm) + cross<T>(F.w, cross<T>(turning, arm) + v) + cross<T>(turning + w, v) +
        in_world(change.template tail<3>());
  return M;
}

template <class T>
typename FirstOrderRecursion<T>::Relative FirstOrderRecursion<T>::section(std::size_t b, const PointExpansion& e,
                                                                          bool turns) const {
  const BodyState<T>& s = states_[b];
  const Eigen::Index n = s.q.size();
  const bool curved = s.order != StrainOrder::linear && n > 0;
  // Φ q, half the sum ½ qᵀ Γ q, Γ q a column of which belongs to a mode, and q̇ᵀ Γ q̇.
  struct Expansion {
    V3 first = V3::Zero(), second = V3::Zero(), change = V3::Zero();
    Eigen::Matrix<T, 3, Eigen::Dynamic> slope;
  };
  const auto expand = [&](const Matrix3X& first, const std::array<Eigen::MatrixXd, 3>& second) {
    Expansion x;
    x.slope.setZero(3, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        if (first(c, i) != 0) x.first[c] += s.q[i] * first(c, i);
        if (!curved) continue;
        const Eigen::MatrixXd& of = second[static_cast<std::size_t>(c)];
        T slope_rate(0.0);
        for (Eigen::Index j = 0; j < n; ++j) {
          if (of(i, j) == 0) continue;
          x.slope(c, i) += s.q[j] * of(i, j);
          slope_rate += s.q_dot[j] * of(i, j);
        }
        x.second[c] += T(0.5) * x.slope(c, i) * s.q[i];
        x.change[c] += slope_rate * s.q_dot[i];
      }
    }
    return x;
  };
  const auto sum_up = [&](const Expansion& x, const Matrix3X& first, const Expansion* turn,
                          std::vector<Vector>& partials, Vector& rate, Vector& change) {
    rate = Vector::zero();
    change = {{V3::Zero(), x.change}};
    for (Eigen::Index i = 0; i < n; ++i) {
      const V3 zero = first.col(i).template cast<T>();
      V3 one = x.slope.col(i);
      // The partial angular velocities of exp(θ̂) are (1 + ½ θ̂ + …) ∂θ/∂q.
      if (turn != nullptr) one += V3(turn->first.cross(zero)) * T(0.5);
      partials.push_back({{zero, one}});
      for (std::size_t k = 0; k < 2; ++k) {
        rate.order[k] += partials.back().order[k] * s.q_dot[i];
        change.order[k] += partials.back().order[k] * s.q_ddot[i];
      }
    }
  };
  Relative m;
  const Expansion x = expand(e.phi, e.gamma);
  m.r = {{e.X.template cast<T>(), x.first, x.second}};
  sum_up(x, e.phi, nullptr, m.P, m.rate, m.r_change);
  if (!turns) return m;
  const Expansion turn = expand(e.psi, e.theta);
  sum_up(turn, e.psi, &turn, m.W, m.spin, m.w_change);
  const M3 once = skew<T>(turn.first);
  m.R = {{M3::Identity(), once, M3(skew<T>(turn.second) + once * once * T(0.5))}};
  return m;
}

template <class T>
typename FirstOrderRecursion<T>::Relative FirstOrderRecursion<T>::relative(int body, int frame,
                                                                           const Pose& offset) const {
  const FramePlace place = place_of(model_, {body, frame});
  Relative m = section(static_cast<std::size_t>(body), place.section, true);
  const Pose fixed = place.pose * offset;
  const Place reach = m.R * Place::constant(fixed.p.template cast<T>());
  const Vector arm = low<T>(reach);
  m.r += reach;
  m.r_change += cross<T>(m.w_change, arm) + cross<T>(m.spin, raised<T>(cross<T>(m.spin, arm)));
  m.rate += cross<T>(m.spin, arm);
  for (std::size_t i = 0; i < m.P.size(); ++i) m.P[i] += cross<T>(m.W[i], arm);
  m.R = m.R * Turn::constant(fixed.R.template cast<T>());
  return m;
}

template <class T>
typename FirstOrderRecursion<T>::Load FirstOrderRecursion<T>::own_load(std::size_t b) const {
  const ModalShape& shape = model_.bodies()[b].body->shape();
  Load load;
  load.modes = VX::Zero(states_[b].q.size());
  for (const Particle& p : shape.particles) add_particle(load, frames_[b], section(b, p.at, false), p.mass);
  for (const Section& s : shape.sections) add_section(load, frames_[b], section(b, s.at, true), s.inertia);
  return load;
}

template <class T>
void FirstOrderRecursion<T>::add_particle(Load& load, const Frame& B, const Relative& m, double mass) const {
  const Place reach = B.R * m.r;
  const Vector arm = low<T>(reach), rate = B.R * m.rate;
  const Vector turning = B.w - less_raised<T>(B.w_modes);
  const Vector v = B.v + cross<T>(B.w, arm) + rate, v_modes = B.v_modes + cross<T>(B.w_modes, arm) + rate;
  const Vector a = B.a + cross<T>(B.alpha, arm) + cross<T>(B.w, cross<T>(turning, arm) + raised<T>(rate)) +
                   cross<T>(turning, rate) + B.R * m.r_change;
  const Vector f = scaled<T>(a, mass), p = scaled<T>(v, mass);
  const V3 weight = (mass * model_.gravity()).template cast<T>();
  load.force += f;
  load.moment += cross<T>(arm, f) - less_raised<T>(cross<T>(v_modes, p));
  load.momentum += p;
  load.spin_momentum += cross<T>(arm, p);
  load.dead_force += weight;
  load.dead_moment += cross<T>(reach, Place::constant(weight));
  const Vector on_modes = f - less_raised<T>(cross<T>(B.w - B.w_modes, p)) - Vector::constant(weight);
  const Vector in_body = transposed<T>(B.R) * on_modes;
  for (std::size_t i = 0; i < m.P.size(); ++i) load.modes[static_cast<Eigen::Index>(i)] += dot<T>(m.P[i], in_body);
}

template <class T>
void FirstOrderRecursion<T>::add_section(Load& load, const Frame& B, const Relative& m, const Matrix3& inertia) const {
  const Frame A = outward(B, m);
  const auto in_world = [&](const Matrix3& of_section) {
    return Series<M3, 2>(low<T>(A.R) * Series<M3, 2>::constant(of_section.template cast<T>()) *
                         transposed<T>(low<T>(A.R)));
  };
  const Series<M3, 2> I = in_world(inertia);
  // As particles without mass about their centre, Σ m ρ ρᵀ = S.
  const Series<M3, 2> S = in_world(0.5 * inertia.trace() * Matrix3::Identity() - inertia);
  const Vector turning = A.w - less_raised<T>(A.w_modes);
  const Vector h = I * A.w;
  const Vector n = I * A.alpha - cross<T>(turning, S * A.w) - less_raised<T>(S * cross<T>(A.w_modes, A.w));
  load.moment += n;
  load.spin_momentum += h;
  const Vector in_body = transposed<T>(B.R) * (n - less_raised<T>(cross<T>(A.w - A.w_modes, h)));
  for (std::size_t i = 0; i < m.W.size(); ++i) load.modes[static_cast<Eigen::Index>(i)] += dot<T>(m.W[i], in_body);
}

template <class T>
void FirstOrderRecursion<T>::add_wrench(Load& load, const Frame& B, const Relative& m, const AppliedWrench<T>& wrench) {
  load.dead_force += wrench.force;
  load.dead_moment += Place::constant(wrench.moment) + cross<T>(Place(B.R * m.r), Place::constant(wrench.force));
  const Turn back = transposed<T>(B.R);
  const Vector force = back * Vector::constant(wrench.force), moment = back * Vector::constant(wrench.moment);
  for (std::size_t i = 0; i < m.P.size(); ++i)
    load.modes[static_cast<Eigen::Index>(i)] -= dot<T>(m.P[i], force) + dot<T>(m.W[i], moment);
}

template <class T>
void FirstOrderRecursion<T>::add_rows(VX& modes, const Frame& B, const Relative& m, const Frame& A, const Load& carried,
                                      double sign) {
  if (m.P.empty()) return;
  const Vector w = A.w - A.w_modes, v = A.v - A.v_modes;
  const Vector force =
      carried.force - less_raised<T>(cross<T>(w, carried.momentum)) - Vector::constant(carried.dead_force);
  const Vector moment = carried.moment -
                        less_raised<T>(cross<T>(w, carried.spin_momentum) + cross<T>(v, carried.momentum)) -
                        low<T>(carried.dead_moment);
  const Turn back = transposed<T>(B.R);
  const Vector f = back * force, n = back * moment;
  for (std::size_t i = 0; i < m.P.size(); ++i)
    modes[static_cast<Eigen::Index>(i)] += T(sign) * (dot<T>(m.P[i], f) + dot<T>(m.W[i], n));
}

template <class T>
typename FirstOrderRecursion<T>::Load FirstOrderRecursion<T>::about(Load load, const Place& arm) {
  const Vector near = low<T>(arm);
  load.moment += cross<T>(near, load.force);
  load.spin_momentum += cross<T>(near, load.momentum);
  load.dead_moment += cross<T>(arm, Place::constant(load.dead_force));
  return load;
}

template class FirstOrderRecursion<double>;
template class FirstOrderRecursion<Jet>;

}  // namespace withy::analysis
