/// \file
/// The three passes of the strict sweep over one node; the relations are in strict_sweep.hpp.
#pragma once

#include "withy/core/dynamics/strict_terms.hpp"

namespace withy::sweep {

template <class Space, int N>
[[gnu::flatten]] inline void strict_outward(const StrictNode<Space>& node, const StrictState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<StrictNodeWork<Space>>(s.work, node.work);
  joint_motion<Space>(node.joint, s.positions + node.joint.position, s.speeds + node.joint.speed, w.joint);
  w.V0 = w.joint.rate;
  w.V1.setZero();
  if (node.parent >= 0) {
    const StrictNode<Space>& parent = s.nodes[node.parent];
    const auto& pw = *at<StrictNodeWork<Space>>(s.work, parent.work);
    const auto* ps = at<StrictStationWork<Space>>(s.work, parent.work_stations);
    const bool on_frame = node.parent_station < 0;
    w.V0 += Space::to_child(w.joint.SM, on_frame ? pw.V0 : ps[node.parent_station].V0);
    w.V1 = Space::to_child(w.joint.SM, on_frame ? pw.V1 : ps[node.parent_station].V1);
  }
  w.sigma0 = Space::cross(w.V0, w.joint.rate) + w.joint.bias;
  w.sigma = w.sigma0 + Space::cross(w.V1, w.joint.rate);

  if constexpr (N != 0) {
    const double* q = s.positions + node.mode_position;
    const double* q_dot = s.speeds + node.mode_speed;
    auto* stations = at<StrictStationWork<Space>>(s.work, node.work_stations);
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      const StrictStation<Space>& station = node.stations[k];
      if (!station.has_children) continue;
      StrictStationWork<Space>& sw = stations[k];
      sw.V0 = Space::to_child(station.frame, w.V0);
      sw.V1 = Space::to_child(station.frame, w.V1);
      sw.xi.setZero();
      sw.sigma.setZero();
      if (!node.frozen) {
        Twist rate = Twist::Zero();
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
  const Twist momentum = node.I0 * w.V0;
  r.P = node.I0;
  r.T = node.I0;
  r.Q.setZero();
  r.R.setZero();
  r.p0 = Space::cross_force(w.V0, momentum);
  r.p = r.p0 + Space::cross_force(w.V1, momentum) + Space::cross_force(w.V0, node.I0 * w.V1);
}

template <class Space, int N>
[[gnu::flatten]] inline bool strict_inward(const StrictNode<Space>& node, const StrictState<Space>& s) {
  const int n = count<N>(node.modes);
  auto& w = *at<StrictNodeWork<Space>>(s.work, node.work);
  Response<Space>& r = w.response;
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
    if (!solve_general<N>(m.G, n, m.row, m.row0, m.rhs)) return false;
    for (int i = 0; i < n; ++i) {
      r.P -= m.column[i] * m.row[i].transpose();
      r.Q -= m.column[i] * m.row0[i].transpose();
      r.R -= m.column0[i] * m.row[i].transpose();
      r.T -= m.column0[i] * m.row0[i].transpose();
      r.p += m.column[i] * m.rhs[i];
      r.p0 += m.column0[i] * m.rhs[i];
    }
  }

  const JointData<Space>& joint = node.joint;
  if (single(joint.kind)) {
    const int row = JointData<Space>::row(joint.kind);
    const typename Space::Twist column = r.P.col(row) + r.Q.col(row);
    if (!(std::abs(column[row]) > 0)) return false;
    const double inverse = 1 / column[row];
    w.row = r.P.row(row).transpose() * inverse;
    w.row0 = r.Q.row(row).transpose() * inverse;
    w.u = (joint.direction * s.efforts[joint.speed] - r.p[row]) * inverse;
    if (node.parent < 0) return true;
    const typename Space::Twist column0 = r.R.col(row) + r.T.col(row);
    r.P -= column * w.row.transpose();
    r.Q -= column * w.row0.transpose();
    r.R -= column0 * w.row.transpose();
    r.T -= column0 * w.row0.transpose();
    r.p += column * w.u;
    r.p0 += column0 * w.u;
  } else if constexpr (Space::angular == 3) {  // a planar tree has no other hinges
    if (joint.kind != Joint::fixed) {
      const JointColumns<Space> H = motion_subspace<Space>(joint, s.positions + joint.position, s.speeds + joint.speed);
      const JointColumns<Space> columns = (r.P + r.Q) * H;
      const Eigen::PartialPivLU<JointMatrix<Space>> lu(H.transpose() * columns);
      if (!(std::abs(lu.determinant()) > 0)) return false;
      const JointVector<Space> effort =
          Eigen::Map<const Eigen::VectorXd>(s.efforts + joint.speed, static_cast<Eigen::Index>(joint.speeds)) -
          H.transpose() * r.p;
      w.gain = lu.solve(JointRows<Space>(H.transpose() * r.P));
      w.gain0 = lu.solve(JointRows<Space>(H.transpose() * r.Q));
      w.d = lu.solve(effort);
      if (node.parent < 0) return true;
      const JointColumns<Space> columns0 = (r.R + r.T) * H;
      r.P -= columns * w.gain;
      r.Q -= columns * w.gain0;
      r.R -= columns0 * w.gain;
      r.T -= columns0 * w.gain0;
      r.p += columns * w.d;
      r.p0 += columns0 * w.d;
    }
  }
  if (node.parent < 0) return true;
  r.p += r.P * w.sigma + r.Q * w.sigma0;
  r.p0 += r.R * w.sigma + r.T * w.sigma0;
  const StrictNode<Space>& parent = s.nodes[node.parent];
  Response<Space>& outer =
      node.parent_station < 0
          ? at<StrictNodeWork<Space>>(s.work, parent.work)->response
          : at<StrictStationWork<Space>>(s.work, parent.work_stations)[node.parent_station].response;
  const typename Space::Frame& X = w.joint.SM;
  outer.P += Space::matrix_to_parent(X, r.P);
  outer.Q += Space::matrix_to_parent(X, r.Q);
  outer.R += Space::matrix_to_parent(X, r.R);
  outer.T += Space::matrix_to_parent(X, r.T);
  outer.p += Space::to_parent(X, r.p);
  outer.p0 += Space::to_parent(X, r.p0);
  return true;
}

template <class Space, int N>
[[gnu::flatten]] inline void strict_acceleration(const StrictNode<Space>& node, const StrictState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<StrictNodeWork<Space>>(s.work, node.work);
  const Twist* A = s.world;
  const Twist* A0 = s.world;
  if (node.parent >= 0) {
    const StrictNode<Space>& parent = s.nodes[node.parent];
    const auto& pw = *at<StrictNodeWork<Space>>(s.work, parent.work);
    const auto* ps = at<StrictStationWork<Space>>(s.work, parent.work_stations);
    A = node.parent_station < 0 ? &pw.A : &ps[node.parent_station].A;
    A0 = node.parent_station < 0 ? &pw.A0 : &ps[node.parent_station].A0;
  }
  w.A = Space::to_child(w.joint.SM, *A) + w.sigma;
  w.A0 = Space::to_child(w.joint.SM, *A0) + w.sigma0;
  const JointData<Space>& joint = node.joint;
  if (single(joint.kind)) {
    const int row = JointData<Space>::row(joint.kind);
    const double x = w.u - w.row.dot(w.A) - w.row0.dot(w.A0);
    w.A[row] += x;
    w.A0[row] += x;
    s.result[joint.speed] = joint.direction * x;
  } else if constexpr (Space::angular == 3) {
    if (joint.kind != Joint::fixed) {
      const JointVector<Space> x = w.d - w.gain * w.A - w.gain0 * w.A0;
      const Twist rate = motion_subspace<Space>(joint, s.positions + joint.position, s.speeds + joint.speed) * x;
      w.A += rate;
      w.A0 += rate;
      for (Eigen::Index i = 0; i < x.size(); ++i) s.result[joint.speed + static_cast<std::size_t>(i)] = x[i];
    }
  }
  if constexpr (N != 0) {
    const ModalBlock<Space> m(node, s.work, n);
    double* a = s.result + node.mode_speed;
    for (int i = 0; i < n; ++i) a[i] = m.rhs[i] - m.row[i].dot(w.A) - m.row0[i].dot(w.A0);
    auto* stations = at<StrictStationWork<Space>>(s.work, node.work_stations);
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      const StrictStation<Space>& station = node.stations[k];
      if (!station.has_children) continue;
      StrictStationWork<Space>& sw = stations[k];
      sw.A0 = Space::to_child(station.frame, w.A0);
      sw.A = Space::to_child(station.frame, w.A) - Space::cross(sw.xi, sw.A0) + sw.sigma;
      for (int i = 0; i < n; ++i) sw.A += station.J[static_cast<std::size_t>(i)] * a[i];
    }
  }
}

}  // namespace withy::sweep
