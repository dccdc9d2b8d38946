/// \file
/// The three passes of the symmetric sweep over one node; see symmetric_sweep.hpp.
///
/// At a node, with V, A its frame's twist and acceleration, F the wrench the hinge passes to it, u̇ = (ẍ, q̈):
///   (1) V_M = X V_S + H ẋ,              A_M = X A_S + H ẍ + σ,   σ = V_M × H ẋ + Ḣ ẋ
///   (2) V_S = X V_B + J q̇,              A_S = X A_B + J q̈ + σ_S, σ_S = V_S × J q̇ + J̇ q̇      (station S of body B)
///   (3) F = I A + C q̈ + p,              −K q − D q̇ = Cᵀ A + G q̈ + h
/// Children and carried bodies enter (3) through their stations; then q̈, then ẍ are eliminated.
#pragma once

#include "withy/core/sweep/rod/rod_terms.hpp"
#include "withy/core/sweep/symmetric/symmetric_terms.hpp"

namespace withy::sweep {

/// Constant elimination of a frozen leaf's modes.
template <class Space>
void precompute(SymmetricNode<Space>& node) {
  node.factor.assign(node.G0.begin(), node.G0.end());
  node.Y0.assign(node.C0.begin(), node.C0.end());
  if (!factorize<-1>(node.factor.data(), node.modes)) {
    node.factor.clear();  // the sweep meets the same pivot and reports it
    return;
  }
  solve_lower<-1>(node.factor.data(), node.modes, node.Y0.data());
  typename Space::Inertia reduced = node.base->inertia;
  for (std::size_t i = 0, n = node.Y0.size(); i < n; ++i) reduced.subtract_square(node.Y0[i], node.factor[i * n + i]);
  node.reduced = reduced;
}

/// Motion of a station's section in a node that is not truncated; see station_motion.
template <class Space, int N, Flavor flavor>
inline void section_motion(const SymmetricNode<Space>& node, std::size_t station, const SymmetricState<Space>& s,
                           StationMotion<Space>& out, typename Space::Twist* J) {
  const auto* q = s.positions + node.mode_position;
  const auto* q_dot = s.speeds + node.mode_speed;
  if constexpr (flavor == Flavor::exact) {
    const RodWork work = rod_work_at(*node.rod, node.modes, at<Pack>(s.work, node.work_rod));
    rod_station_motion<N>(*node.rod, station, work, node.modes, q, q_dot, out, J);
  } else {
    station_motion<Space, N>(node.stations[station].fields, node.modes, q, q_dot, out, J);
  }
}

/// The root section of a body whose modes move it: V_M = X V_B + J q̇, solved for V_B. Apart, for any number of modes.
template <class Space, Flavor flavor>
[[gnu::noinline, gnu::flatten]] void root_motion(const SymmetricNode<Space>& node, const SymmetricState<Space>& s,
                                                 typename Space::Twist& V) {
  using Twist = typename Space::Twist;
  const int n = node.modes;
  StationMotion<Space> m;
  Twist* JM = at<Twist>(s.work, node.work_J) + n * static_cast<int>(node.stations.size());
  section_motion<Space, -1, flavor>(node, static_cast<std::size_t>(node.root_station), s, m, JM);
  const Twist rate = Space::to_child(*node.M, m.rate);
  auto& root = *at<RootWork<Space>>(s.work, node.work_root);
  root.frame = Space::compose(m.frame, *node.M);
  root.sigma = Space::cross(V, rate) + Space::to_child(*node.M, m.bias);
  for (int i = 0; i < n; ++i) JM[i] = Space::to_child(*node.M, JM[i]);
  V = Space::from_child(root.frame, V - rate);
}

template <class Space, int N, Flavor flavor>
[[gnu::flatten]] inline void outward_motion(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  JointMotion<Space> joint;
  joint_motion<Space>(node.joint, s.positions + node.joint.position, s.speeds + node.joint.speed, joint);
  Twist V = joint.rate;
  w.SM = joint.SM;
  if (node.parent >= 0) V += Space::to_child(joint.SM, *Outer(node, s).V);
  w.sigma = node.parent >= 0 ? cross_rate<Space>(node.joint.kind, V, joint.rate) : Twist::zero();
  if (has_bias(node.joint.kind)) w.sigma += joint.bias;
  if (node.joint.driven && s.driven != nullptr) [[unlikely]]
    w.sigma += driven_acceleration<Space>(node.joint, s.positions + node.joint.position, s.speeds + node.joint.speed,
                                          s.result + node.joint.speed);

  if constexpr (flavor == Flavor::frozen) {
    auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      const auto& station = node.stations[k];
      if (!station.has_children) continue;
      stations[k].V = Space::shift_to_child(station.fields.X, V);
    }
  }
  if constexpr (flavor == Flavor::exact) {
    rod_motion<N>(*node.rod, n, s.positions + node.mode_position, s.speeds + node.mode_speed,
                  rod_work_at(*node.rod, n, at<Pack>(s.work, node.work_rod)));
  }
  if constexpr (flavor == Flavor::full || flavor == Flavor::exact) {
    auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    Twist* J = at<Twist>(s.work, node.work_J);
    if (node.root_station >= 0) root_motion<Space, flavor>(node, s, V);
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      const auto& station = node.stations[k];
      if (!station.loaded) continue;
      StationWork<Space>& sw = stations[k];
      StationMotion<Space> m;
      section_motion<Space, N, flavor>(node, k, s, m, J + static_cast<int>(k) * n);
      const Twist VS = Space::to_child(m.frame, V) + m.rate;
      sw.frame = m.frame;
      sw.V = VS;
      sw.sigma = Space::cross(VS, m.rate) + m.bias;
      sw.p = station.carried->velocity_wrench(VS);
    }
  }
  w.V = V;
  if (flavor == Flavor::frozen && is_constant(node, s)) return;  // nothing is added to what it has precomputed
  w.p = node.base->velocity_wrench(V);
}

/// Adds the integrals over a body's own mass to (3) where it is not frozen.
template <class Space, int N, Flavor flavor>
inline void integrate_mass(const SymmetricNode<Space>& node, const SymmetricState<Space>& s,
                           const typename Space::Twist& V, typename Space::Inertia& I, typename Space::Twist& p,
                           typename Space::Twist* C, typename Space::Scalar* G, typename Space::Scalar* h) {
  const int n = count<N>(node.modes);
  const auto* q = s.positions + node.mode_position;
  const auto* q_dot = s.speeds + node.mode_speed;
  using Group = typename Space::Group;
  Group P_here[N > 0 ? N * Space::linear : 1];
  Group* P = N > 0 ? P_here : at<Group>(s.work, node.work_P);
  if constexpr (flavor == Flavor::exact) {
    const RodWork rod = rod_work_at(*node.rod, n, at<Pack>(s.work, node.work_rod));
    integrate<N>(*node.rod, rod, n, q_dot, V, P, I, C, G, p, h);
  } else {
    integrate<Space, N>(node.mass, n, q, q_dot, V, P, I, C, G, p, h);
    if constexpr (has_sections<Space>) collect_sections<Space, N>(node.rotary, n, q, q_dot, V, P, I, C, G, p, h);
  }
}

/// Elimination of q̈: leaves Y, y, L in the work memory and adds to I, p; whether G is positive definite.
template <class Space, int N, Flavor flavor>
inline auto eliminate_modes(const SymmetricNode<Space>& node, const SymmetricState<Space>& s,
                            const typename Space::Twist& V, typename Space::Inertia& I, typename Space::Twist& p) {
  using Twist = typename Space::Twist;
  using Scalar = typename Space::Scalar;
  const int n = count<N>(node.modes);
  const auto* q = s.positions + node.mode_position;
  const auto* q_dot = s.speeds + node.mode_speed;
  const auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
  // On the stack where the compiler knows their size: it then keeps them in registers.
  constexpr int size = N > 0 ? N : 1;
  Twist C_here[size];
  Scalar G_here[size * size], y_here[size];
  Twist* C = N > 0 ? C_here : at<Twist>(s.work, node.work_C);
  Scalar* G = N > 0 ? G_here : at<Scalar>(s.work, node.work_G);
  Scalar* y = N > 0 ? y_here : at<Scalar>(s.work, node.work_y);
  bool constant = false;
  if constexpr (flavor == Flavor::frozen) {
    const auto square = Variation<Space>::bilinear(V, V);
    for (int i = 0; i < n; ++i) y[i] = -0.5 * dot(node.I1[static_cast<std::size_t>(i)], square);
    constant = is_constant(node, s);
    if (!constant) {
      for (int i = 0; i < n; ++i) C[i] = node.C0[static_cast<std::size_t>(i)];
      for (int i = 0; i < n * n; ++i) G[i] = node.G0[static_cast<std::size_t>(i)];
      for (std::size_t k = 0; k < node.stations.size(); ++k) {
        const auto& station = node.stations[k];
        if (!station.has_children) continue;
        const auto& IS = *at<typename Space::Inertia>(s.work, station.work_I);
        collect_frozen_station<Space, N>(stations[k], IS, station, n, I, p, C, G, y);
      }
    }
  } else {
    for (int i = 0; i < n; ++i) {
      C[i] = Twist::zero();
      y[i] = 0;
    }
    for (int i = 0; i < n * n; ++i) G[i] = 0;
    integrate_mass<Space, N, flavor>(node, s, V, I, p, C, G, y);
    Twist* J = at<Twist>(s.work, node.work_J);
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      const auto& station = node.stations[k];
      if (!station.loaded) continue;
      typename Space::Inertia IS = station.carried->inertia;
      if (station.has_children) IS += *at<typename Space::Inertia>(s.work, station.work_I);
      collect_station<Space, N>(stations[k], IS, J + static_cast<int>(k) * n, n, I, p, C, G, y);
    }
    if (node.root_station >= 0) {
      const auto& root = *at<RootWork<Space>>(s.work, node.work_root);
      move_to_root<Space>(root.frame, root.sigma, n, J + n * static_cast<int>(node.stations.size()), I, p, C, G, y);
    }
  }
  // q̈ = G⁻¹ (−K q − D q̇ − h − Cᵀ A), with G = L Δ Lᵀ, Y = L⁻¹ Cᵀ, y = L⁻¹ (…).
  for (int i = 0; i < n; ++i) {
    Scalar e = s.efforts[node.mode_speed + static_cast<std::size_t>(i)] - y[i];
    for (int j = 0; j < n; ++j) {
      e -= node.stiffness[static_cast<std::size_t>(i * n + j)] * q[j] +
           node.damping[static_cast<std::size_t>(i * n + j)] * q_dot[j];
    }
    y[i] = e;
  }
  Scalar* y_kept = at<Scalar>(s.work, node.work_y);
  if (constant) {
    const Scalar* L = node.factor.data();
    solve_lower<N>(L, n, y);
    for (int i = 0; i < n; ++i) p += node.Y0[static_cast<std::size_t>(i)] * (L[i * n + i] * y[i]);
    for (int i = 0; i < n; ++i) y_kept[i] = y[i];
    return everywhere<Scalar>();
  }
  if (s.delta > 0) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j) {
        const auto ij = static_cast<std::size_t>(i * n + j);
        G[ij] += s.delta * (node.damping[ij] + s.delta * node.stiffness[ij]);
      }
    }
  }
  const auto good = factorize<N>(G, n);
  if (none(good)) return good;
  solve_lower<N>(G, n, C);
  solve_lower<N>(G, n, y);
  for (int i = 0; i < n; ++i) {
    I.subtract_square(C[i], G[i * n + i]);
    p += C[i] * (G[i * n + i] * y[i]);
  }
  if constexpr (N > 0) {
    Twist* C_kept = at<Twist>(s.work, node.work_C);
    Scalar* G_kept = at<Scalar>(s.work, node.work_G);
    for (int i = 0; i < n; ++i) {
      C_kept[i] = C[i];
      y_kept[i] = y[i];
      for (int j = 0; j <= i; ++j) G_kept[i * n + j] = G[i * n + j];
    }
  }
  return good;
}

/// Elimination of ẍ of a hinge with several rates; Y, y, L stay in the work memory.
[[gnu::noinline]] inline bool eliminate_joint(const JointData<Spatial>& joint, const SymmetricState<Spatial>& s,
                                              JointElimination<Spatial>& e, Spatial::Inertia& I, Spatial::Twist& p) {
  const auto k = static_cast<int>(joint.speeds);
  const HingeMotion motion = general_motion(joint, s.positions + joint.position, s.speeds + joint.speed);
  for (int i = 0; i < k; ++i) {
    e.H[i] = Spatial::Twist::of(motion.H.col(i));
    e.Y[i] = I * e.H[i];
    e.y[i] = s.efforts[joint.speed + static_cast<std::size_t>(i)] - Spatial::dot(e.H[i], p);
    for (int j = 0; j <= i; ++j) e.L[i * k + j] = Spatial::dot(e.Y[i], e.H[j]);
  }
  if (!factorize<-1>(e.L, k)) return false;
  solve_lower<-1>(e.L, k, e.Y);
  solve_lower<-1>(e.L, k, e.y);
  for (int i = 0; i < k; ++i) {
    I.subtract_square(e.Y[i], e.L[i * k + i]);
    p += e.Y[i] * (e.L[i * k + i] * e.y[i]);
  }
  return true;
}

/// Elimination of ẍ, and what the hinge passes to the parent's station: inertia I, wrench p at zero A'. Whether the
/// articulated inertia along the hinge is positive.
template <class Space>
inline auto pass_inward(const SymmetricNode<Space>& node, const SymmetricState<Space>& s, NodeWork<Space>& w,
                        typename Space::Inertia& I, typename Space::Twist& p) {
  using Twist = typename Space::Twist;
  using Scalar = typename Space::Scalar;
  auto good = everywhere<Scalar>();
  const JointData<Space>& joint = node.joint;
  if (joint.driven) [[unlikely]] {  // passes on everything
    *at<DrivenWork<Space>>(s.work, node.work_driven) = {I, p};
    if (node.parent < 0) return good;
    p += I * w.sigma;
  } else if (single(joint.kind)) {
    const bool turns = joint.kind == Joint::rotate;
    const Twist U = turns ? I.turn_column() : I.slide_column();
    const Scalar inertia = turns ? U.turn() : U.slide();
    good = positive(inertia);
    if (none(good)) return good;
    const Scalar inverse = 1 / inertia;
    const Scalar u = joint.direction * s.efforts[joint.speed] - (turns ? p.turn() : p.slide());
    w.U = U;
    w.inverse = inverse;
    w.u = u;
    if (node.parent < 0) return good;
    I.subtract_square(U, inverse);
    p += I * w.sigma + U * (inverse * u);
  } else if (joint.kind == Joint::fixed) {
    if (node.parent < 0) return good;
    p += I * w.sigma;
  } else if constexpr (has_general_hinges<Space>) {
    good = eliminate_joint(joint, s, *at<JointElimination<Space>>(s.work, node.work_elimination), I, p);
    if (!good) return good;
    if (node.parent < 0) return good;
    p += I * w.sigma;
  }
  auto& outer_I = *at<typename Space::Inertia>(s.work, node.work_outer_I);
  if (node.begins) {
    outer_I = Space::to_parent(w.SM, I);
  } else {
    outer_I += Space::to_parent(w.SM, I);
  }
  Twist& outer_p = *Outer(node, s).p;
  if (node.begins_frozen) {
    outer_p = Space::to_parent(w.SM, p);
  } else {
    outer_p += Space::to_parent(w.SM, p);
  }
  return good;
}

/// The same where modes were eliminated before, which takes longer than the call: one instance for any number of them.
template <class Space>
[[gnu::noinline, gnu::flatten]] auto pass_inward_apart(const SymmetricNode<Space>& node, const SymmetricState<Space>& s,
                                                       NodeWork<Space>& w, typename Space::Inertia& I,
                                                       typename Space::Twist& p) {
  return pass_inward<Space>(node, s, w, I, p);
}

template <class Space, int N, Flavor flavor>
[[gnu::flatten]] inline auto inward_inertia(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  const bool constant = flavor == Flavor::frozen && is_constant(node, s);
  typename Space::Inertia I = constant ? *node.reduced : node.base->inertia;
  if (node.has_children) I += *at<typename Space::Inertia>(s.work, node.work_I);
  Twist p = constant ? node.base->velocity_wrench(w.V) : w.p;
  auto good = everywhere<typename Space::Scalar>();
  if constexpr (flavor != Flavor::rigid) {
    good = eliminate_modes<Space, N, flavor>(node, s, w.V, I, p);
    if (none(good)) return good;
  }
  if constexpr (flavor != Flavor::rigid && Space::angular == 3) {
    good = good & pass_inward_apart(node, s, w, I, p);
  } else {
    good = good & pass_inward<Space>(node, s, w, I, p);
  }
  return good;
}

/// What the inward pass has left for `forces` at rest: generalized forces alone, one for each speed, against the
/// factors already in the work memory. Stations and nodes begin with p = 0.
template <class Space, int N, Flavor flavor>
inline void inward_force(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  Twist p = w.p;
  if constexpr (flavor != Flavor::rigid) {
    const auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    const Twist* J = at<Twist>(s.work, node.work_J);
    double* y = at<double>(s.work, node.work_y);
    const double* force = s.efforts + node.mode_speed;
    for (int i = 0; i < n; ++i) y[i] = force[i];
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      const auto& station = node.stations[k];
      if (!station.has_children) continue;
      const Twist& carried = stations[k].p;
      const Twist* partial = flavor == Flavor::frozen ? station.J.data() : J + static_cast<int>(k) * n;
      p += flavor == Flavor::frozen ? Space::shift_to_parent(station.fields.X, carried)
                                    : Space::to_parent(stations[k].frame, carried);
      for (int i = 0; i < n; ++i) y[i] -= Space::dot(partial[i], carried);
    }
    if (flavor != Flavor::frozen && node.root_station >= 0) {
      p = Space::to_parent(Space::inverse(at<RootWork<Space>>(s.work, node.work_root)->frame), p);
      const Twist* JM = J + n * static_cast<int>(node.stations.size());
      for (int i = 0; i < n; ++i) y[i] += Space::dot(JM[i], p);
    }
    const bool constant = flavor == Flavor::frozen && is_constant(node, s);
    const double* L = constant ? node.factor.data() : at<double>(s.work, node.work_G);
    const Twist* Y = constant ? node.Y0.data() : at<Twist>(s.work, node.work_C);
    solve_lower<N>(L, n, y);
    for (int i = 0; i < n; ++i) p += Y[i] * (L[i * n + i] * y[i]);
  }
  const JointData<Space>& joint = node.joint;
  if (joint.driven) [[unlikely]] {
    // The force passes on whole.
  } else if (single(joint.kind)) {
    w.u = joint.direction * s.efforts[joint.speed] - component<Space>(joint.kind, p);
    p += w.U * (w.inverse * w.u);
  } else if constexpr (Space::angular == 3) {
    if (joint.kind != Joint::fixed) {
      auto& e = *at<JointElimination<Space>>(s.work, node.work_elimination);
      const auto k = static_cast<int>(joint.speeds);
      for (int i = 0; i < k; ++i) e.y[i] = s.efforts[joint.speed + static_cast<std::size_t>(i)] - Space::dot(e.H[i], p);
      solve_lower<-1>(e.L, k, e.y);
      for (int i = 0; i < k; ++i) p += e.Y[i] * (e.L[i * k + i] * e.y[i]);
    }
  }
  if (node.parent < 0) return;
  *Outer(node, s).p += Space::to_parent(w.SM, p);
}

template <class Space, int N, Flavor flavor>
[[gnu::flatten]] inline void outward_acceleration(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  using Scalar = typename Space::Scalar;
  const int n = count<N>(node.modes);
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  const JointData<Space>& joint = node.joint;
  const Twist& outer = node.parent < 0 ? *s.world : *Outer(node, s).A;
  Twist A = w.sigma;
  if (joint.pose_matters) A += Space::to_child(w.SM, outer);
  if (joint.driven) [[unlikely]] {
    if (s.driven != nullptr) {
      const auto& asked = *at<DrivenWork<Space>>(s.work, node.work_driven);
      driven_efforts<Space>(joint, s.positions + joint.position, s.speeds + joint.speed, asked.I * A + asked.p,
                            s.driven + joint.speed);
    } else {
      for (std::size_t i = 0; i < joint.speeds; ++i) s.result[joint.speed + i] = 0;
    }
  } else if (single(joint.kind)) {
    const auto x = (w.u - Space::dot(w.U, A)) * w.inverse;
    A += along<Space>(joint.kind, x);
    s.result[joint.speed] = joint.direction * x;
  } else if constexpr (has_general_hinges<Space>) {
    if (joint.kind != Joint::fixed) {
      const auto& e = *at<JointElimination<Space>>(s.work, node.work_elimination);
      Scalar* x = s.result + joint.speed;
      back_substitute<-1, Space>(e.L, e.Y, e.y, static_cast<int>(joint.speeds), A, x);
      for (std::size_t i = 0; i < joint.speeds; ++i) A += e.H[i] * x[i];
    }
  }
  if constexpr (flavor == Flavor::rigid) {
    w.A = A;
    return;
  } else {
    const bool constant = flavor == Flavor::frozen && is_constant(node, s);
    const Scalar* L = constant ? node.factor.data() : at<Scalar>(s.work, node.work_G);
    const Twist* Y = constant ? node.Y0.data() : at<Twist>(s.work, node.work_C);
    Scalar* a = s.result + node.mode_speed;
    back_substitute<N, Space>(L, Y, at<Scalar>(s.work, node.work_y), n, A, a);
    auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    if constexpr (flavor == Flavor::frozen) {
      w.A = A;
      for (std::size_t k = 0; k < node.stations.size(); ++k) {
        const auto& station = node.stations[k];
        if (!station.has_children) continue;
        Twist AS = Space::shift_to_child(station.fields.X, A);
        for (int i = 0; i < n; ++i) AS += station.J[static_cast<std::size_t>(i)] * a[i];
        stations[k].A = AS;
      }
    } else {
      const Twist* J = at<Twist>(s.work, node.work_J);
      if (node.root_station >= 0) {
        const Twist* JM = J + n * static_cast<int>(node.stations.size());
        const auto& root = *at<RootWork<Space>>(s.work, node.work_root);
        A -= root.sigma;
        for (int i = 0; i < n; ++i) A -= JM[i] * a[i];
        A = Space::from_child(root.frame, A);
      }
      w.A = A;
      for (std::size_t k = 0; k < node.stations.size(); ++k) {
        if (!node.stations[k].has_children) continue;
        Twist AS = Space::to_child(stations[k].frame, A) + stations[k].sigma;
        for (int i = 0; i < n; ++i) AS += J[static_cast<int>(k) * n + i] * a[i];
        stations[k].A = AS;
      }
    }
  }
}

}  // namespace withy::sweep
