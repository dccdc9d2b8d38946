/// \file
/// Exact kinematics of a rod in the sweeps: constants, in the axes of its node, and its sections at one state, four
/// quadrature nodes a Pack.
///
/// With u_i = R κ_i, e_i = R γ_i, ω = Σ w_i q̇_i and t = R (e_x + γ) along the axis, integrals from the root give
///   r′ = t,   w_i′ = u_i,   P_i′ = w_i × t + e_i,   b′ = ω × Σ u_i q̇_i,   a′ = b × t + ω × (ω × t + 2 Σ e_i q̇_i):
/// position, partial velocities, and what remains of the accelerations at q̈ = 0. In a plane R is the turn by
/// Σ ψ_i q_i, w_i = ψ_i and b = 0. What r, w_i, P_i are to first order, X + Φ q, ψ_i, Φ_i, is tabulated; the rest is
/// integrated, as RodTable says: from zero on, but in space from that of the root's turn (rod_root.hpp). Most rods have
/// no γ and no turn of the root, and spend nothing on them.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "withy/core/sweep/rod/rod_integrals.hpp"
#include "withy/core/sweep/rod/rod_root.hpp"
#include "withy/core/sweep/rod/rod_rotation.hpp"
#include "withy/core/sweep/rod/rotary_table.hpp"

namespace withy::sweep {

/// Of several cases at once: there is none.
template <class Space>
struct RodKinematics {};

/// What a station needs beside `RodIntegrals::to`: place and first order of its section.
template <class Space>
struct RodStation {
  typename Space::Position X = Space::Position::zero();  ///< undeformed
  SharedNumbers<typename Space::Twist> first;            ///< (ψ_i; Φ_i)
};

template <>
struct RodKinematics<Planar> {
  RodIntegrals integrals;
  double heading = 0;              ///< angle of the undeformed rod
  SharedNumbers<Pack> X;           ///< undeformed place of node pack k: element 2k
  SharedNumbers<Pack> first;       ///< ψ_i, Φ_i at node pack k: element (k·n + i)·3
  SharedNumbers<Pack> elongation;  ///< γ_i, axes of the node, at node pack k: element (k·n + i)·2; empty: none
  /// Rotary inertia of all sections about the normal, which no bending changes: Σ J, then Σ J ψ_i, then Σ J ψ_i ψ_j,
  /// n×n [kg m²]; empty where there is none.
  SharedNumbers<double> rotary;
  std::vector<RodStation<Planar>> stations;

  RodKinematics() = default;
  explicit RodKinematics(const NodeSpec& spec);
  /// Whether it is that of a node with the same rod in the same place.
  [[nodiscard]] bool fits(const NodeSpec& spec) const;

  // Functions and where they stand: t or r, then P_i, then a.
  static constexpr int P(int /*n*/) { return 2; }
  static constexpr int a(int n) { return P(n) + 2 * n; }
  static constexpr int functions(int n) { return a(n) + 2; }
};

template <>
struct RodKinematics<Spatial> {
  RodIntegrals integrals;
  Triple direction = Triple::zero();  ///< of the undeformed rod
  SharedNumbers<Triple> root;         ///< ψ_i(0); empty: modes do not turn the root
  SharedNumbers<Pack> X;              ///< undeformed place of node pack k: element 3k
  SharedNumbers<Pack> first;          ///< κ_i, ψ_i, Φ_i′, Φ_i at node pack k: element (k·n + i)·12
  SharedNumbers<Pack> elongation;     ///< γ_i, axes of the node, at node pack k: element (k·n + i)·3; empty: none
  SharedNumbers<Pack> step;           ///< nine moments (see magnus) for each i of four turns: element (s·n + i)·9
  SharedNumbers<int> after;           ///< for each turn the turn before it, −1: the root; those to nodes come first
  SharedNumbers<int> pieces;  ///< of each turn those that come before its last one, which is the turn's own step
  std::size_t steps = 0;      ///< of all turns, then of pieces before the last, turn after turn; whole packs
  /// Rotary inertia of the nodes' sections about their principal axes; of node pack k from element k·axes_each on.
  SharedNumbers<RotaryTable<Spatial>::Axis> axes;
  std::size_t axes_each = 0;
  bool about_axis = false;        ///< it is about the rod's own axis alone, which has no γ: at Rod::axis of the slopes
  std::size_t first_station = 0;  ///< turn to the first station
  std::vector<RodStation<Spatial>> stations;

  RodKinematics() = default;
  explicit RodKinematics(const NodeSpec& spec);
  /// Whether it is that of a node with the same rod in the same place.
  [[nodiscard]] bool fits(const NodeSpec& spec) const;

  // Functions and where they stand: t or r, then u_i or w_i, P_i, b, a. Slopes keep t at `axis` as well.
  static constexpr int w = 3;
  static constexpr int P(int n) { return w + 3 * n; }
  static constexpr int b(int n) { return P(n) + 3 * n; }
  static constexpr int a(int n) { return b(n) + 3; }
  static constexpr int axis(int n) { return a(n) + 3; }
  static constexpr int functions(int n) { return axis(n) + 3; }
};

/// A rod at one state, in the work memory.
struct RodWork {
  Pack* slope;     ///< functions(n)·packs: integrands at the nodes, without what is tabulated
  Pack* value;     ///< r, w_i, P_i, b, a there
  Pack* rotation;  ///< in space: quaternions w, x, y, z, one a turn, behind them work memory
};

/// Packs of work memory that a rod needs.
template <class Space>
std::size_t rod_work(const RodKinematics<Space>& rod, int modes) {
  const int values = 2 * RodKinematics<Space>::functions(modes) * rod.integrals.packs;
  std::size_t turns = 0;
  if constexpr (Space::angular == 3) turns = rod.steps;
  return static_cast<std::size_t>(values) + turns;
}

/// Packs of scratch that the integrals over its mass need.
template <class Space>
std::size_t rod_scratch(const RodKinematics<Space>& rod, int modes) {
  int rotary = 0;
  if constexpr (Space::angular == 3) {
    if (rod.axes_each > 0) rotary = 6 * rod.integrals.packs + rotary_scratch(rod.integrals.packs, modes);
  }
  return static_cast<std::size_t>(std::max(Space::linear * rod.integrals.packs, rotary));
}

template <class Space>
RodWork rod_work_at(const RodKinematics<Space>& rod, int modes, Pack* memory) {
  const int values = RodKinematics<Space>::functions(modes) * rod.integrals.packs;
  return {memory, memory + values, memory + 2 * values};
}

/// What γ adds to the integrands of node pack k, at `f`, in the plane. \param turn cosine and sine of the section's
/// turn
template <int N>
inline void add_elongation(const RodKinematics<Planar>& rod, int modes, int k, const double* q, const double* q_dot,
                           const Pack (&turn)[2], const Pack& rate, Pack* f) {
  using Rod = RodKinematics<Planar>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  const Pack *first = rod.first.data() + k * n * 3, *gamma = rod.elongation.data() + k * n * 2;
  Pack along[2] = {spread(0.0), spread(0.0)}, stretching[2] = {along[0], along[0]};
  for (int i = 0; i < n; ++i) {
    const Pack &x = gamma[2 * i], &y = gamma[2 * i + 1];
    const Pack turned[2] = {turn[0] * x - turn[1] * y, turn[1] * x + turn[0] * y};
    for (int c = 0; c < 2; ++c) {
      f[c * packs] -= gamma[2 * i + c] * spread(q[i]);
      f[(Rod::P(n) + 2 * i + c) * packs] += turned[c] - gamma[2 * i + c];
      along[c] += turned[c] * spread(q[i]);
      stretching[c] += turned[c] * spread(q_dot[i]);
    }
  }
  for (int i = 0; i < n; ++i) {
    f[(Rod::P(n) + 2 * i) * packs] -= first[i * 3] * along[1];
    f[(Rod::P(n) + 2 * i + 1) * packs] += first[i * 3] * along[0];
  }
  const Pack twice = rate + rate;
  f[0] += along[0];
  f[packs] += along[1];
  f[Rod::a(n) * packs] -= rate * rate * along[0] + twice * stretching[1];
  f[(Rod::a(n) + 1) * packs] += twice * stretching[0] - rate * rate * along[1];
}

/// Fills the work memory at q, q̇.
template <int N>
[[gnu::noinline]] inline void rod_motion(const RodKinematics<Planar>& rod, int modes, const double* q,
                                         const double* q_dot, const RodWork& work) {
  using Rod = RodKinematics<Planar>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  const double dx = std::cos(rod.heading), dy = std::sin(rod.heading);
  for (int k = 0; k < packs; ++k) {
    const Pack* first = rod.first.data() + k * n * 3;
    Pack angle = spread(0.0), rate = angle;
    for (int i = 0; i < n; ++i) {
      angle += first[i * 3] * spread(q[i]);
      rate += first[i * 3] * spread(q_dot[i]);
    }
    Pack sine, cosine;
    sine_cosine(angle + spread(rod.heading), sine, cosine);
    Pack* f = work.slope + k;
    f[0] = cosine - spread(dx) + angle * spread(dy);
    f[packs] = sine - spread(dy) - angle * spread(dx);
    const Pack across_x = spread(dy) - sine, across_y = cosine - spread(dx);
    for (int i = 0; i < n; ++i) {
      f[(Rod::P(n) + 2 * i) * packs] = first[i * 3] * across_x;
      f[(Rod::P(n) + 2 * i + 1) * packs] = first[i * 3] * across_y;
    }
    const Pack inward = -rate * rate;
    f[Rod::a(n) * packs] = inward * cosine;
    f[(Rod::a(n) + 1) * packs] = inward * sine;
    if (!rod.elongation.empty()) {
      const Pack c = cosine * spread(dx) + sine * spread(dy), s = sine * spread(dx) - cosine * spread(dy);
      add_elongation<N>(rod, n, k, q, q_dot, {c, s}, rate, f);
    }
  }
  rod.integrals.integrate(work.slope, work.value, Rod::functions(n));
  for (int k = 0; k < packs; ++k) {
    const Pack* first = rod.first.data() + k * n * 3;
    Pack* y = work.value + k;
    for (int c = 0; c < 2; ++c) {
      Pack r = rod.X[static_cast<std::size_t>(k * 2 + c)];
      for (int i = 0; i < n; ++i) {
        const Pack& phi = first[i * 3 + 1 + c];
        r += phi * spread(q[i]);
        y[(Rod::P(n) + 2 * i + c) * packs] += phi;
      }
      y[c * packs] += r;
    }
  }
}

/// Turns of the rod's sections at the nodes and stations: from node to node four at a time, then one after the other.
/// \param root  null: it does not turn
template <int N>
inline void rod_turns(const RodKinematics<Spatial>& rod, int modes, const double* q, const RootTurn* root,
                      Pack* rotation) {
  const int n = count<N>(modes);
  const Pack* moments = rod.step.data();
  for (std::size_t s = 0; s < rod.steps; s += lanes) {
    PackVector m0 = PackVector::zero(), m1 = m0, m2 = m0;
    for (int i = 0; i < n; ++i, moments += 9) {
      const Pack qi = spread(q[i]);
      for (int c = 0; c < 3; ++c) {
        m0[c] += moments[c] * qi;
        m1[c] += moments[3 + c] * qi;
        m2[c] += moments[6 + c] * qi;
      }
    }
    transpose(exponential(magnus(m0, m1, m2)), rotation + s);  // the last may hold turns by nothing
  }
  const Pack* piece = rotation + rod.after.size();
  const Pack first = root != nullptr ? root->quaternion() : spread(0.0);
  for (std::size_t s = 0; s < rod.after.size(); ++s) {
    const int last = rod.pieces[s];
    Pack turn = last > 0 ? *piece : rotation[s];
    for (int k = 1; k < last; ++k) turn = product(turn, piece[k]);
    if (last > 0) turn = product(turn, rotation[s]);
    piece += last;
    if (rod.after[s] >= 0) {
      turn = product(rotation[rod.after[s]], turn);
    } else if (root != nullptr) {
      turn = product(first, turn);
    }
    rotation[s] = turn;
  }
}

/// Three functions at one pack of nodes; see RodKinematics<Spatial>.
struct RodPack {
  Pack* at;
  int packs;
  [[nodiscard]] PackVector get(int function) const {
    return {at[function * packs], at[(function + 1) * packs], at[(function + 2) * packs]};
  }
  void put(int function, const PackVector& v) const {
    for (int c = 0; c < 3; ++c) at[(function + c) * packs] = v[c];
  }
};

/// γ of node pack k.
template <int N>
inline PackVector elongation(const RodKinematics<Spatial>& rod, int modes, int k, const double* q) {
  const int n = count<N>(modes);
  PackVector sum = PackVector::zero();
  const Pack* gamma = rod.elongation.data() + k * n * 3;
  for (int i = 0; i < n; ++i, gamma += 3)
    for (int c = 0; c < 3; ++c) sum[c] += gamma[c] * spread(q[i]);
  return sum;
}

/// Where P_i′ will stand: e_i at the turn R of node pack k.
template <int N>
inline void put_elongations(const RodKinematics<Spatial>& rod, int modes, int k, const PackMatrix& R,
                            const RodPack& f) {
  using Rod = RodKinematics<Spatial>;
  const int n = count<N>(modes);
  const Pack* gamma = rod.elongation.data() + k * n * 3;
  for (int i = 0; i < n; ++i, gamma += 3) f.put(Rod::P(n) + 3 * i, R * PackVector{gamma[0], gamma[1], gamma[2]});
}

/// r′ and w_i′ without what is tabulated, the axis and, of a rod that has γ, e_i, at the turns found.
template <int N>
inline void rod_slopes(const RodKinematics<Spatial>& rod, int modes, const double* q, const RodWork& work) {
  using Rod = RodKinematics<Spatial>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  const PackVector direction{spread(rod.direction[0]), spread(rod.direction[1]), spread(rod.direction[2])};
  for (int k = 0; k < packs; ++k) {
    const PackMatrix R = rotation(untransposed(work.rotation + 4 * k));
    const RodPack f{work.slope + k, packs};
    PackVector t = R * direction;
    if (!rod.elongation.empty()) {
      t = t + R * elongation<N>(rod, n, k, q);
      put_elongations<N>(rod, n, k, R, f);
    }
    f.put(Rod::axis(n), t);
    PackVector stretch = t - direction;
    const Pack* first = rod.first.data() + k * n * 12;
    for (int i = 0; i < n; ++i, first += 12) {
      const PackVector kappa{first[0], first[1], first[2]};
      f.put(Rod::w + 3 * i, R * kappa - kappa);
      for (int c = 0; c < 3; ++c) stretch[c] -= first[6 + c] * spread(q[i]);
    }
    f.put(0, stretch);
  }
}

/// Adds what is tabulated to r and w_i, and finds P_i′, b′ and a′ without b × t.
template <int N>
inline void rod_rates(const RodKinematics<Spatial>& rod, int modes, const double* q, const double* q_dot,
                      const RodWork& work) {
  using Rod = RodKinematics<Spatial>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  for (int k = 0; k < packs; ++k) {
    const RodPack f{work.slope + k, packs}, y{work.value + k, packs};
    const PackVector t = f.get(Rod::axis(n));
    const bool stretches = !rod.elongation.empty();
    PackVector omega = PackVector::zero(), rate = omega, stretching = omega;
    const Pack* first = rod.first.data() + k * n * 12;
    for (int i = 0; i < n; ++i, first += 12) {
      const PackVector u = f.get(Rod::w + 3 * i);
      PackVector w = y.get(Rod::w + 3 * i);
      for (int c = 0; c < 3; ++c) {
        w[c] += first[3 + c];
        omega[c] += w[c] * spread(q_dot[i]);
        rate[c] += (u[c] + first[c]) * spread(q_dot[i]);
        y.at[c * packs] += first[9 + c] * spread(q[i]);
      }
      y.put(Rod::w + 3 * i, w);
      PackVector slope = cross(w, t) - PackVector{first[6], first[7], first[8]};
      if (stretches) {
        const PackVector e = f.get(Rod::P(n) + 3 * i);
        slope = slope + e;
        stretching = stretching + e * (2 * q_dot[i]);
      }
      f.put(Rod::P(n) + 3 * i, slope);
    }
    for (int c = 0; c < 3; ++c) y.at[c * packs] += rod.X[static_cast<std::size_t>(3 * k + c)];
    f.put(Rod::b(n), cross(omega, rate));
    const PackVector carried = cross(omega, t);
    f.put(Rod::a(n), cross(omega, stretches ? carried + stretching : carried));
  }
}

/// Adds what is tabulated to P_i, and b × t to a′.
template <int N>
inline void rod_bias(const RodKinematics<Spatial>& rod, int modes, const RodWork& work) {
  using Rod = RodKinematics<Spatial>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  for (int k = 0; k < packs; ++k) {
    const RodPack f{work.slope + k, packs}, y{work.value + k, packs};
    f.put(Rod::a(n), f.get(Rod::a(n)) + cross(y.get(Rod::b(n)), f.get(Rod::axis(n))));
    const Pack* first = rod.first.data() + k * n * 12;
    for (int i = 0; i < n; ++i, first += 12) {
      for (int c = 0; c < 3; ++c) y.at[(Rod::P(n) + 3 * i + c) * packs] += first[9 + c];
    }
  }
}

/// The unit vector of principal axis j of the inertia of node pack k's sections, at the turns found.
inline PackVector inertia_axis(const RodKinematics<Spatial>& rod, int modes, int k, std::size_t j,
                               const RodWork& work) {
  if (rod.about_axis) return RodPack{work.slope + k, rod.integrals.packs}.get(RodKinematics<Spatial>::axis(modes));
  const auto& axis = rod.axes[static_cast<std::size_t>(k) * rod.axes_each + j];
  return rotation(untransposed(work.rotation + 4 * k)) * PackVector{axis.e[0], axis.e[1], axis.e[2]};
}

/// Adds a vector to the values of a function at all nodes.
inline void add_everywhere(const RodKinematics<Spatial>& rod, int function, const Triple& v, const RodWork& work) {
  const int packs = rod.integrals.packs;
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < packs; ++k) work.value[(function + c) * packs + k] += spread(v[c]);
}

template <int N>
[[gnu::noinline]] inline void rod_motion(const RodKinematics<Spatial>& rod, int modes, const double* q,
                                         const double* q_dot, const RodWork& work) {
  using Rod = RodKinematics<Spatial>;
  const int n = count<N>(modes), packs = rod.integrals.packs;
  std::optional<RootTurn> root;
  if (!rod.root.empty()) root.emplace(rod.root, n, q, q_dot);
  rod_turns<N>(rod, modes, q, root ? &*root : nullptr, work.rotation);
  rod_slopes<N>(rod, modes, q, work);
  rod.integrals.integrate(work.slope, work.value, Rod::P(n));
  for (int i = 0; root && i < n; ++i)
    add_everywhere(rod, Rod::w + 3 * i, root->beyond(rod.root[static_cast<std::size_t>(i)]), work);
  rod_rates<N>(rod, modes, q, q_dot, work);
  rod.integrals.integrate(work.slope + Rod::P(n) * packs, work.value + Rod::P(n) * packs, 3 * n + 3);
  if (root) add_everywhere(rod, Rod::b(n), root->bias(), work);
  rod_bias<N>(rod, modes, work);
  rod.integrals.integrate(work.slope + Rod::a(n) * packs, work.value + Rod::a(n) * packs, 3);
}

}  // namespace withy::sweep
