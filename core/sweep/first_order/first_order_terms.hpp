/// \file
/// Work memory of the sweep of first order, and its weight.
#pragma once

#include <array>

#include "withy/core/sweep/first_order/first_order_sweep.hpp"
#include "withy/core/sweep/symmetric/symmetric_terms.hpp"

namespace withy::sweep {

/// Orders zero to two in q of a vector.
template <class Space>
using Taylor = std::array<typename Space::Position, 3>;

template <class Space>
struct FirstOrderStationWork {
  typename Space::Twist xi, rate0, rate1;  ///< ξ = J0 q; J q̇ = rate0 + ε rate1
  typename Space::Twist V0, V1;
  typename Space::Twist sigma1;  ///< σ of the station, of first order alone
  typename Space::Twist P0, P1;  ///< momentum of what it carries
  Orders<Space> p;               ///< wrench of what it carries at zero acceleration of S
  OrdersInertia<Space> I;
  Orders<Space> A;
  Taylor<Space> g, s;  ///< gravity in S; first moment of mass of what it carries
};

/// Elimination of the rates of a hinge with several; see JointElimination.
template <class Space>
struct FirstOrderElimination {
  typename Space::Twist H[Space::dim];
  Orders<Space> Y[Space::dim];
  double L[Space::dim * Space::dim], y[Space::dim];
};

template <class Space>
struct FirstOrderNodeWork {
  typename Space::Frame SM;  ///< of JointMotion
  typename Space::Twist V0, V1;
  typename Space::Twist P0, P1;  ///< momentum of the node and all that hangs on it
  Orders<Space> sigma;           ///< of the hinge
  Orders<Space> p;               ///< velocity wrench; of a driven hinge, what it passes on
  OrdersInertia<Space> I;        ///< the same: after the inward pass of a driven hinge, what it passes on
  Orders<Space> A;
  Orders<Space> U;  ///< one rate: column of the articulated inertia
  double inverse, u;
  Taylor<Space> g, s;
};

template <class Space>
struct FirstOrderState {
  const double* positions;
  const double* speeds;
  const double* efforts;  ///< with those of weight
  double* result;
  std::byte* work;
  const FirstOrderNode<Space>* nodes;
  double delta = 0;          ///< above 0: G + δ D + δ² K in the place of G
  double* driven = nullptr;  ///< receives all efforts on driven rates; null: they do not accelerate
  const double* weight = nullptr;
};

/// The node's frame or the station that a node hangs on, in the parent's work memory.
template <class Space, class Action>
inline void with_outer(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s, Action&& action) {
  const FirstOrderNode<Space>& parent = s.nodes[node.parent];
  if (node.parent_station < 0) {
    action(*at<FirstOrderNodeWork<Space>>(s.work, parent.work));
  } else {
    action(at<FirstOrderStationWork<Space>>(s.work, parent.work_stations)[node.parent_station]);
  }
}

namespace weight {

inline Planar::Position turned(double turn, const Planar::Position& a) { return {-turn * a.y, turn * a.x}; }
inline Triple turned(const Triple& turn, const Triple& a) { return withy::cross(turn, a); }
inline double moment(const Planar::Position& a, const Planar::Position& b) { return a.x * b.y - a.y * b.x; }
inline Triple moment(const Triple& a, const Triple& b) { return withy::cross(a, b); }
inline double scalar(const Planar::Position& a, const Planar::Position& b) { return a.x * b.x + a.y * b.y; }
inline double scalar(const Triple& a, const Triple& b) { return dot(a, b); }
inline double angle(const Planar::Twist& V) { return V.w; }
inline const Triple& angle(const Spatial::Twist& V) { return V.w; }
inline Planar::Position place(const Planar::Twist& V) { return {V.x, V.y}; }
inline const Triple& place(const Spatial::Twist& V) { return V.v; }

/// (Ψ q; Φ q) of a section, half the second order ½ (qᵀΘq; qᵀΓq), and (Θq; Γq)_k.
template <class Space>
struct Bend {
  typename Space::Twist first = Space::Twist::zero(), second = Space::Twist::zero();

  Bend(const Fields<Space>& f, int n, const double* q) {
    const typename Space::Twist* at = f.second.data();
    for (int i = 0; i < n; ++i) {
      first += f.first[static_cast<std::size_t>(i)] * q[i];
      for (int j = i; j < n && !f.second.empty(); ++j, ++at) second += *at * ((i == j ? 0.5 : 1.0) * q[i] * q[j]);
    }
  }
  static typename Space::Twist slope(const Fields<Space>& f, int n, const double* q, int k) {
    auto sum = Space::Twist::zero();
    if (f.second.empty()) return sum;
    const typename Space::Twist* at = f.second.data();
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j, ++at) {
        if (i == k) {
          sum += *at * q[j];
        } else if (j == k) {
          sum += *at * q[i];
        }
      }
    }
    return sum;
  }
};

/// Gravity in the frames of a node and its stations, to second order in q.
template <class Space>
inline void outward(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s,
                    const typename Space::Position& gravity) {
  auto& w = *at<FirstOrderNodeWork<Space>>(s.work, node.work);
  if (node.parent < 0) {
    w.g = {Space::unrotate(w.SM.R, gravity), Space::Position::zero(), Space::Position::zero()};
  } else {
    with_outer(node, s, [&](const auto& outer) {
      for (std::size_t k = 0; k < 3; ++k) w.g[k] = Space::unrotate(w.SM.R, outer.g[k]);
    });
  }
  w.s = {node.I0.moment, Space::Position::zero(), Space::Position::zero()};
  const double* q = s.positions + node.mode_position;
  const int n = node.frozen ? 0 : node.modes;
  for (int k = 0; k < n; ++k) {
    w.s[1] += node.moment1[static_cast<std::size_t>(k)] * q[k];
    for (int l = 0; l < n; ++l) w.s[2] += node.moment2[static_cast<std::size_t>(k * n + l)] * (0.5 * q[k] * q[l]);
  }
  auto* stations = at<FirstOrderStationWork<Space>>(s.work, node.work_stations);
  for (std::size_t k = 0; k < node.stations.size(); ++k) {
    if (!node.stations[k].has_children) continue;
    // (1 − θ̂ + ½ θ̂²) g.
    const Bend<Space> bend(node.stations[k].fields, n, q);
    const auto &turn = angle(bend.first), &turn2 = angle(bend.second);
    auto& g = stations[k].g;
    g[0] = w.g[0];
    const auto once = turned(turn, w.g[0]);
    g[1] = w.g[1] + once * -1.0;
    g[2] = w.g[2] + turned(turn, w.g[1]) * -1.0 + turned(turn2, w.g[0]) * -1.0 + turned(turn, once) * 0.5;
    stations[k].s = {Space::Position::zero(), Space::Position::zero(), Space::Position::zero()};
  }
}

/// Weight on a node's rates: the gradient of the potential of second order in q. `mass` of what a station carries.
template <class Space>
inline void inward(const FirstOrderNode<Space>& node, const FirstOrderState<Space>& s, double* efforts) {
  using Position = typename Space::Position;
  auto& w = *at<FirstOrderNodeWork<Space>>(s.work, node.work);
  const double* q = s.positions + node.mode_position;
  const int modes = node.modes, n = node.frozen ? 0 : modes;
  auto* stations = at<FirstOrderStationWork<Space>>(s.work, node.work_stations);
  const Position g01 = w.g[0] + w.g[1];
  for (int k = 0; k < modes; ++k) {
    Position d1 = Position::zero();
    for (int l = 0; l < n; ++l) d1 += node.moment2[static_cast<std::size_t>(k * n + l)] * q[l];
    efforts[node.mode_speed + static_cast<std::size_t>(k)] =
        scalar(node.moment1[static_cast<std::size_t>(k)], g01) + scalar(d1, w.g[0]);
  }
  for (std::size_t i = 0; i < node.stations.size(); ++i) {
    const auto& station = node.stations[i];
    if (!station.has_children) continue;
    const Bend<Space> bend(station.fields, n, q);
    const auto &turn = angle(bend.first), &turn2 = angle(bend.second);
    const Taylor<Space>& S = stations[i].s;
    const double mass = station.carried;
    const auto once = turned(turn, S[0]);
    for (int k = 0; k < modes; ++k) {
      const auto& first = station.fields.first[static_cast<std::size_t>(k)];
      const auto slope = Bend<Space>::slope(station.fields, n, q, k);
      const auto unit = turned(angle(first), S[0]);
      const Position d0 = place(first) * mass + unit;
      const Position d1 = place(slope) * mass + turned(angle(first), S[1]) + turned(angle(slope), S[0]) +
                          (turned(angle(first), once) + turned(turn, unit)) * 0.5;
      efforts[node.mode_speed + static_cast<std::size_t>(k)] += scalar(d0, g01) + scalar(d1, w.g[0]);
    }
    w.s[0] += station.fields.X * mass + S[0];
    w.s[1] += place(bend.first) * mass + S[1] + once;
    w.s[2] += place(bend.second) * mass + S[2] + turned(turn, S[1]) + turned(turn2, S[0]) + turned(turn, once) * 0.5;
  }
  const auto torque = moment(w.s[0], g01 + w.g[2]) + moment(w.s[1], g01) + moment(w.s[2], w.g[0]);
  const typename Space::Twist F = Space::Twist::of(torque, (g01 + w.g[2]) * node.mass);
  if (node.joint.kind != Joint::fixed)
    driven_efforts<Space>(node.joint, s.positions + node.joint.position, s.speeds + node.joint.speed, F,
                          efforts + node.joint.speed);
  if (node.parent < 0) return;
  with_outer(node, s, [&](auto& outer) {
    for (std::size_t k = 0; k < 3; ++k) outer.s[k] += Space::rotate(w.SM.R, w.s[k]);
    outer.s[0] += w.SM.p * node.mass;
  });
}

}  // namespace weight
}  // namespace withy::sweep
