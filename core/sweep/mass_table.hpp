/// \file
/// The mass of a flexible body as few generalized particles, and its integrals at a deformed state.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "withy/core/sweep/field_runs.hpp"
#include "withy/core/sweep/mass_sums.hpp"
#include "withy/core/sweep/node.hpp"

namespace withy::sweep {

/// Modes in [first, last).
struct ModeRange {
  int first = 0, last = 0;
};

/// The frame in which a node's fields are tabulated: that of the node, or of the body's shape where its axes are
/// others, in which fewer fields are there.
template <class Space>
struct TableFrame {
  bool apart = false;
  typename Space::Frame X = {};  ///< of the shape's frame in the node's

  TableFrame() = default;
  /// Of a node of one case.
  explicit TableFrame(const NodeSpec& node);
  /// The mass, seen from that frame.
  [[nodiscard]] PlacedMass mass(const NodeSpec& node) const { return apart ? node.mass.unmoved() : node.mass; }
};

/// Every integral of the equations of motion is bilinear in the fields 1, X, Φ_i, Γ_ij over the mass. An orthonormal
/// basis of the functions that these fields span therefore replaces the particles exactly: fields become the vectors of
/// their coefficients, integrals dot products, and tens of quadrature points become a handful of generalized particles.
/// The first basis function is the constant, so that ∫ f dm = √mass · (first coefficient of f).
template <class Space>
struct MassTable {
  int modes = 0;                         ///< of the body
  std::size_t rank = 0;                  ///< generalized particles
  std::size_t packs = 0;                 ///< groups of them: rank / 4, rounded up; of several cases at once one each
  bool second_order = false;             ///< some Γ is there
  typename Space::Scalar root_mass = 0;  ///< √mass; 0: no particles
  /// For each pack: X (linear), then Φ_i (n·linear), then Γ_ij for i ≤ j (pairs·linear), components innermost.
  SharedNumbers<typename Space::Group> data;
  std::size_t stride = 0;      ///< packs of `data` for each pack of particles
  std::vector<FieldRun> runs;  ///< of Γ, by component and then by row: all that are not zero
  /// In a plane, with some Γ: X and Γ lie along the first axis, Φ along the second. An unbent beam along that axis.
  bool straight = false;
  /// Of several cases, straight ones of few modes, in the place of `data`: StraightMass.
  SharedNumbers<typename Space::Scalar> products;
  /// Of one case with more modes than known, `block` packs at once, which stand innermost, and of what is left over.
  static constexpr int block = 4;
  /// Straight: X, then Γ_ij for i ≤ j; Φ_i across, of all packs each; products of these, n rows of n. See
  /// straight_rows.hpp.
  SharedNumbers<typename Space::Group> along, across;
  SharedNumbers<typename Space::Scalar> across_products;
  /// Not straight, in `frame`: X; of each component the Φ_i that are not zero; the Γ_ij of `block_runs`. See
  /// block_rows.hpp.
  SharedNumbers<typename Space::Group> blocks;
  TableFrame<Space> frame;
  std::vector<FieldRun> block_runs;
  ModeRange with_phi[Space::linear];      ///< the modes that have a Φ of a component
  ModeRange with_partial[Space::linear];  ///< the modes that have a Φ or a Γ of it

  MassTable() = default;
  explicit MassTable(const NodeSpec& node);

 private:
  void lay_straight();
  void lay_blocks(const Eigen::MatrixXd& fields);
};

/// The generalized particles of one pack at q, q̇: positions r, velocities ṙ, acceleration terms q̇ᵀΓq̇ and partial
/// velocities P = Φ + Γq; n·linear packs of scratch in `P`.
template <class Space, int N>
struct ParticleMotion {
  static constexpr int L = Space::linear;
  using Scalar = typename Space::Scalar;
  using Group = typename Space::Group;
  Group r[L], v[L], a[L];

  ParticleMotion(const MassTable<Space>& table, std::size_t pack, int n, const Scalar* q, const Scalar* q_dot,
                 Group* P) {
    const Group *field = table.data.data() + pack * table.stride, *phi = field + L;
    for (int i = 0; i < n * L; ++i) P[i] = phi[i];
    for (int c = 0; c < L; ++c) {
      r[c] = field[c];
      v[c] = a[c] = spread(Scalar(0));
    }
    if constexpr (N >= 0) {
      if (table.second_order) {
        const Group* g = phi + n * L;
        for (int i = 0; i < n; ++i) {
          const Group qi = spread(q[i]);
          for (int j = i; j < n; ++j, g += L) {
            const Group qj = spread(q[j]);
            const Group rates = spread((i == j ? 1.0 : 2.0) * q_dot[i] * q_dot[j]);
            for (int c = 0; c < L; ++c) {
              P[i * L + c] += g[c] * qj;
              if (i != j) P[j * L + c] += g[c] * qi;
              a[c] += g[c] * rates;
            }
          }
        }
      }
    } else {
      for (const FieldRun& run : table.runs) {
        const Group* g = phi + (n + pair_at(run.row, run.first, n)) * L + run.component;
        add_run<1>(g, L, run.row, run.first, run.last, q, q_dot, P + run.component, L, a + run.component);
      }
    }
    for (int i = 0; i < n; ++i) {
      const Group half = spread(0.5 * q[i]);
      const Group rate = spread(q_dot[i]);
      for (int c = 0; c < L; ++c) {
        r[c] += (phi[i * L + c] + P[i * L + c]) * half;
        v[c] += P[i * L + c] * rate;
      }
    }
  }
};

/// Adds ω×(ω×r) + 2 ω×ṙ to four points' accelerations a.
template <class Space>
requires(Space::angular == 1) inline void add_turning(const typename Space::Twist& V, const typename Space::Group* r,
                                                      const typename Space::Group* v, typename Space::Group* a) {
  const auto w2 = spread(V.w * V.w);
  const auto w = spread(2 * V.w);
  a[0] -= w2 * r[0] + w * v[1];
  a[1] -= w2 * r[1] - w * v[0];
}

template <class Space>
requires(Space::angular == 3) inline void add_turning(const typename Space::Twist& V, const typename Space::Group* r,
                                                      const typename Space::Group* v, typename Space::Group* a) {
  using Scalar = typename Space::Scalar;
  const Scalar w0 = V.w[0], w1 = V.w[1], w2 = V.w[2];
  // ω×(ω×r) = ω (ω·r) − |ω|² r, as a symmetric matrix.
  const Scalar xx = -(w1 * w1 + w2 * w2), yy = -(w0 * w0 + w2 * w2), zz = -(w0 * w0 + w1 * w1);
  const Scalar xy = w0 * w1, xz = w0 * w2, yz = w1 * w2;
  a[0] += xx * r[0] + xy * r[1] + xz * r[2] + 2 * (w1 * v[2] - w2 * v[1]);
  a[1] += xy * r[0] + yy * r[1] + yz * r[2] + 2 * (w2 * v[0] - w0 * v[2]);
  a[2] += xz * r[0] + yz * r[1] + zz * r[2] + 2 * (w0 * v[1] - w1 * v[0]);
}

/// Adds the integrals of four points, fields times root masses, in which the constant function has no part.
template <class Space, int N>
requires(Space::angular == 1) inline void add_products(const typename Space::Group* r, const typename Space::Group* a,
                                                       const typename Space::Group* P, int modes,
                                                       typename Space::Inertia& I, typename Space::Twist* C,
                                                       typename Space::Scalar* G, typename Space::Twist& p,
                                                       typename Space::Scalar* h) {
  const int n = count<N>(modes);
  I.ww += sum(r[0] * r[0] + r[1] * r[1]);
  p.w += sum(r[0] * a[1] - r[1] * a[0]);
  for (int i = 0; i < n; ++i) {
    const auto* Pi = P + i * 2;
    C[i].w += sum(r[0] * Pi[1] - r[1] * Pi[0]);
    h[i] += sum(Pi[0] * a[0] + Pi[1] * a[1]);
    for (int j = 0; j <= i; ++j) G[i * n + j] += sum(Pi[0] * P[j * 2] + Pi[1] * P[j * 2 + 1]);
  }
}

template <class Space, int N>
requires(Space::angular == 3) inline void add_products(const typename Space::Group* r, const typename Space::Group* a,
                                                       const typename Space::Group* P, int modes,
                                                       typename Space::Inertia& I, typename Space::Twist* C,
                                                       typename Space::Scalar* G, typename Space::Twist& p,
                                                       typename Space::Scalar* h) {
  using Scalar = typename Space::Scalar;
  using Triple = typename Space::Triple;
  using Block = typename Space::Block;
  const int n = count<N>(modes);
  const Scalar rxx = sum(r[0] * r[0]), ryy = sum(r[1] * r[1]), rzz = sum(r[2] * r[2]);
  const Scalar rxy = sum(r[0] * r[1]), rxz = sum(r[0] * r[2]), ryz = sum(r[1] * r[2]);
  I.A += Block{{Triple(ryy + rzz, -rxy, -rxz), Triple(-rxy, rxx + rzz, -ryz), Triple(-rxz, -ryz, rxx + ryy)}};
  const auto moment = [&](const typename Space::Group* f) {
    return Triple(sum(r[1] * f[2] - r[2] * f[1]), sum(r[2] * f[0] - r[0] * f[2]), sum(r[0] * f[1] - r[1] * f[0]));
  };
  p.w += moment(a);
  for (int i = 0; i < n; ++i) {
    const auto* Pi = P + i * 3;
    C[i].w += moment(Pi);
    h[i] += sum(Pi[0] * a[0] + Pi[1] * a[1] + Pi[2] * a[2]);
    for (int j = 0; j <= i; ++j) {
      const auto* Pj = P + j * 3;
      G[i * n + j] += sum(Pi[0] * Pj[0] + Pi[1] * Pj[1] + Pi[2] * Pj[2]);
    }
  }
}

/// What the constant function has a part in: the first lane of the first pack. \param P component c of P_i by (i, c)
template <class Space, class Partial>
requires(Space::angular == 1) inline void add_constant(typename Space::Scalar m, const typename Space::Twist& V,
                                                       const typename Space::Group* r, typename Space::Group* a,
                                                       const Partial& P, int n, typename Space::Inertia& I,
                                                       typename Space::Twist* C, typename Space::Twist& p) {
  add_to_first(a[0], -m * V.w * V.y);  // ω×v acts through the constant function
  add_to_first(a[1], m * V.w * V.x);
  I += typename Space::Inertia{0, -m * first(r[1]), m * first(r[0]), m * m, 0, m * m};
  p += typename Space::Twist{0, m * first(a[0]), m * first(a[1])};
  for (int i = 0; i < n; ++i) {
    C[i].x += m * first(P(i, 0));
    C[i].y += m * first(P(i, 1));
  }
}

template <class Space, class Partial>
requires(Space::angular == 3) inline void add_constant(typename Space::Scalar m, const typename Space::Twist& V,
                                                       const typename Space::Group* r, typename Space::Group* a,
                                                       const Partial& P, int n, typename Space::Inertia& I,
                                                       typename Space::Twist* C, typename Space::Twist& p) {
  using Triple = typename Space::Triple;
  const Triple acceleration = cross(V.w, V.v) * m;
  for (int c = 0; c < 3; ++c) add_to_first(a[c], acceleration[c]);
  I.L -= Space::Block::skew(Triple(first(r[0]), first(r[1]), first(r[2])) * m);
  I.M += typename Space::Block{{Triple(m * m, 0, 0), Triple(0, m * m, 0), Triple(0, 0, m * m)}};
  p.v += Triple(first(a[0]), first(a[1]), first(a[2])) * m;
  for (int i = 0; i < n; ++i) C[i].v += Triple(first(P(i, 0)), first(P(i, 1)), first(P(i, 2))) * m;
}

/// Calls action(std::integral_constant<int, B>{}, first) for `block` packs at a time, four, and for what is left over.
template <int block, class Action>
requires(block == 4) inline void in_blocks(int packs, const Action& action) {
  int k = 0;
  for (; k + 4 <= packs; k += 4) action(std::integral_constant<int, 4>{}, k);
  if (packs - k == 3) action(std::integral_constant<int, 3>{}, k);
  if (packs - k == 2) action(std::integral_constant<int, 2>{}, k);
  if (packs - k == 1) action(std::integral_constant<int, 1>{}, k);
}

/// Groups of scratch that `integrate` needs, and what takes its place.
template <class Space>
std::size_t mass_scratch(const MassTable<Space>& table, std::size_t modes) {
  return Space::linear * std::max(modes, (modes + 2) * table.packs);
}

/// Adds the particles' integrals at q, q̇ and twist V of the node's frame:
///   I: ∫ of the rigid part; C, G: coupling and modal mass (lower triangle); p, h: velocity terms, so that the
///   particles exert F = I A + C q̈ + p and Q = Cᵀ A + G q̈ + h.
/// With r = X + Φq + ½qᵀΓq, P = Φ + Γq, a = ω×v + ω×(ω×r) + 2 ω×ṙ + q̇ᵀΓq̇:
///   C_i = ∫ (r×P_i; P_i), G_ij = ∫ P_i·P_j, p = ∫ (r×a; a), h_i = ∫ P_i·a.
/// \param P scratch: N·linear groups
template <class Space, int N>
inline void integrate(const MassTable<Space>& table, int modes, const typename Space::Scalar* q,
                      const typename Space::Scalar* q_dot, const typename Space::Twist& V, typename Space::Group* P,
                      typename Space::Inertia& I, typename Space::Twist* C, typename Space::Scalar* G,
                      typename Space::Twist& p, typename Space::Scalar* h) {
  constexpr int L = Space::linear;
  const int n = count<N>(modes);
  for (std::size_t k = 0; k < table.packs; ++k) {
    ParticleMotion<Space, N> x(table, k, n, q, q_dot, P);
    add_turning<Space>(V, x.r, x.v, x.a);
    if (k == 0) {
      const auto partial = [&](int i, int c) { return P[i * L + c]; };
      add_constant<Space>(table.root_mass, V, x.r, x.a, partial, n, I, C, p);
    }
    add_products<Space, N>(x.r, x.a, P, n, I, C, G, p, h);
  }
}

}  // namespace withy::sweep
