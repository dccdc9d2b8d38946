/// \file
/// The integrals over the mass of a straight beam in a plane, of one case and any number of modes: half of what any
/// body takes.
#pragma once

#include <algorithm>

#include "withy/core/sweep/mass_table.hpp"

namespace withy::sweep {

/// Whether nodes may have them; see MassTable::along.
template <class Space>
constexpr bool has_straight_rows = Space::angular == 1;

/// What moves along the beam in a block of B packs of particles: x = X + ½ qᵀΓq, its rate, q̇ᵀΓq̇, and P = Γq, of mode i
/// at i·packs. Several packs at once, since sums along a row wait for each other.
template <class Space, int B>
struct StraightBlock {
  using Group = typename Space::Group;
  using Scalar = typename Space::Scalar;
  Group x[B], rate[B], bend[B];

  /// \param g X, then Γ_ij for i ≤ j, of the block's packs
  StraightBlock(const Group* g, int n, const Scalar* q, const Scalar* q_dot, Group* P, int packs) {
    for (int b = 0; b < B; ++b) {
      x[b] = g[b];
      rate[b] = bend[b] = spread(Scalar(0));
    }
    g += B;
    for (int i = 0; i < n; ++i)
      for (int b = 0; b < B; ++b) P[i * packs + b] = spread(Scalar(0));
    for (int i = 0; i < n; g += (n - i) * B, ++i) add_run<B>(g, B, i, i, n, q, q_dot, P, packs, bend);
    for (int i = 0; i < n; ++i) {
      const Group half = spread(0.5 * q[i]), speed = spread(q_dot[i]);
      for (int b = 0; b < B; ++b) {
        x[b] += P[i * packs + b] * half;
        rate[b] += P[i * packs + b] * speed;
      }
    }
  }
};

/// `integrate` of mass_table.hpp. \param scratch mass_scratch
template <class Space>
inline void integrate_straight_rows(const MassTable<Space>& table, const typename Space::Scalar* q,
                                    const typename Space::Scalar* q_dot, const typename Space::Twist& V,
                                    typename Space::Group* scratch, typename Space::Inertia& I,
                                    typename Space::Twist* C, typename Space::Scalar* G, typename Space::Twist& p,
                                    typename Space::Scalar* h) {
  using Group = typename Space::Group;
  using Scalar = typename Space::Scalar;
  constexpr int block = MassTable<Space>::block;
  const int n = table.modes, packs = static_cast<int>(table.packs);
  Group *r = scratch, *a = r + 2 * packs, *rows = a + 2 * packs;
  const Group* across = table.across.data();
  const auto sweep_block = [&](auto packs_here, int first_pack) {
    constexpr int B = decltype(packs_here)::value;
    const StraightBlock<Space, B> along(table.along.data() + first_pack * (1 + n * (n + 1) / 2), n, q, q_dot,
                                        rows + first_pack, packs);
    for (int b = 0; b < B; ++b) {
      const int k = first_pack + b;
      Group here[2] = {along.x[b], spread(Scalar(0))}, rate[2] = {along.rate[b], here[1]},
            bend[2] = {along.bend[b], here[1]};
      for (int i = 0; i < n; ++i) {
        const Group phi = across[i * packs + k];
        here[1] += phi * spread(q[i]);
        rate[1] += phi * spread(q_dot[i]);
      }
      add_turning<Space>(V, here, rate, bend);
      if (k == 0) {
        const auto partial = [&](int i, int c) { return (c == 0 ? rows : across)[i * packs]; };
        add_constant<Space>(table.root_mass, V, here, bend, partial, n, I, C, p);
      }
      for (int c = 0; c < 2; ++c) {
        r[c * packs + k] = here[c];
        a[c * packs + k] = bend[c];
      }
    }
  };
  in_blocks<block>(packs, sweep_block);

  Group r_r = spread(Scalar(0)), r_a = r_r;
  for (int k = 0; k < packs; ++k) {
    add_squares<Space>(r + k, packs, &r_r);
    add_moment<Space>(r + k, a + k, packs, &r_a);
  }
  put_squares<Space>(&r_r, I);
  put_moment<Space>(&r_a, p);
  for (int i = 0; i < n; ++i) {
    const Group *Pi = rows + i * packs, *phi = across + i * packs;
    Group r_P = spread(Scalar(0)), P_a = r_P;
    for (int k = 0; k < packs; ++k) {
      r_P += r[k] * phi[k] - r[packs + k] * Pi[k];
      P_a += Pi[k] * a[k] + phi[k] * a[packs + k];
    }
    put_moment<Space>(&r_P, C[i]);
    h[i] += sum(P_a);
    for (int j = 0; j <= i; ++j) G[i * n + j] += table.across_products[static_cast<std::size_t>(i * n + j)];
  }
  add_gram<Scalar>(rows, rows, packs, n, G);
}

}  // namespace withy::sweep
