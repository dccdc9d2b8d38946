/// \file
/// The outward pass of motion in the sweep of first order over one node: twists, σ, momenta, and the terms of the
/// body's own mass.
#pragma once

#include "withy/core/sweep/first_order/first_order_terms.hpp"

namespace withy::sweep {

template <class Space, int N>
[[gnu::flatten]] inline void first_order_outward(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<FirstOrderNodeWork<Space>>(s.work, node.work);
  JointMotion<Space> joint;
  joint_motion<Space>(node.joint, s.positions + node.joint.position, s.speeds + node.joint.speed, joint);
  w.SM = joint.SM;
  w.V0 = joint.rate;
  w.V1 = Twist::zero();
  if (node.parent >= 0) {
    with_outer(node, s, [&](const auto& outer) {
      w.V0 += Space::to_child(w.SM, outer.V0);
      w.V1 = Space::to_child(w.SM, outer.V1);
    });
  }
  w.sigma = {Space::cross(w.V0, joint.rate), Space::cross(w.V1, joint.rate)};
  if (has_bias(node.joint.kind)) w.sigma.zero += joint.bias;
  if (node.joint.driven && s.driven != nullptr) [[unlikely]]
    w.sigma.zero += driven_acceleration<Space>(node.joint, s.positions + node.joint.position,
                                               s.speeds + node.joint.speed, s.result + node.joint.speed);
  w.P0 = node.I0.inertia * w.V0;
  w.P1 = node.I0.inertia * w.V1;
  w.I = {node.I0.inertia, Space::Matrix::of(node.I0.inertia), Space::Inertia::zero()};
  Twist rate_of_momentum = Twist::zero();  // ε (I′[q̇] V + C′[q̇] q̇)
  if constexpr (N != 0) {
    const double* q = s.positions + node.mode_position;
    const double* q_dot = s.speeds + node.mode_speed;
    if (!node.frozen) {
      auto I1 = Variation<Space>::zero(), I1_rate = Variation<Space>::zero();
      for (int k = 0; k < n; ++k) {
        const auto kk = static_cast<std::size_t>(k);
        I1.add(node.I1[kk], q[k]);
        I1_rate.add(node.I1[kk], q_dot[k]);
        w.P0 += node.C0[kk] * q_dot[k];
        Twist C1 = Twist::zero(), C1_rate = Twist::zero();
        for (int l = 0; l < n; ++l) {
          C1 += node.C1[static_cast<std::size_t>(l * n + k)] * q[l];
          C1_rate += node.C1[static_cast<std::size_t>(l * n + k)] * q_dot[l];
        }
        w.P1 += C1 * q_dot[k];
        rate_of_momentum += C1_rate * q_dot[k];
      }
      w.P1 += I1.times(w.V0);
      w.I.Q += I1.inertia();
      rate_of_momentum += I1_rate.times(w.V0);
    }
    auto* stations = at<FirstOrderStationWork<Space>>(s.work, node.work_stations);
    Twist* J1 = at<Twist>(s.work, node.work_J1);
    for (std::size_t j = 0; j < node.stations.size(); ++j, J1 += n) {
      const FirstOrderStation<Space>& station = node.stations[j];
      if (!station.has_children) continue;
      FirstOrderStationWork<Space>& sw = stations[j];
      sw.V0 = Space::shift_to_child(station.fields.X, w.V0);
      sw.V1 = Space::shift_to_child(station.fields.X, w.V1);
      sw.xi = sw.rate0 = sw.rate1 = sw.sigma1 = Twist::zero();
      for (int i = 0; i < n; ++i) {
        J1[i] = Twist::zero();
        if (node.frozen) continue;
        Twist change = Twist::zero();
        for (int k = 0; k < n; ++k) {
          const Twist& slope = station.J1[static_cast<std::size_t>(k * n + i)];
          J1[i] += slope * q[k];
          change += slope * q_dot[k];
        }
        const Twist& J = station.J[static_cast<std::size_t>(i)];
        sw.xi += J * q[i];
        sw.rate0 += J * q_dot[i];
        sw.rate1 += J1[i] * q_dot[i];
        sw.sigma1 += change * q_dot[i];
      }
      sw.V1 += sw.rate1 - Space::cross(sw.xi, sw.V0);
      sw.V0 += sw.rate0;
      sw.sigma1 += Space::cross(sw.V0, sw.rate0);
      sw.P0 = sw.P1 = Twist::zero();
      sw.p = Orders<Space>::none();
      sw.I = OrdersInertia<Space>::none();
    }
  }
  w.p = Orders<Space>::wrench(Space::cross_force(w.V0, w.P0),
                              Space::cross_force(w.V1, w.P0) + Space::cross_force(w.V0, w.P1) + rate_of_momentum);
}

}  // namespace withy::sweep
