/// \file
/// Inverse dynamics over the nodes of a sweep of first order: the same relations with ẍ, q̈ given.
#pragma once

#include "withy/core/sweep/first_order/first_order_kernel.hpp"

namespace withy::sweep {

/// Accelerations of a node and its stations where all rates' are given (`efforts` of the state holds them).
template <class Space>
inline void given_acceleration(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s) {
  auto& w = *at<FirstOrderNodeWork<Space>>(s.work, node.work);
  w.A = w.sigma;
  if (node.parent >= 0) with_outer(node, s, [&](const auto& outer) { w.A += to_child<Space>(w.SM, outer.A); });
  const JointData<Space>& joint = node.joint;
  if (joint.kind != Joint::fixed)
    w.A.zero += driven_acceleration<Space>(joint, s.positions + joint.position, s.speeds + joint.speed,
                                           s.efforts + joint.speed);
  station_accelerations<Space, -1>(node, s, w.A, s.efforts + node.mode_speed);
}

/// Efforts of a node's rates, and the wrench of its hinge on the parent. `elastic`: factor of K q + D q̇.
template <class Space>
inline void first_order_effort(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s, double elastic) {
  using Twist = typename Space::Twist;
  auto& w = *at<FirstOrderNodeWork<Space>>(s.work, node.work);
  const int n = node.modes;
  Orders<Space> F = w.p + w.I * w.A;
  const double* q = s.positions + node.mode_position;
  const double* q_dot = s.speeds + node.mode_speed;
  const double* a = s.efforts + node.mode_speed;
  double* h = s.result + node.mode_speed;
  first_order_body<Space, -1>(node, s, w, h);
  for (int i = 0; i < n; ++i) {
    Twist C1 = Twist::zero();
    for (int k = 0; k < n && !node.frozen; ++k) C1 += node.C1[static_cast<std::size_t>(k * n + i)] * q[k];
    const Orders<Space> C = Orders<Space>::wrench(node.C0[static_cast<std::size_t>(i)], C1);
    F += C * a[i];
    h[i] += dot(C, w.A);
    for (int j = 0; j < n; ++j) {
      const auto ij = static_cast<std::size_t>(i * n + j);
      double G = node.G0[ij];
      for (int k = 0; k < n && !node.frozen; ++k) G += node.G1[static_cast<std::size_t>((k * n + i) * n + j)] * q[k];
      h[i] += G * a[j] + elastic * (node.stiffness[ij] * q[j] + node.damping[ij] * q_dot[j]);
    }
  }
  const auto* stations = at<FirstOrderStationWork<Space>>(s.work, node.work_stations);
  const Twist* J1 = at<Twist>(s.work, node.work_J1);
  for (std::size_t k = 0; k < node.stations.size(); ++k, J1 += n) {
    const FirstOrderStation<Space>& station = node.stations[k];
    if (!station.has_children) continue;
    const FirstOrderStationWork<Space>& sw = stations[k];
    const StationForces<Space> force(sw, sw.p);
    F += from_section<Space>(station.fields.X, sw.xi, force.on_body);
    add_momentum(station, sw, w);
    for (int i = 0; i < n; ++i)
      h[i] += dot(Orders<Space>{station.J[static_cast<std::size_t>(i)], J1[i]}, force.on_modes);
  }
  const JointData<Space>& joint = node.joint;
  if (joint.kind != Joint::fixed) {
    driven_efforts<Space>(joint, s.positions + joint.position, s.speeds + joint.speed, F.zero, s.result + joint.speed);
    add_reflected<Space>(joint, s.efforts[joint.speed], s.result + joint.speed);
  }
  if (node.parent < 0) return;
  with_outer(node, s, [&](auto& outer) {
    outer.p += to_parent<Space>(w.SM, F);
    pass_momentum<Space>(w, outer);
  });
}

}  // namespace withy::sweep
