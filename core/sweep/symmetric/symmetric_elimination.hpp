/// \file
/// The inward passes of a symmetric sweep over one node: (3) of symmetric_kernel.hpp, with q̈ and ẍ eliminated.
#pragma once

#include <algorithm>

#include "withy/core/sweep/block_rows.hpp"
#include "withy/core/sweep/straight_rows.hpp"
#include "withy/core/sweep/symmetric/straight_mass.hpp"
#include "withy/core/sweep/symmetric/symmetric_motion.hpp"
#include "withy/core/sweep/with_modes.hpp"

namespace withy::sweep {

/// What the body's own mass gives to (3) where it is not frozen: added to I and p, the rest in C, G, h.
template <class Space, int N, Flavor flavor>
inline void integrate_mass(const SymmetricNode<Space>& node, const SymmetricState<Space>& s,
                           const typename Space::Twist& V, typename Space::Inertia& I, typename Space::Twist& p,
                           typename Space::Twist* C, typename Space::Scalar* G, typename Space::Scalar* h) {
  using Scalar = typename Space::Scalar;
  const int n = count<N>(node.modes);
  if constexpr (flavor == Flavor::exact) {
    const auto& rod = *at<RodMass<Space>>(s.work, node.work_rod_mass);
    I += rod.I;
    p += rod.p;
    const auto* C_rod = at<typename Space::Twist>(s.work, node.work_C);
    const Scalar *G_rod = at<Scalar>(s.work, node.work_G), *h_rod = at<Scalar>(s.work, node.work_y);
    for (int i = 0; i < n; ++i) {
      C[i] = C_rod[i];
      h[i] = h_rod[i];
    }
    for (int i = 0; i < n * n; ++i) G[i] = G_rod[i];
  } else {
    const auto* q = s.positions + node.mode_position;
    const auto* q_dot = s.speeds + node.mode_speed;
    using Group = typename Space::Group;
    Group P_here[N > 0 ? N * Space::linear : 1];
    Group *const scratch = at<Group>(s.work, node.work_P), *const P = N > 0 ? P_here : scratch;
    const auto clear = [&] {
      for (int i = 0; i < n; ++i) {
        C[i] = Space::Twist::zero();
        h[i] = 0;
      }
      for (int i = 0; i < n * n; ++i) G[i] = 0;
    };
    const auto add_sections = [&](const typename Space::Twist& V_here, typename Space::Inertia& I_here,
                                  typename Space::Twist& p_here) {
      if constexpr (has_sections<Space>)
        collect_sections<Space, N>(node.own->rotary, n, q, q_dot, V_here, scratch, I_here, C, G, p_here, h);
    };
    const MassTable<Space>& mass = node.own->mass;
    const auto sum_particles = [&] {
      clear();
      integrate<Space, N>(mass, n, q, q_dot, V, P, I, C, G, p, h);
      add_sections(V, I, p);
    };
    if constexpr (has_block_rows<Space, N>) {
      // Passes that know no number of modes go over nodes of few as well.
      if (n <= modes_known) return sum_particles();
      clear();
      in_frame(mass.frame, n, V, I, C, p, [&](const auto& V_here, auto& I_here, auto& p_here) {
        if constexpr (has_straight_rows<Space>) {
          if (!mass.along.empty()) integrate_straight_rows(mass, q, q_dot, V_here, scratch, I_here, C, G, p_here, h);
        }
        if (!mass.blocks.empty()) integrate_block_rows(mass, q, q_dot, V_here, scratch, I_here, C, G, p_here, h);
        add_sections(V_here, I_here, p_here);
      });
    } else if constexpr (has_straight_mass<Space, N>) {
      if (!mass.straight) return sum_particles();
      integrate_straight<Space, N>(mass.products.data(), q, q_dot, V, I, C, G, p, h);
      add_sections(V, I, p);
    } else {
      sum_particles();
    }
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
  const auto* frames = at<typename Space::Frame>(s.work, node.work_frames);
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
    for (int i = 0; i < n; ++i) y[i] = -0.5 * dot(node.own->I1[static_cast<std::size_t>(i)], square);
    constant = is_constant(node, s);
    if (!constant) {
      for (int i = 0; i < n; ++i) C[i] = node.own->C0[static_cast<std::size_t>(i)];
      for (int i = 0; i < n * n; ++i) G[i] = node.own->G0[static_cast<std::size_t>(i)];
      for (std::size_t k = 0; k < node.own->stations.size(); ++k) {
        const auto& station = node.own->stations[k];
        if (!station.has_children) continue;
        const auto& IS = *at<typename Space::Inertia>(s.work, station.work_I);
        collect_frozen_station<Space, N>(stations[k], IS, station, n, I, p, C, G, y);
      }
    }
  } else {
    integrate_mass<Space, N, flavor>(node, s, V, I, p, C, G, y);
    Twist* J = at<Twist>(s.work, node.work_J);
    for (std::size_t k = 0; k < node.own->stations.size(); ++k) {
      const auto& station = node.own->stations[k];
      if (!station.loaded) continue;
      typename Space::Inertia IS = station.carried->inertia;
      if (station.has_children) IS += *at<typename Space::Inertia>(s.work, station.work_I);
      collect_station<Space, N>(stations[k], frames[k], IS, J + static_cast<int>(k) * n, n, I, p, C, G, y);
    }
    if (node.root_station >= 0) [[unlikely]] {
      const auto& root = *at<RootWork<Space>>(s.work, node.work_root);
      const Twist* JM = J + n * static_cast<int>(node.own->stations.size());
      if constexpr (N > 0) {
        // Copies: what a call that is not inlined takes the address of would be in memory all along.
        struct {
          typename Space::Inertia I;
          Twist p, C[N];
          Scalar G[N * N], y[N];
        } moved;
        moved.I = I, moved.p = p;
        std::copy_n(C, N, moved.C), std::copy_n(G, N * N, moved.G), std::copy_n(y, N, moved.y);
        move_to_root<Space>(root.frame, root.sigma, n, JM, moved.I, moved.p, moved.C, moved.G, moved.y);
        I = moved.I, p = moved.p;
        std::copy_n(moved.C, N, C), std::copy_n(moved.G, N * N, G), std::copy_n(moved.y, N, y);
      } else {
        move_to_root<Space>(root.frame, root.sigma, n, JM, I, p, C, G, y);
      }
    }
  }
  // q̈ = G⁻¹ (−K q − D q̇ − h − Cᵀ A), with G = L Δ Lᵀ, Y = L⁻¹ Cᵀ, y = L⁻¹ (…).
  for (int i = 0; i < n; ++i) {
    Scalar e = s.efforts[node.mode_speed + static_cast<std::size_t>(i)] - y[i];
    for (int j = 0; j < n; ++j) {
      e -= node.own->stiffness[static_cast<std::size_t>(i * n + j)] * q[j] +
           node.own->damping[static_cast<std::size_t>(i * n + j)] * q_dot[j];
    }
    y[i] = e;
  }
  Scalar* y_kept = at<Scalar>(s.work, node.work_y);
  if (constant) {
    const Scalar* L = node.own->factor.data();
    solve_lower<N>(L, n, y);
    for (int i = 0; i < n; ++i) p += node.own->Y0[static_cast<std::size_t>(i)] * (L[i * n + i] * y[i]);
    for (int i = 0; i < n; ++i) y_kept[i] = y[i];
    return everywhere<Scalar>();
  }
  if (s.delta > 0) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j) {
        const auto ij = static_cast<std::size_t>(i * n + j);
        G[ij] += s.delta * (node.own->damping[ij] + s.delta * node.own->stiffness[ij]);
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
  e.L[0] += joint.reflected;  // 0 of several rates
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
    p += I * w.A;
  } else if (single(joint.kind)) {
    const bool turns = joint.kind == Joint::rotate;
    const Twist U = turns ? I.turn_column() : I.slide_column();
    const Scalar inertia = (turns ? U.turn() : U.slide()) + joint.reflected;
    good = positive(inertia);
    if (none(good)) return good;
    const Scalar inverse = 1 / inertia;
    const Scalar u = joint.direction * s.efforts[joint.speed] - (turns ? p.turn() : p.slide());
    w.p_or_U = U;
    w.inverse = inverse;
    w.u = u;
    if (node.parent < 0) return good;
    I.subtract_square(U, inverse);
    p += I * w.A + U * (inverse * u);
  } else if (joint.kind == Joint::fixed) {
    if (node.parent < 0) return good;
    p += I * w.A;
  } else if constexpr (has_general_hinges<Space>) {
    good = eliminate_joint(joint, s, *at<JointElimination<Space>>(s.work, node.work_elimination), I, p);
    if (!good) return good;
    if (node.parent < 0) return good;
    p += I * w.A;
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
  typename Space::Inertia I = constant ? *node.own->reduced : node.own->base->inertia;
  if (node.has_children) I += *at<typename Space::Inertia>(s.work, node.work_I);
  Twist p = constant ? node.own->base->velocity_wrench(w.V) : w.p_or_U;
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
/// factors already in the work memory. What gathers at stations and nodes begins with 0.
template <class Space, int N, Flavor flavor>
inline void inward_force(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  Twist p = w.V;
  if constexpr (flavor != Flavor::rigid) {
    const auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    const auto* frames = at<typename Space::Frame>(s.work, node.work_frames);
    const Twist* J = at<Twist>(s.work, node.work_J);
    double* y = at<double>(s.work, node.work_y);
    const double* force = s.efforts + node.mode_speed;
    for (int i = 0; i < n; ++i) y[i] = force[i];
    for (std::size_t k = 0; k < node.own->stations.size(); ++k) {
      const auto& station = node.own->stations[k];
      if (!station.has_children) continue;
      const Twist& carried = stations[k].V;
      const Twist* partial = flavor == Flavor::frozen ? station.J.data() : J + static_cast<int>(k) * n;
      p += flavor == Flavor::frozen ? Space::shift_to_parent(station.fields.X, carried)
                                    : Space::to_parent(frames[k], carried);
      for (int i = 0; i < n; ++i) y[i] -= Space::dot(partial[i], carried);
    }
    if (flavor != Flavor::frozen && node.root_station >= 0) {
      p = Space::to_parent(Space::inverse(at<RootWork<Space>>(s.work, node.work_root)->frame), p);
      const Twist* JM = J + n * static_cast<int>(node.own->stations.size());
      for (int i = 0; i < n; ++i) y[i] += Space::dot(JM[i], p);
    }
    const bool constant = flavor == Flavor::frozen && is_constant(node, s);
    const double* L = constant ? node.own->factor.data() : at<double>(s.work, node.work_G);
    const Twist* Y = constant ? node.own->Y0.data() : at<Twist>(s.work, node.work_C);
    solve_lower<N>(L, n, y);
    for (int i = 0; i < n; ++i) p += Y[i] * (L[i * n + i] * y[i]);
  }
  const JointData<Space>& joint = node.joint;
  if (joint.driven) [[unlikely]] {
    // The force passes on whole.
  } else if (single(joint.kind)) {
    w.u = joint.direction * s.efforts[joint.speed] - component<Space>(joint.kind, p);
    p += w.p_or_U * (w.inverse * w.u);
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
  *Outer(node, s).V += Space::to_parent(w.SM, p);
}

}  // namespace withy::sweep
