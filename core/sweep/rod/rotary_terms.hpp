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

/// Rotary inertia J of four sections about their axes t: J t tᵀ acts on their angular velocity V.w + ω, whose
/// derivative at zero A, q̈ is V.w × ω + b. Partial velocities ∂ω/∂q̇_i are at w + 3 i stride, components a stride apart.
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

/// Adds the rotary inertia of all sections to the integrals of a node, see mass_table.hpp; P: n·angular packs.
template <class Space, int N>
requires(std::is_same_v<Space, Spatial>) inline void collect_sections(const RotaryTable<Space>& table, int modes,
                                                                      const double* q, const double* q_dot,
                                                                      const Spatial::Twist& V, Pack* P,
                                                                      Spatial::Inertia& I, Spatial::Twist* C, double* G,
                                                                      Spatial::Twist& p, double* h) {
  const int n = count<N>(modes);
  const auto at = [](const Pack* v) { return PackVector{v[0], v[1], v[2]}; };
  const auto times = [](const PackVector& v, const Pack& s) { return PackVector{v[0] * s, v[1] * s, v[2] * s}; };
  for (std::size_t k = 0; k < table.packs; ++k) {
    const Pack* psi = table.fields.data() + k * table.stride;
    for (int i = 0; i < 3 * n; ++i) P[i] = psi[i];
    PackVector theta = PackVector::zero(), rate = theta, bias = theta;
    if (table.second_order) {
      const Pack* second = psi + 3 * n;
      for (int i = 0; i < n; ++i) {
        for (int j = i; j < n; ++j, second += 3) {
          const Pack qi = spread(q[i]), qj = spread(q[j]), rates = spread((i == j ? 1.0 : 2.0) * q_dot[i] * q_dot[j]);
          for (int c = 0; c < 3; ++c) {
            P[3 * i + c] += second[c] * qj;
            if (i != j) P[3 * j + c] += second[c] * qi;
            bias[c] += second[c] * rates;
          }
        }
      }
    }
    for (int i = 0; i < n; ++i) {
      const Pack half = spread(0.5 * q[i]), speed = spread(q_dot[i]);
      for (int c = 0; c < 3; ++c) {
        theta[c] += (psi[3 * i + c] + P[3 * i + c]) * half;
        rate[c] += P[3 * i + c] * speed;
      }
    }
    // In the body's axes ω = L θ̇ with the left Jacobian L = 1 + b θ̂ + c θ̂².
    const PackExponential e(theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]);
    const auto left = [&](const PackVector& v) {
      const PackVector x = cross(theta, v);
      return v + times(x, e.b) + times(cross(theta, x), e.c);
    };
    for (int i = 0; i < n; ++i) {
      const PackVector w = left(at(P + 3 * i));
      for (int c = 0; c < 3; ++c) P[3 * i + c] = w[c];
    }
    const PackVector x = cross(theta, rate);
    const Pack s_rate = spread(2.0) * (theta[0] * rate[0] + theta[1] * rate[1] + theta[2] * rate[2]);
    const PackVector turning =
        times(x, e.db * s_rate) + times(cross(theta, x), e.dc * s_rate) + times(cross(rate, x), e.c);
    const PackVector omega = left(rate), b = turning + left(bias);
    for (std::size_t j = 0; j < table.axes_each; ++j) {
      const auto& axis = table.axes[k * table.axes_each + j];
      const PackVector fixed = at(axis.e), y = cross(theta, fixed);
      const PackVector t = fixed + times(y, e.a) + times(cross(theta, y), e.b);
      add_rotary<N>(axis.J, t, omega, b, P, 1, V.w, n, I, C, G, p, h);
    }
  }
}

template <class Space, int N>
requires(Space::angular ==
         1) inline void collect_sections(const RotaryTable<Space>& table, int modes, const typename Space::Scalar* q,
                                         const typename Space::Scalar* q_dot, const typename Space::Twist& /*V*/,
                                         typename Space::Group* P, typename Space::Inertia& I, typename Space::Twist* C,
                                         typename Space::Scalar* G, typename Space::Twist& p,
                                         typename Space::Scalar* h) {
  using Group = typename Space::Group;
  const int n = count<N>(modes);
  for (std::size_t k = 0; k < table.packs; ++k) {
    const Group* psi = table.fields.data() + k * table.stride;
    const Group J = table.axes[k].J;
    for (int i = 0; i < n; ++i) P[i] = psi[i];
    Group bias = spread(typename Space::Scalar(0));
    if (table.second_order) {
      const Group* second = psi + n;
      for (int i = 0; i < n; ++i) {
        for (int j = i; j < n; ++j, ++second) {
          P[i] += *second * spread(q[j]);
          if (i != j) P[j] += *second * spread(q[i]);
          bias += *second * spread((i == j ? 1.0 : 2.0) * q_dot[i] * q_dot[j]);
        }
      }
    }
    const Group moment = J * bias;
    I.ww += sum(J);
    p.w += sum(moment);
    for (int i = 0; i < n; ++i) {
      const Group turn = J * P[i];
      C[i].w += sum(turn);
      h[i] += sum(P[i] * moment);
      for (int j = 0; j <= i; ++j) G[i * n + j] += sum(turn * P[j]);
    }
  }
}

}  // namespace withy::sweep
