/// \file
/// The outward pass of motion in a symmetric sweep over one node: (1) and (2) of symmetric_kernel.hpp without
/// accelerations.
#pragma once

#include "withy/core/sweep/rod/rod_terms.hpp"
#include "withy/core/sweep/symmetric/symmetric_terms.hpp"

namespace withy::sweep {

/// Constant elimination of a frozen leaf's modes.
template <class Space>
void precompute(SymmetricNode<Space>& node) {
  node.own.edit([&](SymmetricBody<Space>& body) {
    body.factor.assign(body.G0.begin(), body.G0.end());
    body.Y0.assign(body.C0.begin(), body.C0.end());
    if (!factorize<-1>(body.factor.data(), node.modes)) {
      body.factor.clear();  // the sweep meets the same pivot and reports it
      return;
    }
    solve_lower<-1>(body.factor.data(), node.modes, body.Y0.data());
    typename Space::Inertia reduced = body.base->inertia;
    for (std::size_t i = 0, n = body.Y0.size(); i < n; ++i) reduced.subtract_square(body.Y0[i], body.factor[i * n + i]);
    body.reduced = reduced;
  });
}

/// Motion of a station's section in a node that is not truncated; see station_motion.
template <class Space, int N, Flavor flavor>
inline void section_motion(const SymmetricNode<Space>& node, std::size_t station, const SymmetricState<Space>& s,
                           StationMotion<Space>& out, typename Space::Twist* J) {
  const auto* q = s.positions + node.mode_position;
  const auto* q_dot = s.speeds + node.mode_speed;
  if constexpr (flavor == Flavor::exact) {
    const RodWork work = rod_work_at(*node.own->rod, node.modes, at<Pack>(s.work, node.work_rod));
    rod_station_motion<N>(*node.own->rod, station, work, node.modes, q, q_dot, out, J);
  } else {
    station_motion<Space, N>(node.own->stations[station].fields, node.modes, q, q_dot, out, J);
  }
}

/// The root section of a body whose modes move it: V_M = X V_B + J q̇, solved for V_B. Apart, for any number of modes.
template <class Space, Flavor flavor>
[[gnu::noinline, gnu::flatten]] void root_motion(const SymmetricNode<Space>& node, const SymmetricState<Space>& s,
                                                 typename Space::Twist& V) {
  using Twist = typename Space::Twist;
  const int n = node.modes;
  StationMotion<Space> m;
  Twist* JM = at<Twist>(s.work, node.work_J) + n * static_cast<int>(node.own->stations.size());
  section_motion<Space, -1, flavor>(node, static_cast<std::size_t>(node.root_station), s, m, JM);
  const Twist rate = Space::to_child(*node.own->M, m.rate);
  auto& root = *at<RootWork<Space>>(s.work, node.work_root);
  root.frame = Space::compose(m.frame, *node.own->M);
  root.sigma = Space::cross(V, rate) + Space::to_child(*node.own->M, m.bias);
  for (int i = 0; i < n; ++i) JM[i] = Space::to_child(*node.own->M, JM[i]);
  V = Space::from_child(root.frame, V - rate);
}

/// Leaves in the work memory what a rod's mass gives to (3), from the motion of its sections.
template <class Space, int N>
inline void integrate_rod(const SymmetricNode<Space>& node, const SymmetricState<Space>& s,
                          const typename Space::Twist& V) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  Twist* const C = at<Twist>(s.work, node.work_C);
  double *const G = at<double>(s.work, node.work_G), *const h = at<double>(s.work, node.work_y);
  for (int i = 0; i < n; ++i) {
    C[i] = Twist::zero();
    h[i] = 0;
  }
  for (int i = 0; i < n * n; ++i) G[i] = 0;
  auto I = Space::Inertia::zero();
  Twist p = Twist::zero();
  integrate<Space, N>(*node.own->rod, rod_work_at(*node.own->rod, n, at<Pack>(s.work, node.work_rod)), n,
                      s.speeds + node.mode_speed, V, at<Pack>(s.work, node.work_P), I, C, G, p, h);
  *at<RodMass<Space>>(s.work, node.work_rod_mass) = {I, p};
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
  w.A = node.parent >= 0 ? cross_rate<Space>(node.joint.kind, V, joint.rate) : Twist::zero();
  if (has_bias(node.joint.kind)) w.A += joint.bias;
  if (node.joint.driven && s.driven != nullptr) [[unlikely]]
    w.A += driven_acceleration<Space>(node.joint, s.positions + node.joint.position, s.speeds + node.joint.speed,
                                      s.result + node.joint.speed);

  if constexpr (flavor == Flavor::frozen) {
    auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    for (std::size_t k = 0; k < node.own->stations.size(); ++k) {
      const auto& station = node.own->stations[k];
      if (!station.has_children) continue;
      stations[k].V = Space::shift_to_child(station.fields.X, V);
    }
  }
  if constexpr (flavor == Flavor::exact) {
    rod_motion<N>(*node.own->rod, n, s.positions + node.mode_position, s.speeds + node.mode_speed,
                  rod_work_at(*node.own->rod, n, at<Pack>(s.work, node.work_rod)));
  }
  if constexpr (flavor == Flavor::full || flavor == Flavor::exact) {
    auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    auto* frames = at<typename Space::Frame>(s.work, node.work_frames);
    Twist* J = at<Twist>(s.work, node.work_J);
    if (node.root_station >= 0) root_motion<Space, flavor>(node, s, V);
    for (std::size_t k = 0; k < node.own->stations.size(); ++k) {
      const auto& station = node.own->stations[k];
      if (!station.loaded) continue;
      StationWork<Space>& sw = stations[k];
      StationMotion<Space> m;
      section_motion<Space, N, flavor>(node, k, s, m, J + static_cast<int>(k) * n);
      const Twist VS = Space::to_child(m.frame, V) + m.rate;
      frames[k] = m.frame;
      sw.V = VS;
      sw.A = Space::cross(VS, m.rate) + m.bias;
      sw.p = station.carried->velocity_wrench(VS);
    }
  }
  w.V = V;
  if constexpr (flavor == Flavor::exact) integrate_rod<Space, N>(node, s, V);
  if (flavor == Flavor::frozen && is_constant(node, s)) return;  // nothing is added to what it has precomputed
  w.p_or_U = node.own->base->velocity_wrench(V);
}

}  // namespace withy::sweep
