/// \file
/// What a rod at one state gives to the symmetric sweep: its mass integrals and its stations.
#pragma once

#include <optional>

#include "withy/core/sweep/rod/rod_kinematics.hpp"
#include "withy/core/sweep/rod/rotary_terms.hpp"
#include "withy/core/sweep/station_motion.hpp"

namespace withy::sweep {

/// What a rod gives beside the products of its fields: its mass, and the sums r, a of m r and m a over its nodes.
inline void put_linear(double mass, const double* r, const double* a, Planar::Inertia& I, Planar::Twist& p) {
  I += Planar::Inertia{0, -r[1], r[0], mass, 0, mass};
  p += Planar::Twist{0, a[0], a[1]};
}
inline void put_linear(double mass, const double* r, const double* a, Spatial::Inertia& I, Spatial::Twist& p) {
  I.L -= Block::skew(Triple(r[0], r[1], r[2]));
  I.M += Block{{Triple(mass, 0, 0), Triple(0, mass, 0), Triple(0, 0, mass)}};
  p.v += Triple(a[0], a[1], a[2]);
}
/// The same of a partial velocity.
inline void put_linear(const double* P, Planar::Twist& C) { C.x += P[0], C.y += P[1]; }
inline void put_linear(const double* P, Spatial::Twist& C) { C.v += Triple(P[0], P[1], P[2]); }

/// ω × v.
inline Planar::Position carried(const Planar::Twist& V) { return {-V.w * V.y, V.w * V.x}; }
inline Triple carried(const Spatial::Twist& V) { return cross(V.w, V.v); }

/// What the rotary inertia of a rod's sections adds to `integrate`. \param scratch of rod_scratch
template <int N>
inline void integrate_rotary(const RodKinematics<Spatial>& rod, const RodWork& work, int modes, const double* q_dot,
                             const Spatial::Twist& V, Pack* scratch, Spatial::Inertia& I, Spatial::Twist* C, double* G,
                             Spatial::Twist& p, double* h) {
  using Rod = RodKinematics<Spatial>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  const Pack* w = work.value + Rod::w * packs;
  for (int k = 0; k < 3 * packs; ++k) scratch[k] = spread(0.0);
  for (int i = 0; i < n; ++i) {
    const Pack rate = spread(q_dot[i]);
    for (int k = 0; k < 3 * packs; ++k) scratch[k] += w[3 * i * packs + k] * rate;
  }
  constexpr std::size_t step = sizeof(RotaryTable<Spatial>::Axis) / sizeof(Pack);
  Pack* turned = scratch + 3 * packs;
  for (std::size_t j = 0; j < rod.axes_each; ++j) {
    if (!rod.about_axis) {
      for (int k = 0; k < packs; ++k) RodPack{turned + k, packs}.put(0, inertia_axis(rod, n, k, j, work));
    }
    const Pack* t = rod.about_axis ? work.slope + Rod::axis(n) * packs : turned;
    const TurningSections sections{
        packs, w, scratch, work.value + Rod::b(n) * packs, t, &rod.axes[j].J, step * rod.axes_each};
    add_rotary<N>(sections, V.w, n, scratch + 6 * packs, I, C, G, p, h);
  }
}

/// The same in the plane, where the sections' inertia about the normal turns with ψ_i q̇_i and nothing else.
inline void integrate_rotary(const RodKinematics<Planar>& rod, int n, Planar::Inertia& I, Planar::Twist* C, double* G) {
  const double* J = rod.rotary.data();
  I.ww += *J++;
  for (int i = 0; i < n; ++i) C[i].w += *J++;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) G[i * n + j] += J[i * n + j];
}

/// `integrate` of mass_table.hpp over the rod's nodes. r, P_i and a in the work memory become those times root masses,
/// a with what turning adds. \param v scratch: rod_scratch
template <class Space, int N>
inline void integrate(const RodKinematics<Space>& rod, const RodWork& work, int modes, const double* q_dot,
                      const typename Space::Twist& V, Pack* v, typename Space::Inertia& I, typename Space::Twist* C,
                      double* G, typename Space::Twist& p, double* h) {
  using Rod = RodKinematics<Space>;
  constexpr int L = Space::linear;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  const Pack* m = rod.integrals.root_mass.data();
  Pack *r = work.value, *P = work.value + Rod::P(n) * packs, *a = work.value + Rod::a(n) * packs;
  for (int k = 0; k < L * packs; ++k) v[k] = spread(0.0);
  for (int i = 0; i < n; ++i) {
    const Pack rate = spread(q_dot[i]);
    double sums[L];
    for (int c = 0; c < L; ++c) {
      Pack* row = P + (i * L + c) * packs;
      Pack total = spread(0.0);
      for (int k = 0; k < packs; ++k) {
        row[k] = m[k] * row[k];
        v[c * packs + k] += row[k] * rate;
        total += m[k] * row[k];
      }
      sums[c] = sum(total);
    }
    put_linear(sums, C[i]);
  }
  const auto with_frame = carried(V);
  Pack r_sums[L], a_sums[L];
  for (int c = 0; c < L; ++c) r_sums[c] = a_sums[c] = spread(0.0);
  for (int k = 0; k < packs; ++k) {
    Pack here[L], rate[L], acceleration[L];
    for (int c = 0; c < L; ++c) {
      here[c] = m[k] * r[c * packs + k];
      rate[c] = v[c * packs + k];
      acceleration[c] = m[k] * (a[c * packs + k] + spread(with_frame[c]));
    }
    add_turning<Space>(V, here, rate, acceleration);
    for (int c = 0; c < L; ++c) {
      r[c * packs + k] = here[c];
      a[c * packs + k] = acceleration[c];
      r_sums[c] += m[k] * here[c];
      a_sums[c] += m[k] * acceleration[c];
    }
  }
  double of_r[L], of_a[L];
  for (int c = 0; c < L; ++c) of_r[c] = sum(r_sums[c]), of_a[c] = sum(a_sums[c]);
  put_linear(rod.integrals.mass, of_r, of_a, I, p);
  add_rows<Space>(r, a, P, packs, n, I, C, G, p, h);
  if constexpr (Space::angular == 3) {
    if (rod.axes_each > 0) integrate_rotary<N>(rod, work, n, q_dot, V, v, I, C, G, p, h);
  } else if (!rod.rotary.empty()) {
    integrate_rotary(rod, n, I, C, G);
  }
}

/// `station_motion` of a rod's station.
template <int N>
inline void rod_station_motion(const RodKinematics<Planar>& rod, std::size_t station, const RodWork& work, int modes,
                               const double* q, const double* q_dot, StationMotion<Planar>& out, Planar::Twist* J) {
  using Rod = RodKinematics<Planar>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  const auto vector = [&](int function) {
    const Pack* f = work.slope + function * packs;
    return Planar::Position{rod.integrals.to(station, f), rod.integrals.to(station, f + packs)};
  };
  const RodStation<Planar>& at = rod.stations[station];
  Planar::Twist displacement = Planar::Twist::zero();
  for (int i = 0; i < n; ++i) displacement += at.first[static_cast<std::size_t>(i)] * q[i];
  out.frame.R = {std::cos(displacement.w), std::sin(displacement.w)};
  out.frame.p = at.X + Planar::Position{displacement.x, displacement.y} + vector(0);
  const auto back = [&](double w, const Planar::Position& v) {
    return Planar::Twist::of(w, Planar::unrotate(out.frame.R, v));
  };
  out.rate = Planar::Twist::zero();
  for (int i = 0; i < n; ++i) {
    const Planar::Twist& first = at.first[static_cast<std::size_t>(i)];
    J[i] = back(first.w, Planar::Position{first.x, first.y} + vector(Rod::P(n) + 2 * i));
    out.rate += J[i] * q_dot[i];
  }
  const Planar::Twist b = back(0, vector(Rod::a(n)));
  out.bias = {0, b.x + out.rate.w * out.rate.y, b.y - out.rate.w * out.rate.x};
}

template <int N>
inline void rod_station_motion(const RodKinematics<Spatial>& rod, std::size_t station, const RodWork& work, int modes,
                               const double* q, const double* q_dot, StationMotion<Spatial>& out, Spatial::Twist* J) {
  using Rod = RodKinematics<Spatial>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  const auto vector = [&](int function) {
    const Pack* f = work.slope + function * packs;
    return Triple(rod.integrals.to(station, f), rod.integrals.to(station, f + packs),
                  rod.integrals.to(station, f + 2 * packs));
  };
  const Pack turn = work.rotation[rod.first_station + station];
  const PackMatrix R = rotation({spread(turn[0]), {spread(turn[1]), spread(turn[2]), spread(turn[3])}});
  for (int j = 0; j < 3; ++j) out.frame.R.c[j] = Triple(R.column[j][0][0], R.column[j][1][0], R.column[j][2][0]);
  const RodStation<Spatial>& at = rod.stations[station];
  std::optional<RootTurn> root;
  if (!rod.root.empty()) root.emplace(rod.root, n, q, q_dot);
  out.frame.p = at.X + vector(0);
  const Block back = transpose(out.frame.R);
  out.rate = Spatial::Twist::zero();
  for (int i = 0; i < n; ++i) {
    const Spatial::Twist& first = at.first[static_cast<std::size_t>(i)];
    J[i] = {back * (first.w + vector(Rod::w + 3 * i)), back * (first.v + vector(Rod::P(n) + 3 * i))};
    out.frame.p += first.v * q[i];
    if (root) J[i].w += back * root->beyond(rod.root[static_cast<std::size_t>(i)]);
    out.rate += J[i] * q_dot[i];
  }
  out.bias = {back * vector(Rod::b(n)), back * vector(Rod::a(n)) - cross(out.rate.w, out.rate.v)};
  if (root) out.bias.w += back * root->bias();
}

}  // namespace withy::sweep
