/// \file
/// Work memory of the strict sweep, and what enters its modal equations: the body, its stations, and their solution.
#pragma once

#include <algorithm>
#include <cmath>

#include "withy/core/sweep/mass_table.hpp"
#include "withy/core/sweep/strict/strict_sweep.hpp"

namespace withy::sweep {

/// What a subtree answers: F̄ = P Ā + Q A0 + p, F0 = R Ā + T A0 + p0.
template <class Space>
struct Response {
  typename Space::Matrix P, Q, R, T;
  typename Space::Twist p, p0;

  void clear() {
    P = Q = R = T = Space::Matrix::zero();
    p = p0 = Space::Twist::zero();
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

/// Elimination of the rates of a hinge with several: H, and ẍ = d − row·Ā' − row0·A0', one element a rate.
template <class Space>
struct StrictElimination {
  typename Space::Twist H[Space::dim], row[Space::dim], row0[Space::dim];
  double d[Space::dim];
};

template <class Space>
struct StrictNodeWork {
  typename Space::Frame SM;  ///< of JointMotion
  typename Space::Twist V0, V1;
  typename Space::Twist sigma, sigma0;  ///< σ̄ and σ0 of the hinge
  Response<Space> response;
  typename Space::Twist A, A0;
  // One rate: ẍ = u − row·Ā' − row0·A0'. Of a driven hinge `row` keeps p of the response.
  typename Space::Twist row, row0;
  double u;
  StrictElimination<Space> elimination;  ///< several rates
};

template <class Space>
struct StrictState {
  const double* positions;
  const double* speeds;
  double* efforts;  ///< on driven rates overwritten with all efforts there
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
  double *G, *rhs, *scale;

  ModalBlock(const StrictNode<Space>& node, std::byte* work, int n) {
    auto* twists = at<typename Space::Twist>(work, node.work_vectors);
    row = twists;
    row0 = twists + n;
    column = twists + 2 * n;
    column0 = twists + 3 * n;
    J1 = twists + 4 * n;
    G = at<double>(work, node.work_scalars);
    rhs = G + n * n;
    scale = rhs + n;
  }
};

/// LU factorization with partial pivoting of the n×n row-major G, applied to twist rows a, b and scalars c in place.
/// Gives the sign of det G, 0 where a pivot vanishes. Rows have different units: elements of a column are compared by
/// G_ik²/|G_ii|, in which the unit of row i is gone, so that the choice does not depend on the units of mass, length
/// and time; `scale` is room for the n |G_ii| given.
template <int N, class Twist>
inline int solve_general(double* G, int modes, Twist* a, Twist* b, double* c, double* scale) {
  const int n = count<N>(modes);
  for (int i = 0; i < n; ++i) scale[i] = std::abs(G[i * n + i]);
  int sign = 1;
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i) {
      const double here = G[i * n + k], best = G[pivot * n + k];
      const bool better = here * here * scale[pivot] > best * best * scale[i];
      if (better || (best == 0 && here != 0)) pivot = i;
    }
    if (!(std::abs(G[pivot * n + k]) > 0)) return 0;
    if ((pivot != k) != (G[pivot * n + k] < 0)) sign = -sign;
    if (pivot != k) {
      for (int j = k; j < n; ++j) std::swap(G[k * n + j], G[pivot * n + j]);
      std::swap(a[k], a[pivot]);
      std::swap(b[k], b[pivot]);
      std::swap(c[k], c[pivot]);
      std::swap(scale[k], scale[pivot]);
    }
    const double inverse = 1 / G[k * n + k];
    for (int i = k + 1; i < n; ++i) {
      const double m = G[i * n + k] * inverse;
      for (int j = k + 1; j < n; ++j) G[i * n + j] -= m * G[k * n + j];
      a[i] -= a[k] * m;
      b[i] -= b[k] * m;
      c[i] -= m * c[k];
    }
  }
  for (int i = n; i-- > 0;) {
    for (int j = i + 1; j < n; ++j) {
      a[i] -= a[j] * G[i * n + j];
      b[i] -= b[j] * G[i * n + j];
      c[i] -= G[i * n + j] * c[j];
    }
    const double inverse = 1 / G[i * n + i];
    a[i] = a[i] * inverse;
    b[i] = b[i] * inverse;
    c[i] *= inverse;
  }
  return sign;
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
    m.row0[i] = m.column0[i] = Twist::zero();
    m.rhs[i] = 0.5 * dot(node.I1[k], square);
  }
  if (node.frozen) return;
  const auto mixed = Variation<Space>::bilinear(w.V0, w.V1);
  auto I1 = Variation<Space>::zero(), I1_rate = Variation<Space>::zero();
  Twist coupling = Twist::zero();
  for (int k = 0; k < n; ++k) {
    const auto kk = static_cast<std::size_t>(k);
    I1.add(node.I1[kk], q[k]);
    I1_rate.add(node.I1[kk], q_dot[k]);
    coupling += node.C0[kk] * q_dot[k];
    double h = -dot(node.I1[kk], mixed);
    for (int i = 0; i < n; ++i) {
      const auto ki = static_cast<std::size_t>(k * n + i);
      m.row0[i] += node.C1[ki] * q[k];
      // Ċᵀ V − ∂(Vᵀ C q̇)/∂q_k
      h += Space::dot(w.V0, node.C1[static_cast<std::size_t>(i * n + k)] - node.C1[ki]) * q_dot[i];
      h -= 0.5 * dot(node.I2[ki], square) * q[i];
    }
    m.rhs[k] -= h;
  }
  Response<Space>& r = w.response;
  r.Q += Space::Matrix::of(I1.inertia());
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
    m.J1[i] = Twist::zero();
    if (node.frozen) continue;
    for (int k = 0; k < n; ++k) m.J1[i] += station.J1[static_cast<std::size_t>(k * n + i)] * q[k];
  }
  // In terms of (X Ā, X A0): Q' = Q − P Ξ, T' = T − R Ξ with Ξ = ξ ×; forces through 1 + ξ ×* = 1 − Ξᵀ.
  const Matrix Q = s.Q - Space::times_cross(s.P, sw.xi);
  const Matrix T = s.T - Space::times_cross(s.R, sw.xi);
  const Twist p = s.p + s.P * sw.sigma;
  const Twist p0 = s.p0 + s.R * sw.sigma;
  Response<Space>& r = w.response;
  r.P += Space::shift_to_parent(station.X, s.P - Space::cross_transposed_times(sw.xi, s.R));
  r.Q += Space::shift_to_parent(station.X, Q - Space::cross_transposed_times(sw.xi, T));
  r.R += Space::shift_to_parent(station.X, s.R);
  r.T += Space::shift_to_parent(station.X, T);
  r.p += Space::shift_to_parent(station.X, p + Space::cross_force(sw.xi, p0));
  r.p0 += Space::shift_to_parent(station.X, p0);
  for (int i = 0; i < n; ++i) {
    const Twist& J = station.J[static_cast<std::size_t>(i)];
    const Twist PJ = s.P * J;
    const Twist RJ = s.R * J;
    m.column[i] += Space::shift_to_parent(station.X, PJ + Space::cross_force(sw.xi, RJ));
    m.column0[i] += Space::shift_to_parent(station.X, RJ);
    m.row[i] +=
        Space::shift_to_parent(station.X, Space::transposed_times(s.P, J) + Space::transposed_times(s.R, m.J1[i]));
    m.row0[i] += Space::shift_to_parent(station.X, Space::transposed_times(Q, J) + Space::transposed_times(T, m.J1[i]));
    m.rhs[i] -= Space::dot(J, p) + Space::dot(m.J1[i], p0);
    for (int j = 0; j < n; ++j) {
      m.G[j * n + i] += Space::dot(station.J[static_cast<std::size_t>(j)], PJ) + Space::dot(m.J1[j], RJ);
    }
  }
}

}  // namespace withy::sweep
