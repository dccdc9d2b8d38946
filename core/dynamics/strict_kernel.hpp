/// \file
/// The three passes of the strict sweep over one node; the relations are in strict_sweep.hpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "withy/core/dynamics/mass_table.hpp"
#include "withy/core/dynamics/strict_sweep.hpp"

namespace withy::sweep {

/// What a subtree answers: F̄ = P Ā + Q A0 + p, F0 = R Ā + T A0 + p0.
template <class Space>
struct Response {
  typename Space::Matrix P, Q, R, T;
  typename Space::Twist p, p0;

  void clear() {
    P.setZero();
    Q.setZero();
    R.setZero();
    T.setZero();
    p.setZero();
    p0.setZero();
  }
};

template <class Space>
struct StrictStationWork {
  typename Space::Twist V0, V1;  ///< twist of S: order zero and one
  typename Space::Twist sigma;   ///< σ1 = V0 × J q̇
  typename Space::Twist xi;      ///< ξ = J q
  Response<Space> response;
  typename Space::Twist A, A0;
};

template <class Space>
struct StrictNodeWork {
  JointMotion<Space> joint;
  typename Space::Twist V0, V1;
  typename Space::Twist sigma, sigma0;  ///< σ̄ and σ0 of the hinge
  Response<Space> response;
  typename Space::Twist A, A0;
  // ẍ = d − gain Ā' − gain0 A0'; local rates, along single rows as in `row`.
  JointRows<Space> gain, gain0;
  JointVector<Space> d;
  typename Space::Twist row, row0;  ///< one rate: the same for it alone
  double u;
};

template <class Space>
struct StrictState {
  const double* positions;
  const double* speeds;
  const double* efforts;
  double* result;
  std::byte* work;
  const StrictNode<Space>* nodes;
  const typename Space::Twist* world;
};

/// The arrays of a node's modal block in its work memory: rows and columns of the equations, n twists each.
template <class Space>
struct ModalBlock {
  typename Space::Twist *row,
      *row0;  ///< coefficients of Ā and A0 in the modal equations; after elimination G⁻¹ of them
  typename Space::Twist *column, *column0;  ///< coefficients of q̈ in F̄ and F0
  typename Space::Twist* J1;                ///< J1(q) of a station
  double *G, *rhs;

  ModalBlock(const StrictNode<Space>& node, std::byte* work, int n) {
    auto* twists = at<typename Space::Twist>(work, node.work_vectors);
    row = twists;
    row0 = twists + n;
    column = twists + 2 * n;
    column0 = twists + 3 * n;
    J1 = twists + 4 * n;
    G = at<double>(work, node.work_scalars);
    rhs = G + n * n;
  }
};

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

/// LU factorization with partial pivoting of the n×n row-major G, applied to twist rows a, b and scalars c in place;
/// false where a pivot vanishes.
template <int N, class Twist>
inline bool solve_general(double* G, int modes, Twist* a, Twist* b, double* c) {
  const int n = count<N>(modes);
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i) {
      if (std::abs(G[i * n + k]) > std::abs(G[pivot * n + k])) pivot = i;
    }
    if (!(std::abs(G[pivot * n + k]) > 0)) return false;
    if (pivot != k) {
      for (int j = k; j < n; ++j) std::swap(G[k * n + j], G[pivot * n + j]);
      a[k].swap(a[pivot]);
      b[k].swap(b[pivot]);
      std::swap(c[k], c[pivot]);
    }
    const double inverse = 1 / G[k * n + k];
    for (int i = k + 1; i < n; ++i) {
      const double m = G[i * n + k] * inverse;
      for (int j = k + 1; j < n; ++j) G[i * n + j] -= m * G[k * n + j];
      a[i] -= m * a[k];
      b[i] -= m * b[k];
      c[i] -= m * c[k];
    }
  }
  for (int i = n; i-- > 0;) {
    for (int j = i + 1; j < n; ++j) {
      a[i] -= G[i * n + j] * a[j];
      b[i] -= G[i * n + j] * b[j];
      c[i] -= G[i * n + j] * c[j];
    }
    const double inverse = 1 / G[i * n + i];
    a[i] *= inverse;
    b[i] *= inverse;
    c[i] *= inverse;
  }
  return true;
}

/// Body terms of the modal equations: order zero and one of ½ Vᵀ I V + Vᵀ C q̇ + ½ q̇ᵀ G q̇ in Lagrange's equations.
template <class Space, int N>
inline void strict_body(const StrictNode<Space>& node, const double* q, const double* q_dot, StrictNodeWork<Space>& w,
                        const ModalBlock<Space>& m) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  const auto square = Variation<Space>::bilinear(w.V0, w.V0);
  for (int i = 0; i < n * n; ++i) m.G[i] = node.G0[static_cast<std::size_t>(i)];
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    m.row[i] = m.column[i] = node.C0[k];
    m.row0[i].setZero();
    m.column0[i].setZero();
    m.rhs[i] = 0.5 * node.I1[k].a.dot(square);
  }
  if (node.frozen) return;
  const auto mixed = Variation<Space>::bilinear(w.V0, w.V1);
  Variation<Space> I1, I1_rate;
  Twist coupling = Twist::Zero();
  for (int k = 0; k < n; ++k) {
    const auto kk = static_cast<std::size_t>(k);
    I1.a += node.I1[kk].a * q[k];
    I1_rate.a += node.I1[kk].a * q_dot[k];
    coupling += node.C0[kk] * q_dot[k];
    double h = -node.I1[kk].a.dot(mixed);
    for (int i = 0; i < n; ++i) {
      const auto ki = static_cast<std::size_t>(k * n + i);
      m.row0[i] += node.C1[ki] * q[k];
      // Ċᵀ V − ∂(Vᵀ C q̇)/∂q_k
      h += w.V0.dot(node.C1[static_cast<std::size_t>(i * n + k)] - node.C1[ki]) * q_dot[i];
      h -= 0.5 * node.I2[ki].a.dot(square) * q[i];
    }
    m.rhs[k] -= h;
  }
  Response<Space>& r = w.response;
  r.Q += I1.matrix();
  r.p += I1_rate.times(w.V0) + Space::cross_force(w.V0, I1.times(w.V0) + coupling);
}

/// A station's subtree, seen from the body.
template <class Space, int N>
inline void strict_station(const StrictNode<Space>& node, const StrictStation<Space>& station,
                           const StrictStationWork<Space>& sw, const double* q, StrictNodeWork<Space>& w,
                           const ModalBlock<Space>& m) {
  using Twist = typename Space::Twist;
  using Matrix = typename Space::Matrix;
  const int n = count<N>(node.modes);
  const Response<Space>& s = sw.response;
  for (int i = 0; i < n; ++i) {
    m.J1[i].setZero();
    if (node.frozen) continue;
    for (int k = 0; k < n; ++k) m.J1[i] += station.J1[static_cast<std::size_t>(k * n + i)] * q[k];
  }
  // In terms of (X Ā, X A0): Q' = Q − P Ξ, T' = T − R Ξ with Ξ = ξ ×; forces through 1 + ξ ×* = 1 − Ξᵀ.
  const Matrix cross = Space::cross_matrix(sw.xi);
  const Matrix Q = s.Q - s.P * cross;
  const Matrix T = s.T - s.R * cross;
  const Twist p = s.p + s.P * sw.sigma;
  const Twist p0 = s.p0 + s.R * sw.sigma;
  Response<Space>& r = w.response;
  r.P += Space::matrix_to_parent(station.frame, Matrix(s.P - cross.transpose() * s.R));
  r.Q += Space::matrix_to_parent(station.frame, Matrix(Q - cross.transpose() * T));
  r.R += Space::matrix_to_parent(station.frame, s.R);
  r.T += Space::matrix_to_parent(station.frame, T);
  r.p += Space::to_parent(station.frame, Twist(p - cross.transpose() * p0));
  r.p0 += Space::to_parent(station.frame, p0);
  for (int i = 0; i < n; ++i) {
    const Twist& J = station.J[static_cast<std::size_t>(i)];
    const Twist PJ = s.P * J;
    const Twist RJ = s.R * J;
    m.column[i] += Space::to_parent(station.frame, Twist(PJ - cross.transpose() * RJ));
    m.column0[i] += Space::to_parent(station.frame, RJ);
    m.row[i] += Space::to_parent(station.frame, Twist(s.P.transpose() * J + s.R.transpose() * m.J1[i]));
    m.row0[i] += Space::to_parent(station.frame, Twist(Q.transpose() * J + T.transpose() * m.J1[i]));
    m.rhs[i] -= J.dot(p) + m.J1[i].dot(p0);
    for (int j = 0; j < n; ++j) m.G[j * n + i] += station.J[static_cast<std::size_t>(j)].dot(PJ) + m.J1[j].dot(RJ);
  }
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
  } else if (joint.kind != Joint::fixed) {
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
  } else if (joint.kind != Joint::fixed) {
    const JointVector<Space> x = w.d - w.gain * w.A - w.gain0 * w.A0;
    const Twist rate = motion_subspace<Space>(joint, s.positions + joint.position, s.speeds + joint.speed) * x;
    w.A += rate;
    w.A0 += rate;
    for (Eigen::Index i = 0; i < x.size(); ++i) s.result[joint.speed + static_cast<std::size_t>(i)] = x[i];
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
