/// \file
/// Inverse dynamics over the nodes of a strict sweep: the relations of strict_sweep.hpp with ẍ, q̈ given.
#pragma once

#include "withy/core/sweep/strict/strict_kernel.hpp"

namespace withy::sweep {

/// Accelerations of a node and its stations where all rates' are given (`result` of the state holds them).
template <class Space>
inline void given_acceleration(const StrictNode<Space>& node, const StrictState<Space>& s) {
  auto& w = *at<StrictNodeWork<Space>>(s.work, node.work);
  take_outer_acceleration(node, s, w);
  const JointData<Space>& joint = node.joint;
  // σ̄ and σ0 of a driven hinge have H ẍ already.
  if (joint.kind != Joint::fixed && !joint.driven) {
    const auto rate =
        driven_acceleration<Space>(joint, s.positions + joint.position, s.speeds + joint.speed, s.result + joint.speed);
    w.A += rate;
    w.A0 += rate;
  }
  station_accelerations<Space, -1>(node, s, w);
}

/// F̄_S and F0_S of a station's subtree on the body and on its modes.
template <class Space>
inline void add_station_forces(const StrictNode<Space>& node, const StrictStation<Space>& station,
                               const StrictStationWork<Space>& sw, const double* q, Response<Space>& r,
                               double* efforts) {
  const auto n = static_cast<std::size_t>(node.modes);
  const typename Space::Twist &F = sw.response.p, &F0 = sw.response.p0;
  r.p += Space::shift_to_parent(station.X, F + Space::cross_force(sw.xi, F0));
  r.p0 += Space::shift_to_parent(station.X, F0);
  for (std::size_t i = 0; i < n; ++i) {
    efforts[i] += Space::dot(station.J[i], F);
    if (node.frozen) continue;
    for (std::size_t k = 0; k < n; ++k) efforts[i] += Space::dot(station.J1[k * n + i], F0) * q[k];
  }
}

/// Efforts of a node's rates in the place of their accelerations, and the wrench of its hinge on the parent: children
/// have left theirs in p and p0 of the responses. `elastic`: factor of K q + D q̇.
template <class Space>
inline void strict_effort(const StrictNode<Space>& node, const StrictState<Space>& s, double elastic) {
  using Twist = typename Space::Twist;
  const int n = node.modes;
  auto& w = *at<StrictNodeWork<Space>>(s.work, node.work);
  Response<Space>& r = w.response;
  if (n > 0) {
    const double* q = s.positions + node.mode_position;
    const double* q_dot = s.speeds + node.mode_speed;
    double* a = s.result + node.mode_speed;
    const ModalBlock<Space> m(node, s.work, n);
    strict_body<Space, -1>(node, q, q_dot, w, m);
    for (int i = 0; i < n; ++i) {
      r.p += m.column[i] * a[i];
      m.rhs[i] = Space::dot(m.row[i], w.A) + Space::dot(m.row0[i], w.A0) - m.rhs[i];
      for (int j = 0; j < n; ++j) {
        const auto ij = static_cast<std::size_t>(i * n + j);
        m.rhs[i] += m.G[ij] * a[j] + elastic * (node.stiffness[ij] * q[j] + node.damping[ij] * q_dot[j]);
      }
    }
    const auto* stations = at<StrictStationWork<Space>>(s.work, node.work_stations);
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      if (node.stations[k].has_children) add_station_forces(node, node.stations[k], stations[k], q, r, m.rhs);
    }
    std::copy_n(m.rhs, n, a);
  }
  // What the body answers at q̈ and its children's wrenches given.
  const Twist F = r.P * w.A + r.Q * w.A0 + r.p, F0 = r.T * w.A0 + r.p0;
  const JointData<Space>& joint = node.joint;
  if (joint.kind != Joint::fixed) {
    const double acceleration = s.result[joint.speed];
    driven_efforts<Space>(joint, s.positions + joint.position, s.speeds + joint.speed, F, s.result + joint.speed);
    add_reflected<Space>(joint, acceleration, s.result + joint.speed);
  }
  if (node.parent < 0) return;
  Response<Space>& outer = outer_response(node, s);
  outer.p += Space::to_parent(w.SM, F);
  outer.p0 += Space::to_parent(w.SM, F0);
}

}  // namespace withy::sweep
