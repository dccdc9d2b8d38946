/// \file
/// The integrals over the mass of a body of any number of modes, of one case: of its second-order fields only those
/// that are not zero, several packs of particles at once.
///
/// A beam's bending and twist have few such fields: of n modes of each of three strains 3 n² of 27 n²/2.
#pragma once

#include "withy/core/sweep/mass_table.hpp"

namespace withy::sweep {

/// Whether the mass of a node of N modes is summed by blocks of packs: by these, or by those of straight_rows.hpp.
template <class Space, int N>
constexpr bool has_block_rows = !in_lanes<Space> && N < 0;

/// The generalized particles of B packs at q, q̇: positions, velocities, q̇ᵀΓq̇; of each component those of all packs.
/// Several packs at once, since sums along a row wait for each other.
template <class Space, int B>
struct BlockMotion {
  static constexpr int L = Space::linear;
  using Group = typename Space::Group;
  using Scalar = typename Space::Scalar;
  Group r[L][B], v[L][B], a[L][B];

  /// \param g the block's numbers \param P set to P = Φ + Γq: component c of mode i at (i·L + c)·packs
  BlockMotion(const MassTable<Space>& table, const Group* g, const Scalar* q, const Scalar* q_dot, Group* P) {
    const int n = table.modes, packs = static_cast<int>(table.packs);
    for (int c = 0; c < L; ++c) {
      for (int b = 0; b < B; ++b) {
        r[c][b] = *g++;
        v[c][b] = a[c][b] = spread(Scalar(0));
      }
    }
    for (int i = 0; i < n * L; ++i)
      for (int b = 0; b < B; ++b) P[i * packs + b] = spread(Scalar(0));
    for (int c = 0; c < L; ++c) {
      for (int i = table.with_phi[c].first; i < table.with_phi[c].last; ++i) {
        const Group half = spread(0.5 * q[i]);
        for (int b = 0; b < B; ++b, ++g) {
          P[(i * L + c) * packs + b] = *g;
          r[c][b] += *g * half;
        }
      }
    }
    for (const FieldRun& run : table.block_runs) {
      const int c = run.component;
      add_run<B>(g, B, run.row, run.first, run.last, q, q_dot, P + c * packs, L * packs, a[c]);
      g += (run.last - run.first) * B;
    }
    for (int c = 0; c < L; ++c) {
      for (int i = table.with_partial[c].first; i < table.with_partial[c].last; ++i) {
        const Group half = spread(0.5 * q[i]), rate = spread(q_dot[i]);
        for (int b = 0; b < B; ++b) {
          const Group& partial = P[(i * L + c) * packs + b];
          r[c][b] += partial * half;
          v[c][b] += partial * rate;
        }
      }
    }
  }
};

/// `integrate` of mass_table.hpp, in the table's frame. \param scratch mass_scratch
template <class Space>
inline void integrate_block_rows(const MassTable<Space>& table, const typename Space::Scalar* q,
                                 const typename Space::Scalar* q_dot, const typename Space::Twist& V,
                                 typename Space::Group* scratch, typename Space::Inertia& I, typename Space::Twist* C,
                                 typename Space::Scalar* G, typename Space::Twist& p, typename Space::Scalar* h) {
  using Group = typename Space::Group;
  constexpr int L = Space::linear, block = MassTable<Space>::block;
  const int n = table.modes, packs = static_cast<int>(table.packs);
  const int numbers = static_cast<int>(table.blocks.size() / table.packs);
  Group *r = scratch, *a = r + L * packs, *rows = a + L * packs;
  const auto sweep_block = [&](auto packs_here, int first_pack) {
    constexpr int B = decltype(packs_here)::value;
    const Group* g = table.blocks.data() + first_pack * numbers;
    const BlockMotion<Space, B> x(table, g, q, q_dot, rows + first_pack);
    for (int b = 0; b < B; ++b) {
      const int k = first_pack + b;
      Group here[L], rate[L], bend[L];
      for (int c = 0; c < L; ++c) here[c] = x.r[c][b], rate[c] = x.v[c][b], bend[c] = x.a[c][b];
      add_turning<Space>(V, here, rate, bend);
      if (k == 0) {
        const auto partial = [&](int i, int c) { return rows[(i * L + c) * packs]; };
        add_constant<Space>(table.root_mass, V, here, bend, partial, n, I, C, p);
      }
      for (int c = 0; c < L; ++c) {
        r[c * packs + k] = here[c];
        a[c * packs + k] = bend[c];
      }
    }
  };
  in_blocks<block>(packs, sweep_block);
  add_rows<Space>(r, a, rows, packs, n, I, C, G, p, h);
}

/// Calls integrate(V, I, p) in a table's frame, where it sets the n C, and adds what it finds to that of the node's
/// frame.
template <class Space, class Integrate>
inline void in_frame(const TableFrame<Space>& frame, int n, const typename Space::Twist& V, typename Space::Inertia& I,
                     typename Space::Twist* C, typename Space::Twist& p, const Integrate& integrate) {
  if (!frame.apart) return integrate(V, I, p);
  auto I_here = Space::Inertia::zero();
  auto p_here = Space::Twist::zero();
  integrate(Space::to_child(frame.X, V), I_here, p_here);
  for (int i = 0; i < n; ++i) C[i] = Space::to_parent(frame.X, C[i]);
  I += Space::to_parent(frame.X, I_here);
  p += Space::to_parent(frame.X, p_here);
}

}  // namespace withy::sweep
