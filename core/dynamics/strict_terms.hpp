/// \file
/// Work memory of the strict sweep, and what enters its modal equations: the body, its stations, and their solution.
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

}  // namespace withy::sweep
