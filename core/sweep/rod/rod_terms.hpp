/// \file
/// What a rod at one state gives to the symmetric sweep: its mass integrals and its stations.
#pragma once

#include "withy/core/sweep/rod/rod_kinematics.hpp"
#include "withy/core/sweep/rod/rotary_terms.hpp"
#include "withy/core/sweep/station_motion.hpp"

namespace withy::sweep {

/// `integrate` of mass_table.hpp over the rod's nodes; P: n·linear packs of scratch.
template <int N>
inline void integrate(const RodKinematics<Planar>& rod, const RodWork& work, int modes, const double* q_dot,
                      const Planar::Twist& V, Pack* P, Planar::Inertia& I, Planar::Twist* C, double* G,
                      Planar::Twist& p, double* h) {
  using Rod = RodKinematics<Planar>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  for (int k = 0; k < packs; ++k) {
    const Pack m = rod.integrals.root_mass[static_cast<std::size_t>(k)];
    const Pack* y = work.value + k;
    Pack r[2] = {m * y[0], m * y[packs]};
    Pack a[2] = {m * (y[Rod::a(n) * packs] - spread(V.w * V.y)), m * (y[(Rod::a(n) + 1) * packs] + spread(V.w * V.x))};
    Pack v[2] = {spread(0.0), spread(0.0)};
    for (int i = 0; i < n; ++i) {
      for (int c = 0; c < 2; ++c) {
        P[i * 2 + c] = m * y[(Rod::P + 2 * i + c) * packs];
        v[c] += P[i * 2 + c] * spread(q_dot[i]);
      }
      C[i].x += sum(m * P[i * 2]);
      C[i].y += sum(m * P[i * 2 + 1]);
    }
    add_turning<Planar>(V, r, v, a);
    I += Planar::Inertia{0, -sum(m * r[1]), sum(m * r[0]), 0, 0, 0};
    p += Planar::Twist{0, sum(m * a[0]), sum(m * a[1])};
    add_products<Planar, N>(r, a, P, n, I, C, G, p, h);
  }
  I += Planar::Inertia{0, 0, 0, rod.integrals.mass, 0, rod.integrals.mass};
}

template <int N>
inline void integrate(const RodKinematics<Spatial>& rod, const RodWork& work, int modes, const double* q_dot,
                      const Spatial::Twist& V, Pack* P, Spatial::Inertia& I, Spatial::Twist* C, double* G,
                      Spatial::Twist& p, double* h) {
  using Rod = RodKinematics<Spatial>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  const Triple carried = cross(V.w, V.v);
  Triple moment = Triple::zero();
  for (int k = 0; k < packs; ++k) {
    const Pack m = rod.integrals.root_mass[static_cast<std::size_t>(k)];
    const Pack* y = work.value + k;
    Pack r[3], a[3], v[3];
    for (int c = 0; c < 3; ++c) {
      r[c] = m * y[c * packs];
      a[c] = m * (y[(Rod::a(n) + c) * packs] + spread(carried[c]));
      v[c] = spread(0.0);
    }
    for (int i = 0; i < n; ++i) {
      for (int c = 0; c < 3; ++c) {
        P[i * 3 + c] = m * y[(Rod::P(n) + 3 * i + c) * packs];
        v[c] += P[i * 3 + c] * spread(q_dot[i]);
      }
      C[i].v += Triple(sum(m * P[i * 3]), sum(m * P[i * 3 + 1]), sum(m * P[i * 3 + 2]));
    }
    add_turning<Spatial>(V, r, v, a);
    moment += Triple(sum(m * r[0]), sum(m * r[1]), sum(m * r[2]));
    p.v += Triple(sum(m * a[0]), sum(m * a[1]), sum(m * a[2]));
    add_products<Spatial, N>(r, a, P, n, I, C, G, p, h);
    if (rod.inertia.empty()) continue;
    const Pack* t = work.slope + Rod::axis(n) * packs + k;
    PackVector omega = PackVector::zero();
    for (int i = 0; i < n; ++i) {
      for (int c = 0; c < 3; ++c) omega[c] += y[(Rod::w + 3 * i + c) * packs] * spread(q_dot[i]);
    }
    const Pack* b = y + Rod::b(n) * packs;
    add_rotary<N>(rod.inertia[static_cast<std::size_t>(k)], {t[0], t[packs], t[2 * packs]}, omega,
                  {b[0], b[packs], b[2 * packs]}, y + Rod::w * packs, packs, V.w, n, I, C, G, p, h);
  }
  I.L -= Block::skew(moment);
  const double mass = rod.integrals.mass;
  I.M += Block{{Triple(mass, 0, 0), Triple(0, mass, 0), Triple(0, 0, mass)}};
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
    J[i] = back(first.w, Planar::Position{first.x, first.y} + vector(Rod::P + 2 * i));
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
  out.frame.p = at.X + vector(0);
  const Block back = transpose(out.frame.R);
  out.rate = Spatial::Twist::zero();
  for (int i = 0; i < n; ++i) {
    const Spatial::Twist& first = at.first[static_cast<std::size_t>(i)];
    J[i] = {back * (first.w + vector(Rod::w + 3 * i)), back * (first.v + vector(Rod::P(n) + 3 * i))};
    out.frame.p += first.v * q[i];
    out.rate += J[i] * q_dot[i];
  }
  out.bias = {back * vector(Rod::b(n)), back * vector(Rod::a(n)) - cross(out.rate.w, out.rate.v)};
}

}  // namespace withy::sweep
