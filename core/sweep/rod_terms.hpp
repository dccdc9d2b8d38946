/// \file
/// What a rod at one state gives to the symmetric sweep: its mass integrals and its stations.
#pragma once

#include "withy/core/sweep/rod_kinematics.hpp"
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
    add_turning(V, r, v, a);
    I += Planar::Inertia{0, -sum(m * r[1]), sum(m * r[0]), 0, 0, 0};
    p += Planar::Twist{0, sum(m * a[0]), sum(m * a[1])};
    add_products<N>(r, a, P, n, I, C, G, p, h);
  }
  I += Planar::Inertia{0, 0, 0, rod.integrals.mass, 0, rod.integrals.mass};
}

/// Rotary inertia J of four sections about their axes t: J t tᵀ acts on their angular velocity V.w + ω, whose
/// derivative at zero A, q̈ is V.w × ω + b.
template <int N>
inline void add_rotary(const Pack& J, const PackVector& t, const PackVector& omega, const PackVector& b, const Pack* w,
                       int stride, const Triple& spin, int modes, Spatial::Inertia& I, Spatial::Twist* C, double* G,
                       Spatial::Twist& p, double* h) {
  const int n = count<N>(modes);
  const auto along = [&](const PackVector& u) { return t[0] * u[0] + t[1] * u[1] + t[2] * u[2]; };
  const auto total = [](const PackVector& u) { return Triple(sum(u[0]), sum(u[1]), sum(u[2])); };
  const auto times = [](const PackVector& u, const Pack& s) { return PackVector{u[0] * s, u[1] * s, u[2] * s}; };
  const PackVector turning{spread(spin[0]), spread(spin[1]), spread(spin[2])};
  const PackVector rate = turning + omega;
  const Pack jerk = J * along(cross(turning, omega) + b), roll = J * along(rate);
  const PackVector moment = times(t, jerk) + times(cross(rate, t), roll);
  p.w += total(moment);
  I.A += Block{{total(times(t, J * t[0])), total(times(t, J * t[1])), total(times(t, J * t[2]))}};
  for (int i = 0; i < n; ++i) {
    const auto partial = [&](int k) {
      const Pack* at = w + 3 * k * stride;
      return PackVector{at[0], at[stride], at[2 * stride]};
    };
    const PackVector wi = partial(i);
    const Pack turn = J * along(wi);
    C[i].w += total(times(t, turn));
    h[i] += sum(wi[0] * moment[0] + wi[1] * moment[1] + wi[2] * moment[2]);
    for (int j = 0; j <= i; ++j) G[i * n + j] += sum(turn * along(partial(j)));
  }
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
    add_turning(V, r, v, a);
    moment += Triple(sum(m * r[0]), sum(m * r[1]), sum(m * r[2]));
    p.v += Triple(sum(m * a[0]), sum(m * a[1]), sum(m * a[2]));
    add_products<N>(r, a, P, n, I, C, G, p, h);
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
