/// \file
/// The inward passes of the sweep of first order over one node: wrenches and inertias, with q̈ and ẍ eliminated.
#pragma once

#include <cmath>

#include "withy/core/sweep/first_order/first_order_motion.hpp"

namespace withy::sweep {

/// h of the body's own mass: d/dt ∂T/∂q̇ − ∂T/∂q at zero accelerations.
template <class Space, int N>
inline void first_order_body(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s,
                             const FirstOrderNodeWork<Space>& w, double* h) {
  const int n = count<N>(node.modes);
  const double* q_dot = s.speeds + node.mode_speed;
  const auto square = Variation<Space>::bilinear(w.V0, w.V0);
  for (int k = 0; k < n; ++k) {
    h[k] = -0.5 * dot(node.I1[static_cast<std::size_t>(k)], square);
    if (node.frozen) continue;
    auto coupling = Space::Twist::zero();
    for (int l = 0; l < n; ++l) {
      coupling +=
          (node.C1[static_cast<std::size_t>(l * n + k)] - node.C1[static_cast<std::size_t>(k * n + l)]) * q_dot[l];
      double row = 0;
      for (int j = 0; j < n; ++j) {
        row += (node.G1[static_cast<std::size_t>((l * n + k) * n + j)] -
                0.5 * node.G1[static_cast<std::size_t>((k * n + l) * n + j)]) *
               q_dot[j];
      }
      h[k] += row * q_dot[l];
    }
    h[k] += Space::dot(w.V0, coupling);
  }
}

/// What a station passes on to its body at zero accelerations, F_S − (1 − ε) (J q̇) ×* P_S, and the wrench that its
/// modes see, F_S − (1 − ε) V_S ×* P_S.
template <class Space>
struct StationForces {
  Orders<Space> on_body, on_modes;

  StationForces(const FirstOrderStationWork<Space>& sw, const Orders<Space>& F) : on_body(F), on_modes(F) {
    // (1 − ε) w answers to the pair (A0, A1) with (w1, w0).
    on_body -= {Space::cross_force(sw.rate0, sw.P1) + Space::cross_force(sw.rate1, sw.P0),
                Space::cross_force(sw.rate0, sw.P0)};
    on_modes -= {Space::cross_force(sw.V0, sw.P1) + Space::cross_force(sw.V1, sw.P0), Space::cross_force(sw.V0, sw.P0)};
  }
};

/// Adds the momentum of what a station carries to its body's.
template <class Space>
inline void add_momentum(const FirstOrderStation<Space>& station, const FirstOrderStationWork<Space>& sw,
                         FirstOrderNodeWork<Space>& w) {
  const typename Space::Position& X = station.fields.X;
  w.P0 += Space::shift_to_parent(X, sw.P0);
  w.P1 += Space::shift_to_parent(X, sw.P1 + Space::cross_force(sw.xi, sw.P0));
}

/// The same of a node, to what it hangs on.
template <class Space, class Outer>
inline void pass_momentum(const FirstOrderNodeWork<Space>& w, Outer& outer) {
  outer.P0 += Space::to_parent(w.SM, w.P0);
  outer.P1 += Space::to_parent(w.SM, w.P1);
}

/// As `factorize`, of a G that may be indefinite: the sign of its determinant, 0 where a pivot vanishes.
template <int N>
inline int factorize_indefinite(double* G, int modes) {
  const int n = count<N>(modes);
  int sign = 1;
  for (int j = 0; j < n; ++j) {
    double d = G[j * n + j];
    for (int k = 0; k < j; ++k) {
      const double scaled = G[j * n + k];
      G[j * n + k] = scaled * G[k * n + k];
      d -= scaled * G[j * n + k];
    }
    if (!(std::abs(d) > 0)) return 0;
    if (d < 0) sign = -sign;
    G[j * n + j] = 1 / d;
    for (int i = j + 1; i < n; ++i) {
      for (int k = 0; k < j; ++k) G[i * n + j] -= G[i * n + k] * G[j * n + k];
    }
  }
  return sign;
}

/// Elimination of q̈: leaves Y, y, L in the work memory and adds to I, p. The sign of det G, 0 where it is singular.
template <class Space, int N>
inline int eliminate_modes(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s,
                           FirstOrderNodeWork<Space>& w, OrdersInertia<Space>& I, Orders<Space>& p) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  const double* q = s.positions + node.mode_position;
  const double* q_dot = s.speeds + node.mode_speed;
  auto* Y = at<Orders<Space>>(s.work, node.work_Y);
  double* G = at<double>(s.work, node.work_G);
  double* y = at<double>(s.work, node.work_y);
  first_order_body<Space, N>(node, s, w, y);
  for (int i = 0; i < n; ++i) {
    Twist C1 = Twist::zero();
    for (int j = 0; j <= i; ++j) G[i * n + j] = node.G0[static_cast<std::size_t>(i * n + j)];
    for (int k = 0; k < n && !node.frozen; ++k) {
      C1 += node.C1[static_cast<std::size_t>(k * n + i)] * q[k];
      for (int j = 0; j <= i; ++j) G[i * n + j] += node.G1[static_cast<std::size_t>((k * n + i) * n + j)] * q[k];
    }
    Y[i] = Orders<Space>::wrench(node.C0[static_cast<std::size_t>(i)], C1);
  }
  const auto* stations = at<FirstOrderStationWork<Space>>(s.work, node.work_stations);
  const Twist* J1 = at<Twist>(s.work, node.work_J1);
  for (std::size_t k = 0; k < node.stations.size(); ++k, J1 += n) {
    const FirstOrderStation<Space>& station = node.stations[k];
    if (!station.has_children) continue;
    const FirstOrderStationWork<Space>& sw = stations[k];
    const typename Space::Position& X = station.fields.X;
    const StationForces<Space> force(sw, sw.p + sw.I * Orders<Space>{Twist::zero(), sw.sigma1});
    I += from_section<Space>(X, sw.xi, sw.I);
    p += from_section<Space>(X, sw.xi, force.on_body);
    add_momentum(station, sw, w);
    for (int i = 0; i < n; ++i) {
      const Orders<Space> J{station.J[static_cast<std::size_t>(i)], J1[i]};
      const Orders<Space> IJ = sw.I * J;
      Y[i] += from_section<Space>(X, sw.xi, IJ);
      y[i] += dot(J, force.on_modes);
      for (int j = 0; j <= i; ++j)
        G[i * n + j] += dot(Orders<Space>{station.J[static_cast<std::size_t>(j)], J1[j]}, IJ);
    }
  }
  for (int i = 0; i < n; ++i) {
    y[i] = s.efforts[node.mode_speed + static_cast<std::size_t>(i)] - y[i];
    for (int j = 0; j < n; ++j) {
      const auto ij = static_cast<std::size_t>(i * n + j);
      y[i] -= node.stiffness[ij] * q[j] + node.damping[ij] * q_dot[j];
      if (j <= i) G[i * n + j] += s.delta * (node.damping[ij] + s.delta * node.stiffness[ij]);
    }
  }
  const int sign = factorize_indefinite<N>(G, n);
  if (sign == 0) return 0;
  solve_lower<N>(G, n, Y);
  solve_lower<N>(G, n, y);
  for (int i = 0; i < n; ++i) {
    I.subtract_square(Y[i], G[i * n + i]);
    p += Y[i] * (G[i * n + i] * y[i]);
  }
  return sign;
}

/// Elimination of ẍ of a hinge with several rates; Y, y, L stay in the work memory. The sign as above.
inline int eliminate_joint(const JointData<Spatial>& joint, const FirstOrderState<Spatial>& s,
                           FirstOrderElimination<Spatial>& e, OrdersInertia<Spatial>& I, Orders<Spatial>& p) {
  const auto k = static_cast<int>(joint.speeds);
  const HingeMotion motion = general_motion(joint, s.positions + joint.position, s.speeds + joint.speed);
  for (int i = 0; i < k; ++i) {
    e.H[i] = Spatial::Twist::of(motion.H.col(i));
    e.Y[i] = {I.Q * e.H[i], Spatial::transposed_times(I.P, e.H[i])};
    e.y[i] = s.efforts[joint.speed + static_cast<std::size_t>(i)] - Spatial::dot(e.H[i], p.zero);
    for (int j = 0; j <= i; ++j) e.L[i * k + j] = Spatial::dot(e.Y[i].zero, e.H[j]);
  }
  e.L[0] += joint.reflected;  // 0 of several rates
  const int sign = factorize_indefinite<-1>(e.L, k);
  if (sign == 0) return 0;
  solve_lower<-1>(e.L, k, e.Y);
  solve_lower<-1>(e.L, k, e.y);
  for (int i = 0; i < k; ++i) {
    I.subtract_square(e.Y[i], e.L[i * k + i]);
    p += e.Y[i] * (e.L[i * k + i] * e.y[i]);
  }
  return sign;
}

/// The sign of the determinant of the node's block, 0 where it is singular.
template <class Space, int N>
[[gnu::flatten]] inline int first_order_inward(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s) {
  auto& w = *at<FirstOrderNodeWork<Space>>(s.work, node.work);
  OrdersInertia<Space> I = w.I;
  Orders<Space> p = w.p;
  int sign = 1;
  if constexpr (N != 0) {
    sign = eliminate_modes<Space, N>(node, s, w, I, p);
    if (sign == 0) return 0;
  }
  const JointData<Space>& joint = node.joint;
  if (joint.driven) [[unlikely]] {  // passes on everything
    w.I = I;
    w.p = p;
  } else if (single(joint.kind)) {
    const bool turns = joint.kind == Joint::rotate;
    const Orders<Space> U = turns ? I.turn_column() : I.slide_column();
    const double inertia = component<Space>(joint.kind, U.zero) + joint.reflected;
    if (!(std::abs(inertia) > 0)) return 0;
    if (inertia < 0) sign = -sign;
    w.U = U;
    w.inverse = 1 / inertia;
    w.u = joint.direction * s.efforts[joint.speed] - component<Space>(joint.kind, p.zero);
    if (node.parent < 0) return sign;
    I.subtract_square(U, w.inverse);
    p += U * (w.inverse * w.u);
  } else if constexpr (Space::angular == 3) {  // a planar tree has no other hinges
    if (joint.kind != Joint::fixed)
      sign *= eliminate_joint(joint, s, *at<FirstOrderElimination<Space>>(s.work, node.work_elimination), I, p);
    if (sign == 0) return 0;
  }
  if (node.parent < 0) return sign;
  p += I * w.sigma;
  with_outer(node, s, [&](auto& outer) {
    outer.I += to_parent<Space>(w.SM, I);
    outer.p += to_parent<Space>(w.SM, p);
    pass_momentum<Space>(w, outer);
  });
  return sign;
}

/// The inward pass for `forces` at rest, against the factors already in the work memory; p begins at zero.
template <class Space>
inline void first_order_force(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = node.modes;
  auto& w = *at<FirstOrderNodeWork<Space>>(s.work, node.work);
  Orders<Space> p = w.p;
  if (n > 0) {
    const auto* stations = at<FirstOrderStationWork<Space>>(s.work, node.work_stations);
    const Twist* J1 = at<Twist>(s.work, node.work_J1);
    double* y = at<double>(s.work, node.work_y);
    for (int i = 0; i < n; ++i) y[i] = s.efforts[node.mode_speed + static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < node.stations.size(); ++k, J1 += n) {
      const FirstOrderStation<Space>& station = node.stations[k];
      if (!station.has_children) continue;
      p += from_section<Space>(station.fields.X, stations[k].xi, stations[k].p);
      for (int i = 0; i < n; ++i)
        y[i] -= dot(Orders<Space>{station.J[static_cast<std::size_t>(i)], J1[i]}, stations[k].p);
    }
    const double* L = at<double>(s.work, node.work_G);
    const auto* Y = at<Orders<Space>>(s.work, node.work_Y);
    solve_lower<-1>(L, n, y);
    for (int i = 0; i < n; ++i) p += Y[i] * (L[i * n + i] * y[i]);
  }
  const JointData<Space>& joint = node.joint;
  if (joint.driven) [[unlikely]] {
    // The force passes on whole.
  } else if (single(joint.kind)) {
    w.u = joint.direction * s.efforts[joint.speed] - component<Space>(joint.kind, p.zero);
    p += w.U * (w.inverse * w.u);
  } else if constexpr (Space::angular == 3) {
    if (joint.kind != Joint::fixed) {
      auto& e = *at<FirstOrderElimination<Space>>(s.work, node.work_elimination);
      const auto k = static_cast<int>(joint.speeds);
      for (int i = 0; i < k; ++i)
        e.y[i] = s.efforts[joint.speed + static_cast<std::size_t>(i)] - Space::dot(e.H[i], p.zero);
      solve_lower<-1>(e.L, k, e.y);
      for (int i = 0; i < k; ++i) p += e.Y[i] * (e.L[i * k + i] * e.y[i]);
    }
  }
  if (node.parent < 0) return;
  with_outer(node, s, [&](auto& outer) { outer.p += to_parent<Space>(w.SM, p); });
}

}  // namespace withy::sweep
