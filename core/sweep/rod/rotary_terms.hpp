/// \file
/// What rotary inertia of sections gives to the symmetric sweep: of the sections of a table, and of those of a rod.
#pragma once

#include <algorithm>
#include <array>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/sweep/mass_table.hpp"
#include "withy/core/sweep/rod/rod_rotation.hpp"
#include "withy/core/sweep/rod/rotary_table.hpp"

namespace withy::sweep {

/// Sections with rotary inertia J about their axes t, in packs; component c of a vector stands c·packs behind its
/// first.
struct TurningSections {
  int packs;
  const Pack* w;      ///< partial velocities ∂ω/∂q̇_i, component c at (3i + c)·packs
  const Pack* omega;  ///< Σ w_i q̇_i
  const Pack* b;      ///< derivative of ω at q̈ = 0 in axes that do not turn with the body
  const Pack* t;      ///< unit vectors
  const Pack* J;      ///< [kg m²] of each pack, `step` apart
  std::size_t step = 1;
};

/// Adds to `integrate` of mass_table.hpp: J t tᵀ acts on V.w + ω, whose derivative at zero A, q̈ is V.w × ω + b.
/// \param scratch rotary_scratch packs
template <int N>
inline void add_rotary(const TurningSections& s, const Triple& spin, int modes, Pack* scratch, Spatial::Inertia& I,
                       Spatial::Twist* C, double* G, Spatial::Twist& p, double* h) {
  const int n = count<N>(modes), packs = s.packs;
  const auto at = [packs](const Pack* v) { return PackVector{v[0], v[packs], v[2 * packs]}; };
  const auto dot = [](const PackVector& u, const PackVector& v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; };
  const auto times = [](const PackVector& u, const Pack& f) { return PackVector{u[0] * f, u[1] * f, u[2] * f}; };
  const auto total = [](const PackVector& u) { return Triple(sum(u[0]), sum(u[1]), sum(u[2])); };
  Pack *moment = scratch, *along = moment + 3 * packs, *turns = along + n * packs;
  const PackVector turning{spread(spin[0]), spread(spin[1]), spread(spin[2])};
  PackVector moments = PackVector::zero(), columns[3] = {moments, moments, moments};
  for (int k = 0; k < packs; ++k) {
    const PackVector t = at(s.t + k), omega = at(s.omega + k), rate = turning + omega;
    const Pack J = s.J[static_cast<std::size_t>(k) * s.step];
    const Pack jerk = J * dot(t, cross(turning, omega) + at(s.b + k)), roll = J * dot(t, rate);
    const PackVector here = times(t, jerk) + times(cross(rate, t), roll);
    for (int c = 0; c < 3; ++c) {
      moment[c * packs + k] = here[c];
      columns[c] = columns[c] + times(t, J * t[c]);
    }
    moments = moments + here;
  }
  p.w += total(moments);
  I.A += Block{{total(columns[0]), total(columns[1]), total(columns[2])}};
  for (int i = 0; i < n; ++i) {
    PackVector coupling = PackVector::zero();
    Pack work = spread(0.0);
    for (int k = 0; k < packs; ++k) {
      const PackVector t = at(s.t + k), w = at(s.w + 3 * i * packs + k);
      const Pack part = dot(t, w), turn = s.J[static_cast<std::size_t>(k) * s.step] * part;
      along[i * packs + k] = part;
      turns[i * packs + k] = turn;
      coupling = coupling + times(t, turn);
      work += dot(w, at(moment + k));
    }
    C[i].w += total(coupling);
    h[i] += sum(work);
  }
  add_gram<double>(turns, along, packs, n, G);
}

/// detail::ExponentialCoefficients of four sections. Up to |θ| = 3 by series: the terms left out are below 1e-19.
struct PackExponential {
  Pack a, b, c, db, dc;

  explicit PackExponential(const Pack& s) {
    const double greatest = std::max(std::max(s[0], s[1]), std::max(s[2], s[3]));
    if (greatest < 9) {
      const int terms = greatest < 0.25 ? 9 : most;
      a = b = c = db = dc = spread(0.0);
      for (int k = terms - 1; k >= 0; --k) {
        a = spread(series[0][k]) + s * a;
        b = spread(series[1][k]) + s * b;
        c = spread(series[2][k]) + s * c;
      }
      for (int k = terms - 1; k >= 1; --k) {
        db = spread(k * series[1][k]) + s * db;
        dc = spread(k * series[2][k]) + s * dc;
      }
      return;
    }
    for (std::size_t i = 0; i < lanes; ++i) {
      const withy::detail::ExponentialCoefficients<double> k(s[i]);
      set_lane(a, i, k.a), set_lane(b, i, k.b), set_lane(c, i, k.c), set_lane(db, i, k.db), set_lane(dc, i, k.dc);
    }
  }

 private:
  static constexpr int most = 17;
  /// (−1)^k / (2k+1)!, (2k+2)!, (2k+3)!
  static constexpr std::array<std::array<double, most>, 3> series = [] {
    std::array<std::array<double, most>, 3> table{};
    for (std::size_t shift = 1; shift <= 3; ++shift) {
      for (std::size_t k = 0; k < most; ++k) {
        double f = k % 2 == 0 ? 1.0 : -1.0;
        for (std::size_t i = 2; i <= 2 * k + shift; ++i) f /= static_cast<double>(i);
        table[shift - 1][k] = f;
      }
    }
    return table;
  }();
};

/// Of a table's sections at q, q̇, for `add_rotary`: P_i = ∂θ/∂q_i at (3i + c)·packs, turned into w_i; θ, θ̇ and q̇ᵀΘq̇ of
/// pack k.
struct SectionAngles {
  PackVector theta, rate, bias;

  SectionAngles(const RotaryTable<Spatial>& table, std::size_t k, int n, const double* q, const double* q_dot, Pack* P)
      : theta(PackVector::zero()), rate(theta), bias(theta) {
    const int packs = static_cast<int>(table.packs);
    const Pack *psi = table.fields.data() + k * table.stride, *second = psi + 3 * n;
    for (int i = 0; i < 3 * n; ++i) P[i * packs] = psi[i];
    for (const FieldRun& run : table.runs) {
      const int c = run.component;
      add_run<1>(second, 1, run.row, run.first, run.last, q, q_dot, P + c * packs, 3 * packs, &bias[c]);
      second += run.last - run.first;
    }
    for (int i = 0; i < n; ++i) {
      const Pack half = spread(0.5 * q[i]), speed = spread(q_dot[i]);
      for (int c = 0; c < 3; ++c) {
        const Pack& partial = P[(3 * i + c) * packs];
        theta[c] += (psi[3 * i + c] + partial) * half;
        rate[c] += partial * speed;
      }
    }
  }
};

/// Adds the rotary inertia of all sections to the integrals of a node, see mass_table.hpp.
/// \param scratch section_scratch
template <class Space, int N>
requires(std::is_same_v<Space, Spatial>) inline void collect_sections(const RotaryTable<Space>& table, int modes,
                                                                      const double* q, const double* q_dot,
                                                                      const Spatial::Twist& V, Pack* scratch,
                                                                      Spatial::Inertia& I, Spatial::Twist* C, double* G,
                                                                      Spatial::Twist& p, double* h) {
  const int n = count<N>(modes), packs = static_cast<int>(table.packs), axes = static_cast<int>(table.axes_each);
  const auto times = [](const PackVector& v, const Pack& s) { return PackVector{v[0] * s, v[1] * s, v[2] * s}; };
  Pack *w = scratch, *omega = w + 3 * n * packs, *b = omega + 3 * packs, *t = b + 3 * packs,
       *rest = t + 3 * axes * packs;
  const auto put = [packs](const PackVector& v, Pack* at) {
    for (int c = 0; c < 3; ++c) at[c * packs] = v[c];
  };
  for (int k = 0; k < packs; ++k) {
    const SectionAngles angles(table, static_cast<std::size_t>(k), n, q, q_dot, w + k);
    const PackVector &theta = angles.theta, &rate = angles.rate;
    // In the body's axes ω = L θ̇ with the left Jacobian L = 1 + b θ̂ + c θ̂².
    const PackExponential e(theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]);
    const auto left = [&](const PackVector& v) {
      const PackVector x = cross(theta, v);
      return v + times(x, e.b) + times(cross(theta, x), e.c);
    };
    for (int i = 0; i < n; ++i) {
      Pack* at = w + 3 * i * packs + k;
      put(left({at[0], at[packs], at[2 * packs]}), at);
    }
    const PackVector x = cross(theta, rate);
    const Pack s_rate = spread(2.0) * (theta[0] * rate[0] + theta[1] * rate[1] + theta[2] * rate[2]);
    const PackVector turning =
        times(x, e.db * s_rate) + times(cross(theta, x), e.dc * s_rate) + times(cross(rate, x), e.c);
    put(left(rate), omega + k);
    put(turning + left(angles.bias), b + k);
    for (int j = 0; j < axes; ++j) {
      const auto& axis = table.axes[static_cast<std::size_t>(k * axes + j)];
      const PackVector fixed{axis.e[0], axis.e[1], axis.e[2]}, y = cross(theta, fixed);
      put(fixed + times(y, e.a) + times(cross(theta, y), e.b), t + 3 * j * packs + k);
    }
  }
  constexpr std::size_t step = sizeof(typename RotaryTable<Space>::Axis) / sizeof(Pack);
  for (int j = 0; j < axes; ++j) {
    const Pack* J = &table.axes[static_cast<std::size_t>(j)].J;
    const TurningSections sections{packs, w, omega, b, t + 3 * j * packs, J, step * table.axes_each};
    add_rotary<N>(sections, V.w, n, rest, I, C, G, p, h);
  }
}

template <class Space, int N>
requires(Space::angular ==
         1) inline void collect_sections(const RotaryTable<Space>& table, int modes, const typename Space::Scalar* q,
                                         const typename Space::Scalar* q_dot, const typename Space::Twist& /*V*/,
                                         typename Space::Group* scratch, typename Space::Inertia& I,
                                         typename Space::Twist* C, typename Space::Scalar* G, typename Space::Twist& p,
                                         typename Space::Scalar* h) {
  using Group = typename Space::Group;
  const int n = count<N>(modes), packs = static_cast<int>(table.packs);
  Group *moment = scratch, *P = moment + packs, *turns = P + n * packs;
  for (int k = 0; k < packs; ++k) {
    const Group *psi = table.fields.data() + static_cast<std::size_t>(k) * table.stride, *second = psi + n;
    const Group J = table.axes[static_cast<std::size_t>(k)].J;
    for (int i = 0; i < n; ++i) P[i * packs + k] = psi[i];
    Group bias = spread(typename Space::Scalar(0));
    for (const FieldRun& run : table.runs) {
      add_run<1>(second, 1, run.row, run.first, run.last, q, q_dot, P + k, packs, &bias);
      second += run.last - run.first;
    }
    moment[k] = J * bias;
    I.ww += sum(J);
    p.w += sum(moment[k]);
    for (int i = 0; i < n; ++i) turns[i * packs + k] = J * P[i * packs + k];
  }
  for (int i = 0; i < n; ++i) {
    Group turn = spread(typename Space::Scalar(0)), work = turn;
    for (int k = 0; k < packs; ++k) {
      turn += turns[i * packs + k];
      work += P[i * packs + k] * moment[k];
    }
    C[i].w += sum(turn);
    h[i] += sum(work);
  }
  add_gram<typename Space::Scalar>(turns, P, packs, n, G);
}

}  // namespace withy::sweep
