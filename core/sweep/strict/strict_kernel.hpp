/// \file
/// The three passes of the strict sweep over one node; the relations are in strict_sweep.hpp.
#pragma once

#include "withy/core/sweep/strict/strict_terms.hpp"

namespace withy::sweep {

template <class Space, int N>
[[gnu::flatten]] inline void strict_outward(const StrictNode<Space>& node, const StrictState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<StrictNodeWork<Space>>(s.work, node.work);
  JointMotion<Space> joint;
  joint_motion<Space>(node.joint, s.positions + node.joint.position, s.speeds + node.joint.speed, joint);
  w.SM = joint.SM;
  w.V0 = joint.rate;
  w.V1 = Twist::zero();
  if (node.parent >= 0) {
    const StrictNode<Space>& parent = s.nodes[node.parent];
    const auto& pw = *at<StrictNodeWork<Space>>(s.work, parent.work);
    const auto* ps = at<StrictStationWork<Space>>(s.work, parent.work_stations);
    const bool on_frame = node.parent_station < 0;
    w.V0 += Space::to_child(w.SM, on_frame ? pw.V0 : ps[node.parent_station].V0);
    w.V1 = Space::to_child(w.SM, on_frame ? pw.V1 : ps[node.parent_station].V1);
  }
  w.sigma0 = Space::cross(w.V0, joint.rate);
  if (has_bias(node.joint.kind)) w.sigma0 += joint.bias;
  if (node.joint.driven) [[unlikely]]
    w.sigma0 += driven_acceleration<Space>(node.joint, s.positions + node.joint.position, s.speeds + node.joint.speed,
                                           s.result + node.joint.speed);
  w.sigma = w.sigma0 + Space::cross(w.V1, joint.rate);

  if constexpr (N != 0) {
    const double* q = s.positions + node.mode_position;
    const double* q_dot = s.speeds + node.mode_speed;
    auto* stations = at<StrictStationWork<Space>>(s.work, node.work_stations);
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      const StrictStation<Space>& station = node.stations[k];
      if (!station.has_children) continue;
      StrictStationWork<Space>& sw = stations[k];
      sw.V0 = Space::shift_to_child(station.X, w.V0);
      sw.V1 = Space::shift_to_child(station.X, w.V1);
      sw.xi = sw.sigma = Twist::zero();
      if (!node.frozen) {
        Twist rate = Twist::zero();
        for (int i = 0; i < n; ++i) {
          sw.xi += station.J[static_cast<std::size_t>(i)] * q[i];
          rate += station.J[static_cast<std::size_t>(i)] * q_dot[i];
        }
        sw.V1 += rate - Space::cross(sw.xi, sw.V0);
        sw.sigma = Space::cross(sw.V0, rate);
      }
      sw.response.clear();
    }
  }
  // Body terms of order zero; the modal pass adds the first.
  Response<Space>& r = w.response;
  const Twist momentum = node.I0.inertia * w.V0;
  r.P = r.T = Space::Matrix::of(node.I0.inertia);
  r.Q = r.R = Space::Matrix::zero();
  r.p0 = Space::cross_force(w.V0, momentum);
  r.p = r.p0 + Space::cross_force(w.V1, momentum) + Space::cross_force(w.V0, node.I0.inertia * w.V1);
}

/// Puts ẍ = u − row·Ā' − row0·A0' of one rate into the response; columns: what its unit acceleration asks of F̄, F0.
template <class Space>
inline void eliminate_rate(Response<Space>& r, const typename Space::Twist& column,
                           const typename Space::Twist& column0, const typename Space::Twist& row,
                           const typename Space::Twist& row0, double u) {
  r.P.subtract_outer(column, row);
  r.Q.subtract_outer(column, row0);
  r.R.subtract_outer(column0, row);
  r.T.subtract_outer(column0, row0);
  r.p += column * u;
  r.p0 += column0 * u;
}

/// Elimination of ẍ of a hinge with several rates; the sign of the determinant of their block, 0 where it is singular.
[[gnu::noinline]] inline int eliminate_rates(const JointData<Spatial>& joint, const StrictState<Spatial>& s,
                                             StrictElimination<Spatial>& e, Response<Spatial>& r) {
  const auto k = static_cast<int>(joint.speeds);
  const HingeMotion motion = general_motion(joint, s.positions + joint.position, s.speeds + joint.speed);
  Spatial::Twist column[Spatial::dim], column0[Spatial::dim];
  double D[Spatial::dim * Spatial::dim], scale[Spatial::dim];
  for (int i = 0; i < k; ++i) e.H[i] = Spatial::Twist::of(motion.H.col(i));
  for (int i = 0; i < k; ++i) {
    column[i] = r.P * e.H[i] + r.Q * e.H[i];
    column0[i] = r.R * e.H[i] + r.T * e.H[i];
    e.row[i] = Spatial::transposed_times(r.P, e.H[i]);
    e.row0[i] = Spatial::transposed_times(r.Q, e.H[i]);
    e.d[i] = s.efforts[joint.speed + static_cast<std::size_t>(i)] - Spatial::dot(e.H[i], r.p);
    for (int j = 0; j < k; ++j) D[j * k + i] = Spatial::dot(e.H[j], column[i]) + joint.reflected;  // 0 of several rates
  }
  const int sign = solve_general<-1>(D, k, e.row, e.row0, e.d, scale);
  if (sign == 0) return 0;
  for (int i = 0; i < k; ++i) eliminate_rate(r, column[i], column0[i], e.row[i], e.row0[i], e.d[i]);
  return sign;
}

/// The response that a node's goes into: its parent's, or that of the parent's station.
template <class Space>
inline Response<Space>& outer_response(const StrictNode<Space>& node, const StrictState<Space>& s) {
  const StrictNode<Space>& parent = s.nodes[node.parent];
  return node.parent_station < 0
             ? at<StrictNodeWork<Space>>(s.work, parent.work)->response
             : at<StrictStationWork<Space>>(s.work, parent.work_stations)[node.parent_station].response;
}

/// Elimination of ẍ, and what the hinge passes to the parent: the sign of the node's block so far, `sign`, times that
/// of the hinge; 0 where the hinge's is singular.
template <class Space>
inline int strict_pass_inward(const StrictNode<Space>& node, const StrictState<Space>& s, StrictNodeWork<Space>& w,
                              int sign) {
  Response<Space>& r = w.response;
  const JointData<Space>& joint = node.joint;
  if (joint.driven) [[unlikely]] {
    w.row = r.p;
  } else if (single(joint.kind)) {
    const bool turns = joint.kind == Joint::rotate;
    const typename Space::Twist column =
        turns ? r.P.turn_column() + r.Q.turn_column() : r.P.slide_column() + r.Q.slide_column();
    const double pivot = component<Space>(joint.kind, column) + joint.reflected;
    if (!(std::abs(pivot) > 0)) return 0;
    if (pivot < 0) sign = -sign;
    const double inverse = 1 / pivot;
    w.row = (turns ? r.P.turn_row() : r.P.slide_row()) * inverse;
    w.row0 = (turns ? r.Q.turn_row() : r.Q.slide_row()) * inverse;
    w.u = (joint.direction * s.efforts[joint.speed] - component<Space>(joint.kind, r.p)) * inverse;
    if (node.parent < 0) return sign;
    const typename Space::Twist column0 =
        turns ? r.R.turn_column() + r.T.turn_column() : r.R.slide_column() + r.T.slide_column();
    eliminate_rate(r, column, column0, w.row, w.row0, w.u);
  } else if constexpr (Space::angular == 3) {  // a planar tree has no other hinges
    if (joint.kind != Joint::fixed) sign *= eliminate_rates(joint, s, w.elimination, r);
    if (sign == 0) return 0;
  }
  if (node.parent < 0) return sign;
  r.p += r.P * w.sigma + r.Q * w.sigma0;
  r.p0 += r.R * w.sigma + r.T * w.sigma0;
  Response<Space>& outer = outer_response(node, s);
  const typename Space::Frame& X = w.SM;
  outer.P += Space::to_parent(X, r.P);
  outer.Q += Space::to_parent(X, r.Q);
  outer.R += Space::to_parent(X, r.R);
  outer.T += Space::to_parent(X, r.T);
  outer.p += Space::to_parent(X, r.p);
  outer.p0 += Space::to_parent(X, r.p0);
  return sign;
}

/// The same where modes were eliminated before, which takes longer than the call: one instance for any number of them.
[[gnu::noinline, gnu::flatten]] inline int strict_pass_inward_apart(const StrictNode<Spatial>& node,
                                                                    const StrictState<Spatial>& s,
                                                                    StrictNodeWork<Spatial>& w, int sign) {
  return strict_pass_inward<Spatial>(node, s, w, sign);
}

template <class Space, int N>
[[gnu::flatten]] inline int strict_inward(const StrictNode<Space>& node, const StrictState<Space>& s) {
  const int n = count<N>(node.modes);
  auto& w = *at<StrictNodeWork<Space>>(s.work, node.work);
  Response<Space>& r = w.response;
  int sign = 1;  // of the determinant of the node's block
  if constexpr (N != 0) {
    const double* q = s.positions + node.mode_position;
    const double* q_dot = s.speeds + node.mode_speed;
    const ModalBlock<Space> m(node, s.work, n);
    strict_body<Space, N>(node, q, q_dot, w, m);
    const auto* stations = at<StrictStationWork<Space>>(s.work, node.work_stations);
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      if (node.stations[k].has_children) strict_station<Space, N>(node, node.stations[k], stations[k], q, w, m);
    }
    for (int i = 0; i < n; ++i) {
      m.rhs[i] += s.efforts[node.mode_speed + static_cast<std::size_t>(i)];
      for (int j = 0; j < n; ++j) {
        m.rhs[i] -= node.stiffness[static_cast<std::size_t>(i * n + j)] * q[j] +
                    node.damping[static_cast<std::size_t>(i * n + j)] * q_dot[j];
      }
    }
    sign = solve_general<N>(m.G, n, m.row, m.row0, m.rhs, m.scale);
    if (sign == 0) return 0;
    for (int i = 0; i < n; ++i) {
      if (node.leaf) {  // q̈ does not enter F0
        r.P.subtract_outer(m.column[i], m.row[i]);
        r.Q.subtract_outer(m.column[i], m.row0[i]);
        r.p += m.column[i] * m.rhs[i];
      } else {
        eliminate_rate(r, m.column[i], m.column0[i], m.row[i], m.row0[i], m.rhs[i]);
      }
    }
  }
  if constexpr (N != 0 && Space::angular == 3) {
    return strict_pass_inward_apart(node, s, w, sign);
  } else {
    return strict_pass_inward<Space>(node, s, w, sign);
  }
}

/// Ā and A0 of a node but for H ẍ: the parent's, and the hinge's σ̄ and σ0.
template <class Space>
inline void take_outer_acceleration(const StrictNode<Space>& node, const StrictState<Space>& s,
                                    StrictNodeWork<Space>& w) {
  const typename Space::Twist* A = s.world;
  const typename Space::Twist* A0 = s.world;
  if (node.parent >= 0) {
    const StrictNode<Space>& parent = s.nodes[node.parent];
    const auto& pw = *at<StrictNodeWork<Space>>(s.work, parent.work);
    const auto* ps = at<StrictStationWork<Space>>(s.work, parent.work_stations);
    A = node.parent_station < 0 ? &pw.A : &ps[node.parent_station].A;
    A0 = node.parent_station < 0 ? &pw.A0 : &ps[node.parent_station].A0;
  }
  w.A = Space::to_child(w.SM, *A) + w.sigma;
  w.A0 = Space::to_child(w.SM, *A0) + w.sigma0;
}

/// Ā and A0 of a node's stations from the node's and q̈ (`result` of the state).
template <class Space, int N>
inline void station_accelerations(const StrictNode<Space>& node, const StrictState<Space>& s,
                                  const StrictNodeWork<Space>& w) {
  const int n = count<N>(node.modes);
  const double* a = s.result + node.mode_speed;
  auto* stations = at<StrictStationWork<Space>>(s.work, node.work_stations);
  for (std::size_t k = 0; k < node.stations.size(); ++k) {
    const StrictStation<Space>& station = node.stations[k];
    if (!station.has_children) continue;
    StrictStationWork<Space>& sw = stations[k];
    sw.A0 = Space::shift_to_child(station.X, w.A0);
    sw.A = Space::shift_to_child(station.X, w.A) - Space::cross(sw.xi, sw.A0) + sw.sigma;
    for (int i = 0; i < n; ++i) sw.A += station.J[static_cast<std::size_t>(i)] * a[i];
  }
}

template <class Space, int N>
[[gnu::flatten]] inline void strict_acceleration(const StrictNode<Space>& node, const StrictState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<StrictNodeWork<Space>>(s.work, node.work);
  take_outer_acceleration(node, s, w);
  const JointData<Space>& joint = node.joint;
  if (joint.driven) [[unlikely]] {
    driven_efforts<Space>(joint, s.positions + joint.position, s.speeds + joint.speed,
                          w.response.P * w.A + w.response.Q * w.A0 + w.row, s.efforts + joint.speed);
    add_reflected<Space>(joint, s.result[joint.speed], s.efforts + joint.speed);
  } else if (single(joint.kind)) {
    const double x = w.u - Space::dot(w.row, w.A) - Space::dot(w.row0, w.A0);
    w.A += along<Space>(joint.kind, x);
    w.A0 += along<Space>(joint.kind, x);
    s.result[joint.speed] = joint.direction * x;
  } else if constexpr (Space::angular == 3) {
    if (joint.kind != Joint::fixed) {
      const StrictElimination<Space>& e = w.elimination;
      Twist rate = Twist::zero();
      for (std::size_t i = 0; i < joint.speeds; ++i) {
        const double x = e.d[i] - Space::dot(e.row[i], w.A) - Space::dot(e.row0[i], w.A0);
        rate += e.H[i] * x;
        s.result[joint.speed + i] = x;
      }
      w.A += rate;
      w.A0 += rate;
    }
  }
  if constexpr (N != 0) {
    const ModalBlock<Space> m(node, s.work, n);
    double* a = s.result + node.mode_speed;
    for (int i = 0; i < n; ++i) a[i] = m.rhs[i] - Space::dot(m.row[i], w.A) - Space::dot(m.row0[i], w.A0);
    station_accelerations<Space, N>(node, s, w);
  }
}

}  // namespace withy::sweep
