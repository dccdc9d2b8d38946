/// \file
/// Exact kinematics of a rod in the sweeps: constants, in the axes of its node, and its sections at one state, four
/// quadrature nodes a Pack.
///
/// With u_i = R κ_i, ω = Σ w_i q̇_i and t = R e_x along the axis, integrals from the clamped root give
///   r′ = t,   w_i′ = u_i,   P_i′ = w_i × t,   b′ = ω × Σ u_i q̇_i,   a′ = b × t + ω × (ω × t):
/// position, partial velocities, and what remains of the accelerations at q̈ = 0. In a plane R is the turn by
/// Σ ψ_i q_i, w_i = ψ_i and b = 0.
#pragma once

#include <vector>

#include "withy/core/shape/rod_table.hpp"
#include "withy/core/sweep/mass_table.hpp"
#include "withy/core/sweep/rod_rotation.hpp"

namespace withy::sweep {

/// Integrals along a rod, of functions stored one after the other, each `packs` packs of values at the nodes.
struct RodIntegrals {
  static constexpr int packs_per_panel = RodTable::order / static_cast<int>(lanes);

  int packs = 0;                            ///< nodes / 4; 0: no rod
  std::vector<Pack> running;                ///< of a panel, element j·3 + k: what node j gives to the nodes of pack k
  std::vector<Pack> weights;                ///< of a panel
  std::vector<std::vector<Pack>> stations;  ///< ∫₀ˣ to each station, weights of all nodes
  std::vector<Pack> root_mass;              ///< square roots of the nodes' masses
  double mass = 0;

  RodIntegrals() = default;
  RodIntegrals(const RodTable& table, const std::vector<double>& station_x);

  /// y = ∫₀ˣ f at the nodes.
  void integrate(const Pack* f, Pack* y, int functions) const {
    static_assert(packs_per_panel == 3);
    for (int function = 0; function < functions; ++function) {
      double before = 0;
      for (int panel = 0; panel < packs; panel += 3, f += 3, y += 3) {
        Pack y0 = spread(before), y1 = y0, y2 = y0;
        const Pack* from = running.data();
        for (std::size_t j = 0; j < RodTable::order; ++j, from += 3) {
          const Pack value = spread(f[j / lanes][j % lanes]);
          y0 += from[0] * value;
          y1 += from[1] * value;
          y2 += from[2] * value;
        }
        before += sum(weights[0] * f[0] + weights[1] * f[1] + weights[2] * f[2]);
        y[0] = y0, y[1] = y1, y[2] = y2;
      }
    }
  }
  /// ∫₀ˣ f to a station.
  [[nodiscard]] double to(std::size_t station, const Pack* f) const {
    const std::vector<Pack>& w = stations[station];
    Pack total = spread(0.0);
    for (std::size_t k = 0; k < w.size(); ++k) total += w[k] * f[k];
    return sum(total);
  }
};

template <class Space>
struct RodKinematics;

template <>
struct RodKinematics<Planar> {
  RodIntegrals integrals;
  Planar::Position origin = Planar::Position::zero();
  double heading = 0;                              ///< angle of the undeformed rod
  std::vector<Pack> angle;                         ///< ψ_i at node pack k: element k·n + i
  std::vector<std::vector<double>> station_angle;  ///< ψ_i

  RodKinematics() = default;
  explicit RodKinematics(const NodeSpec& spec);

  // Functions and where they stand: t or r, then P_i, then a.
  static constexpr int P = 2;
  static constexpr int a(int n) { return P + 2 * n; }
  static constexpr int functions(int n) { return a(n) + 2; }
};

template <>
struct RodKinematics<Spatial> {
  RodIntegrals integrals;
  Triple origin = Triple::zero(), direction = Triple::zero();  ///< of the undeformed rod
  std::vector<Pack> strain;                                    ///< κ_i at node pack k: element (k·n + i)·3
  std::vector<Pack> step;         ///< nine moments (see magnus) for each i of four turns: element (s·n + i)·9
  std::vector<int> after;         ///< for each turn the turn before it, −1: the root; turns to the nodes come first
  std::vector<Pack> inertia;      ///< of the nodes' sections about their axis; empty where they have none
  std::size_t first_station = 0;  ///< turn to the first station

  RodKinematics() = default;
  explicit RodKinematics(const NodeSpec& spec);

  // Functions and where they stand: t or r, then u_i or w_i, P_i, b, a.
  static constexpr int w = 3;
  static constexpr int P(int n) { return w + 3 * n; }
  static constexpr int b(int n) { return P(n) + 3 * n; }
  static constexpr int a(int n) { return b(n) + 3; }
  static constexpr int functions(int n) { return a(n) + 3; }
};

/// A rod at one state, in the work memory.
struct RodWork {
  Pack* slope;     ///< functions(n)·packs: integrands at the nodes
  Pack* value;     ///< their integrals
  Pack* rotation;  ///< in space: quaternions w, x, y, z, one a turn
};

/// Packs of work memory that a rod needs.
template <class Space>
std::size_t rod_work(const RodKinematics<Space>& rod, int modes) {
  const int values = 2 * RodKinematics<Space>::functions(modes) * rod.integrals.packs;
  std::size_t turns = 0;
  if constexpr (Space::angular == 3) turns = rod.after.size();
  return static_cast<std::size_t>(values) + turns;
}

template <class Space>
RodWork rod_work_at(const RodKinematics<Space>& rod, int modes, Pack* memory) {
  const int values = RodKinematics<Space>::functions(modes) * rod.integrals.packs;
  return {memory, memory + values, memory + 2 * values};
}

/// Fills the work memory at q, q̇.
template <int N>
[[gnu::noinline]] inline void rod_motion(const RodKinematics<Planar>& rod, int modes, const double* q,
                                         const double* q_dot, const RodWork& work) {
  using Rod = RodKinematics<Planar>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  for (int k = 0; k < packs; ++k) {
    const Pack* psi = rod.angle.data() + k * n;
    Pack angle = spread(rod.heading), rate = spread(0.0);
    for (int i = 0; i < n; ++i) {
      angle += psi[i] * spread(q[i]);
      rate += psi[i] * spread(q_dot[i]);
    }
    Pack sine, cosine;
    sine_cosine(angle, sine, cosine);
    Pack* f = work.slope + k;
    f[0] = cosine;
    f[packs] = sine;
    for (int i = 0; i < n; ++i) {
      f[(Rod::P + 2 * i) * packs] = -psi[i] * sine;
      f[(Rod::P + 2 * i + 1) * packs] = psi[i] * cosine;
    }
    const Pack inward = -rate * rate;
    f[Rod::a(n) * packs] = inward * cosine;
    f[(Rod::a(n) + 1) * packs] = inward * sine;
  }
  rod.integrals.integrate(work.slope, work.value, Rod::functions(n));
}

template <int N>
[[gnu::noinline]] inline void rod_motion(const RodKinematics<Spatial>& rod, int modes, const double* q,
                                         const double* q_dot, const RodWork& work) {
  using Rod = RodKinematics<Spatial>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  const auto field = [&](Pack* at, int function) {
    return PackVector{at[function * packs], at[(function + 1) * packs], at[(function + 2) * packs]};
  };
  const auto put = [&](Pack* at, int function, const PackVector& v) {
    for (int c = 0; c < 3; ++c) at[(function + c) * packs] = v[c];
  };
  // Turns from node to node and to the stations, four at a time, then one after the other.
  const std::size_t turns = rod.after.size();
  const Pack* moments = rod.step.data();
  for (std::size_t s = 0; s < turns; s += lanes) {
    PackVector m0 = PackVector::zero(), m1 = m0, m2 = m0;
    for (int i = 0; i < n; ++i, moments += 9) {
      const Pack qi = spread(q[i]);
      for (int c = 0; c < 3; ++c) {
        m0[c] += moments[c] * qi;
        m1[c] += moments[3 + c] * qi;
        m2[c] += moments[6 + c] * qi;
      }
    }
    const PackQuaternion turn = exponential(magnus(m0, m1, m2));
    transpose(turn, work.rotation + s);  // the last pack may be filled with turns by nothing
  }
  for (std::size_t s = 0; s < turns; ++s) {
    if (rod.after[s] >= 0) work.rotation[s] = product(work.rotation[rod.after[s]], work.rotation[s]);
  }
  const PackVector direction{spread(rod.direction[0]), spread(rod.direction[1]), spread(rod.direction[2])};
  for (int k = 0; k < packs; ++k) {
    const PackMatrix R = rotation(untransposed(work.rotation + 4 * k));
    Pack* f = work.slope + k;
    put(f, 0, R * direction);
    const Pack* kappa = rod.strain.data() + k * n * 3;
    for (int i = 0; i < n; ++i, kappa += 3) put(f, Rod::w + 3 * i, R * PackVector{kappa[0], kappa[1], kappa[2]});
  }
  rod.integrals.integrate(work.slope, work.value, Rod::P(n));
  for (int k = 0; k < packs; ++k) {
    Pack* f = work.slope + k;
    Pack* y = work.value + k;
    const PackVector t = field(f, 0);
    PackVector omega = PackVector::zero(), rate = omega;
    for (int i = 0; i < n; ++i) {
      const PackVector w = field(y, Rod::w + 3 * i), u = field(f, Rod::w + 3 * i);
      const Pack qi = spread(q_dot[i]);
      for (int c = 0; c < 3; ++c) {
        omega[c] += w[c] * qi;
        rate[c] += u[c] * qi;
      }
      put(f, Rod::P(n) + 3 * i, cross(w, t));
    }
    put(f, Rod::b(n), cross(omega, rate));
    put(f, Rod::a(n), cross(omega, cross(omega, t)));
  }
  rod.integrals.integrate(work.slope + Rod::P(n) * packs, work.value + Rod::P(n) * packs, 3 * n + 3);
  for (int k = 0; k < packs; ++k) {
    Pack* f = work.slope + k;
    const PackVector more = cross(field(work.value + k, Rod::b(n)), field(f, 0));
    for (int c = 0; c < 3; ++c) f[(Rod::a(n) + c) * packs] += more[c];
  }
  rod.integrals.integrate(work.slope + Rod::a(n) * packs, work.value + Rod::a(n) * packs, 3);
}

}  // namespace withy::sweep
