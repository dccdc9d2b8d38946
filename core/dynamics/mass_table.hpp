/// \file
/// The mass of a flexible body as few generalized particles, and its integrals at a deformed state.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "withy/core/dynamics/sweep_node.hpp"

namespace withy::sweep {

/// Four numbers that the compiler keeps in one or two vector registers; sums over lanes have a fixed order.
using Pack = double __attribute__((vector_size(32)));
constexpr std::size_t lanes = 4;

inline double sum(const Pack& p) { return (p[0] + p[2]) + (p[1] + p[3]); }
inline Pack spread(double a) { return Pack{a, a, a, a}; }

/// Every integral of the equations of motion is bilinear in the fields 1, X, Φ_i, Γ_ij over the mass. An orthonormal
/// basis of the functions that these fields span therefore replaces the particles exactly: fields become the vectors of
/// their coefficients, integrals dot products, and tens of quadrature points become a handful of generalized particles.
/// The first basis function is the constant, so that ∫ f dm = √mass · (first coefficient of f).
template <class Space>
struct MassTable {
  std::size_t packs = 0;      ///< generalized particles / 4, rounded up
  bool second_order = false;  ///< some Γ is there
  double root_mass = 0;       ///< √mass; 0: no particles
  /// For each pack: X (linear), then Φ_i (n·linear), then Γ_ij for i ≤ j (pairs·linear), components innermost.
  std::vector<Pack> data;
  std::size_t stride = 0;  ///< packs of `data` for each pack of particles

  MassTable() = default;
  explicit MassTable(const NodeSpec& node);
};

/// n where it is known at compile time, otherwise a run-time number.
template <int N>
constexpr int count(int n) {
  return N >= 0 ? N : n;
}

/// Adds the particles' integrals at q, q̇ and twist V of the node's frame:
///   I: ∫ of the rigid part; C, G: coupling and modal mass; p, h: velocity terms, so that the particles exert
///   F = I A + C q̈ + p and Q = Cᵀ A + G q̈ + h.
/// With r = X + Φq + ½qᵀΓq, P = Φ + Γq, a = ω×v + ω×(ω×r) + 2 ω×ṙ + q̇ᵀΓq̇:
///   C_i = ∫ (r×P_i; P_i), G_ij = ∫ P_i·P_j, p = ∫ (r×a; a), h_i = ∫ P_i·a.
/// `P` is scratch for n·linear packs.
template <class Space, int N>
inline void integrate(const MassTable<Space>& table, int modes, const double* q, const double* q_dot,
                      const typename Space::Twist& V, Pack* P, typename Space::Matrix& I, typename Space::Twist* C,
                      double* G, typename Space::Twist& p, double* h) {
  constexpr int L = Space::linear;
  constexpr int A = Space::angular;
  const int n = count<N>(modes);
  if (table.root_mass == 0) return;
  for (std::size_t k = 0; k < table.packs; ++k) {
    const Pack* field = table.data.data() + k * table.stride;
    const Pack* phi = field + L;
    const Pack* gamma = phi + n * L;
    Pack r[L], v[L], a[L];
    for (int i = 0; i < n * L; ++i) P[i] = phi[i];
    for (int c = 0; c < L; ++c) {
      r[c] = field[c];
      v[c] = a[c] = spread(0.0);
    }
    if (table.second_order) {
      const Pack* g = gamma;
      for (int i = 0; i < n; ++i) {
        for (int j = i; j < n; ++j, g += L) {
          const Pack qj = spread(q[j]);
          const Pack qi = spread(q[i]);
          const Pack rates = spread((i == j ? 1.0 : 2.0) * q_dot[i] * q_dot[j]);
          for (int c = 0; c < L; ++c) {
            P[i * L + c] += g[c] * qj;
            if (i != j) P[j * L + c] += g[c] * qi;
            a[c] += g[c] * rates;
          }
        }
      }
    }
    for (int i = 0; i < n; ++i) {
      const Pack half = spread(0.5 * q[i]);
      const Pack rate = spread(q_dot[i]);
      for (int c = 0; c < L; ++c) {
        r[c] += (phi[i * L + c] + P[i * L + c]) * half;
        v[c] += P[i * L + c] * rate;
      }
    }
    if constexpr (A == 1) {
      const Pack w2 = spread(V[0] * V[0]);
      const Pack w = spread(2 * V[0]);
      a[0] -= w2 * r[0] + w * v[1];
      a[1] -= w2 * r[1] - w * v[0];
      if (k == 0) {
        // ω×v acts through the constant function.
        a[0][0] -= table.root_mass * V[0] * V[2];
        a[1][0] += table.root_mass * V[0] * V[1];
        const double sx = table.root_mass * r[0][0];
        const double sy = table.root_mass * r[1][0];
        I(0, 1) -= sy;
        I(1, 0) -= sy;
        I(0, 2) += sx;
        I(2, 0) += sx;
        I(1, 1) += table.root_mass * table.root_mass;
        I(2, 2) += table.root_mass * table.root_mass;
        p[1] += table.root_mass * a[0][0];
        p[2] += table.root_mass * a[1][0];
      }
      I(0, 0) += sum(r[0] * r[0] + r[1] * r[1]);
      p[0] += sum(r[0] * a[1] - r[1] * a[0]);
      for (int i = 0; i < n; ++i) {
        const Pack* Pi = P + i * L;
        C[i][0] += sum(r[0] * Pi[1] - r[1] * Pi[0]);
        if (k == 0) {
          C[i][1] += table.root_mass * Pi[0][0];
          C[i][2] += table.root_mass * Pi[1][0];
        }
        h[i] += sum(Pi[0] * a[0] + Pi[1] * a[1]);
        for (int j = 0; j <= i; ++j) G[i * n + j] += sum(Pi[0] * P[j * L] + Pi[1] * P[j * L + 1]);
      }
    } else {
      const double w0 = V[0], w1 = V[1], w2 = V[2];
      // ω×(ω×r) = ω (ω·r) − |ω|² r, as a symmetric matrix.
      const double xx = -(w1 * w1 + w2 * w2), yy = -(w0 * w0 + w2 * w2), zz = -(w0 * w0 + w1 * w1);
      const double xy = w0 * w1, xz = w0 * w2, yz = w1 * w2;
      a[0] += xx * r[0] + xy * r[1] + xz * r[2] + 2 * (w1 * v[2] - w2 * v[1]);
      a[1] += xy * r[0] + yy * r[1] + yz * r[2] + 2 * (w2 * v[0] - w0 * v[2]);
      a[2] += xz * r[0] + yz * r[1] + zz * r[2] + 2 * (w0 * v[1] - w1 * v[0]);
      if (k == 0) {
        const double m = table.root_mass;
        a[0][0] += m * (w1 * V[5] - w2 * V[4]);
        a[1][0] += m * (w2 * V[3] - w0 * V[5]);
        a[2][0] += m * (w0 * V[4] - w1 * V[3]);
        const Eigen::Vector3d s = m * Eigen::Vector3d(r[0][0], r[1][0], r[2][0]);
        const Matrix3 cross = skew<double>(s);
        I.template topRightCorner<3, 3>() += cross;
        I.template bottomLeftCorner<3, 3>() -= cross;
        for (int c = 0; c < 3; ++c) {
          I(3 + c, 3 + c) += m * m;
          p[3 + c] += m * a[c][0];
        }
      }
      const double rxx = sum(r[0] * r[0]), ryy = sum(r[1] * r[1]), rzz = sum(r[2] * r[2]);
      const double rxy = sum(r[0] * r[1]), rxz = sum(r[0] * r[2]), ryz = sum(r[1] * r[2]);
      I(0, 0) += ryy + rzz;
      I(1, 1) += rxx + rzz;
      I(2, 2) += rxx + ryy;
      I(0, 1) -= rxy;
      I(1, 0) -= rxy;
      I(0, 2) -= rxz;
      I(2, 0) -= rxz;
      I(1, 2) -= ryz;
      I(2, 1) -= ryz;
      p[0] += sum(r[1] * a[2] - r[2] * a[1]);
      p[1] += sum(r[2] * a[0] - r[0] * a[2]);
      p[2] += sum(r[0] * a[1] - r[1] * a[0]);
      for (int i = 0; i < n; ++i) {
        const Pack* Pi = P + i * L;
        C[i][0] += sum(r[1] * Pi[2] - r[2] * Pi[1]);
        C[i][1] += sum(r[2] * Pi[0] - r[0] * Pi[2]);
        C[i][2] += sum(r[0] * Pi[1] - r[1] * Pi[0]);
        if (k == 0) {
          for (int c = 0; c < 3; ++c) C[i][3 + c] += table.root_mass * Pi[c][0];
        }
        h[i] += sum(Pi[0] * a[0] + Pi[1] * a[1] + Pi[2] * a[2]);
        for (int j = 0; j <= i; ++j) {
          const Pack* Pj = P + j * L;
          G[i * n + j] += sum(Pi[0] * Pj[0] + Pi[1] * Pj[1] + Pi[2] * Pj[2]);
        }
      }
    }
  }
}

}  // namespace withy::sweep
