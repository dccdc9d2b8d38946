/// \file
/// The three passes of the sweep of first order over one node; the relations are in first_order_sweep.hpp. They are
/// first_order_outward, first_order_inward, and first_order_acceleration, which stands here.
#pragma once

#include "withy/core/sweep/first_order/first_order_elimination.hpp"

namespace withy::sweep {

/// x = L⁻ᵀ Δ⁻¹ (y − Y A).
template <int N, class Space>
inline void back_substitute(const double* L, const Orders<Space>* Y, const double* y, int modes, const Orders<Space>& A,
                            double* x) {
  const int n = count<N>(modes);
  for (int i = 0; i < n; ++i) x[i] = L[i * n + i] * (y[i] - dot(Y[i], A));
  for (int i = n; i-- > 0;) {
    for (int k = i + 1; k < n; ++k) x[i] -= L[k * n + i] * x[k];
  }
}

/// Accelerations of a node's stations, its own and those of its modes being known.
template <class Space, int N>
inline void station_accelerations(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s,
                                  const Orders<Space>& A, const double* a) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto* stations = at<FirstOrderStationWork<Space>>(s.work, node.work_stations);
  const Twist* J1 = at<Twist>(s.work, node.work_J1);
  for (std::size_t k = 0; k < node.stations.size(); ++k, J1 += n) {
    const FirstOrderStation<Space>& station = node.stations[k];
    if (!station.has_children) continue;
    FirstOrderStationWork<Space>& sw = stations[k];
    sw.A = to_section<Space>(station.fields.X, sw.xi, A);
    sw.A.one += sw.sigma1;
    for (int i = 0; i < n; ++i) sw.A += Orders<Space>{station.J[static_cast<std::size_t>(i)], J1[i]} * a[i];
  }
}

template <class Space, int N>
[[gnu::flatten]] inline void first_order_acceleration(const FirstOrderNode<Space>& node,
                                                      const FirstOrderState<Space>& s) {
  auto& w = *at<FirstOrderNodeWork<Space>>(s.work, node.work);
  Orders<Space> A = w.sigma;
  if (node.parent >= 0) with_outer(node, s, [&](const auto& outer) { A += to_child<Space>(w.SM, outer.A); });
  const JointData<Space>& joint = node.joint;
  if (joint.driven) [[unlikely]] {
    if (s.driven != nullptr) {
      double* efforts = s.driven + joint.speed;
      driven_efforts<Space>(joint, s.positions + joint.position, s.speeds + joint.speed, (w.I * A + w.p).zero, efforts);
      add_reflected<Space>(joint, s.result[joint.speed], efforts);
      for (std::size_t i = 0; i < joint.speeds && s.weight != nullptr; ++i) efforts[i] -= s.weight[joint.speed + i];
    } else {
      for (std::size_t i = 0; i < joint.speeds; ++i) s.result[joint.speed + i] = 0;
    }
  } else if (single(joint.kind)) {
    const double x = (w.u - dot(w.U, A)) * w.inverse;
    A.zero += along<Space>(joint.kind, x);
    s.result[joint.speed] = joint.direction * x;
  } else if constexpr (Space::angular == 3) {
    if (joint.kind != Joint::fixed) {
      const auto& e = *at<FirstOrderElimination<Space>>(s.work, node.work_elimination);
      double* x = s.result + joint.speed;
      back_substitute<-1, Space>(e.L, e.Y, e.y, static_cast<int>(joint.speeds), A, x);
      for (std::size_t i = 0; i < joint.speeds; ++i) A.zero += e.H[i] * x[i];
    }
  }
  w.A = A;
  if constexpr (N != 0) {
    double* a = s.result + node.mode_speed;
    back_substitute<N, Space>(at<double>(s.work, node.work_G), at<Orders<Space>>(s.work, node.work_Y),
                              at<double>(s.work, node.work_y), count<N>(node.modes), A, a);
    station_accelerations<Space, N>(node, s, A, a);
  }
}

}  // namespace withy::sweep
