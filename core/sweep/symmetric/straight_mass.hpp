/// \file
/// The integrals of (3) over the mass of a straight beam in a plane, of several cases at once, in the place of sums
/// over generalized particles: all are polynomials of few products of its fields.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "withy/core/sweep/mass_table.hpp"

namespace withy::sweep {

/// Whether a node of N modes has them. A case by itself takes particles four at a time, which is as fast.
template <class Space, int N>
constexpr bool has_straight_mass = Space::angular == 1 && in_lanes<Space> && (N == 2 || N == 4);

/// Where the integrals stand that a body of N modes needs: of 1, X, Φ_i and Γ_ij and of products of two of these, where
/// X and Γ lie along the first axis and Φ along the second. Of symmetric ones those with i ≤ j.
template <int N>
struct StraightMass {
  /// The pair (i, j) of `of`; of modes, or of pairs of these.
  static constexpr int pair(int i, int j, int of) { return pair_at(std::min(i, j), std::max(i, j), of); }
  static constexpr int pairs = N * (N + 1) / 2;
  static constexpr int m = 0, X = 1, X_X = 2, phi = 3, X_phi = phi + N, phi_phi = X_phi + N, gamma = phi_phi + pairs,
                       X_gamma = gamma + pairs, gamma_phi = X_gamma + pairs, gamma_gamma = gamma_phi + pairs * N,
                       count = gamma_gamma + pairs * (pairs + 1) / 2;
  /// Γ_ij.
  static constexpr int of(int i, int j) { return pair(i, j, N); }
};

/// Those integrals of a table that is straight, one after the other.
template <int N>
std::array<double, StraightMass<N>::count> straight_mass(const MassTable<Planar>& table) {
  using At = StraightMass<N>;
  // Columns of the table's data.
  constexpr std::size_t along = 0, across = 2 + 1, bent = 2 + 2 * N;
  const auto phi = [](int i) { return across + 2 * static_cast<std::size_t>(i); };
  const auto gamma = [](int k) { return bent + 2 * static_cast<std::size_t>(k); };
  const auto value = [&](std::size_t row, std::size_t column) {
    return table.data[row / lanes * table.stride + column][row % lanes];
  };
  const auto dot = [&](std::size_t a, std::size_t b) {
    double sum = 0;
    for (std::size_t row = 0; row < table.rank; ++row) sum += value(row, a) * value(row, b);
    return sum;
  };
  const auto integral = [&](std::size_t a) { return table.root_mass * value(0, a); };
  std::array<double, At::count> all;
  all[At::m] = table.root_mass * table.root_mass, all[At::X] = integral(along), all[At::X_X] = dot(along, along);
  for (int i = 0; i < N; ++i) {
    all[At::phi + i] = integral(phi(i)), all[At::X_phi + i] = dot(along, phi(i));
    for (int j = i; j < N; ++j) all[At::phi_phi + At::of(i, j)] = dot(phi(i), phi(j));
  }
  for (int k = 0; k < At::pairs; ++k) {
    all[At::gamma + k] = integral(gamma(k)), all[At::X_gamma + k] = dot(along, gamma(k));
    for (int i = 0; i < N; ++i) all[At::gamma_phi + k * N + i] = dot(gamma(k), phi(i));
    for (int l = k; l < At::pairs; ++l) all[At::gamma_gamma + At::pair(k, l, At::pairs)] = dot(gamma(k), gamma(l));
  }
  return all;
}

/// Calls f with each number from `begin` up to `end` as a constant, so that places of integrals are known beforehand: a
/// loop that the compiler leaves as one finds them anew each time, which takes longer than the sums.
template <int begin, int end, class F>
inline void each(const F& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) { (f(std::integral_constant<int, begin + k>{}), ...); }
  (std::make_integer_sequence<int, std::max(end - begin, 0)>{});
}

/// As `integrate` of mass_table.hpp, but that C, G and h are set. With s = q̇ᵀΓq̇ and what moves along the first and
/// across, r = (X + ½ P·q, Φ·q), ṙ = (P·q̇, Φ·q̇), P = Γq: what turning adds to the moment of the mass,
/// ∫ r × (ω×(ω×r)), is zero.
template <class Space, int N>
inline void integrate_straight(const typename Space::Scalar* of, const typename Space::Scalar* q,
                               const typename Space::Scalar* q_dot, const typename Space::Twist& V,
                               typename Space::Inertia& I, typename Space::Twist* C, typename Space::Scalar* G,
                               typename Space::Twist& p, typename Space::Scalar* h) {
  using S = typename Space::Scalar;
  using At = StraightMass<N>;
  const auto contracted = [&](const S* gamma, auto i) {  // of integrals with each Γ_ij that with P_i
    S sum = gamma[At::of(i, 0)] * q[0];
    each<1, N>([&](auto j) { sum += gamma[At::of(i, j)] * q[j]; });
    return sum;
  };
  const auto along = [&](const S* a, const S* b) {
    S sum = a[0] * b[0];
    each<1, N>([&](auto j) { sum += a[j] * b[j]; });
    return sum;
  };
  S half[N], rates[At::pairs];  // ½ q; s = Σ Γ rates
  each<0, N>([&](auto i) {
    half[i] = 0.5 * q[i];
    const S twice = q_dot[i] + q_dot[i];
    rates[At::of(i, i)] = q_dot[i] * q_dot[i];
    each<i + 1, N>([&](auto j) { rates[At::of(i, j)] = twice * q_dot[j]; });
  });
  // ∫ P_i·P_j with ∫ P_i s.
  S PP[N * N], Ps[N];
  each<0, N>([&](auto i) {
    S P_gamma[At::pairs];
    each<0, At::pairs>([&](auto k) {
      P_gamma[k] = of[At::gamma_gamma + At::pair(At::of(i, 0), k, At::pairs)] * q[0];
      each<1, N>([&](auto j) { P_gamma[k] += of[At::gamma_gamma + At::pair(At::of(i, j), k, At::pairs)] * q[j]; });
    });
    each<0, i + 1>([&](auto j) { PP[i * N + j] = PP[j * N + i] = contracted(P_gamma, j); });
    Ps[i] = P_gamma[0] * rates[0];
    each<1, At::pairs>([&](auto k) { Ps[i] += P_gamma[k] * rates[k]; });
  });
  // Along the first axis: ∫ P_i, ∫ X·P_i and ∫ r·P_i; across it ∫ r·Φ_i; of both ∫ P_i Φ_j.
  S P[N], XP[N], rP[N], r_phi[N], P_phi[N * N];
  each<0, N>([&](auto i) {
    P[i] = contracted(of + At::gamma, i);
    XP[i] = contracted(of + At::X_gamma, i);
    rP[i] = XP[i] + along(PP + i * N, half);
    r_phi[i] = of[At::phi_phi + At::of(i, 0)] * q[0];
    each<1, N>([&](auto j) { r_phi[i] += of[At::phi_phi + At::of(i, j)] * q[j]; });
    each<0, N>([&](auto j) {
      P_phi[i * N + j] = of[At::gamma_phi + At::of(i, 0) * N + j] * q[0];
      each<1, N>([&](auto k) { P_phi[i * N + j] += of[At::gamma_phi + At::of(i, k) * N + j] * q[k]; });
    });
  });
  const S r_x = of[At::X] + along(P, half), r_y = along(of + At::phi, q);
  const S XX = of[At::X_X] + along(XP, half);  // ∫ X·r
  I += typename Space::Inertia{XX + along(rP, half) + along(r_phi, q), -r_y, r_x, of[At::m], S(0), of[At::m]};
  S s = of[At::gamma] * rates[0], r_s(0);  // ∫ s along; ∫ r·s with r across
  each<1, At::pairs>([&](auto k) { s += of[At::gamma + k] * rates[k]; });
  each<0, At::pairs>([&](auto k) { r_s += along(of + At::gamma_phi + k * N, q) * rates[k]; });
  const S w2 = V.w * V.w, w = V.w + V.w, a_x = -V.w * V.y, a_y = V.w * V.x;  // a: ω×v, everywhere the same
  S moved(0);                                                                // ∫ r·ṙ
  each<0, N>([&](auto i) {
    const S turned = rP[i] + r_phi[i];  // ∫ r·P_i in both directions
    S X_phi = of[At::X_phi + i], v_phi(0);
    each<0, N>([&](auto j) {
      X_phi += P_phi[j * N + i] * half[j];   // ∫ r Φ_i
      v_phi += P_phi[j * N + i] * q_dot[j];  // ∫ ṙ Φ_i
    });
    moved += turned * q_dot[i];
    C[i] = {X_phi - along(P_phi + i * N, q), P[i], of[At::phi + i]};
    h[i] = Ps[i] - w2 * turned + w * (v_phi - along(P_phi + i * N, q_dot)) + a_x * P[i] + a_y * of[At::phi + i];
    each<0, i + 1>([&](auto j) { G[i * N + j] = PP[i * N + j] + of[At::phi_phi + At::of(i, j)]; });
  });
  p += typename Space::Twist{w * moved - r_s + a_y * r_x - a_x * r_y,
                             s - w2 * r_x - w * along(of + At::phi, q_dot) + of[At::m] * a_x,
                             w * along(P, q_dot) - w2 * r_y + of[At::m] * a_y};
}

}  // namespace withy::sweep
