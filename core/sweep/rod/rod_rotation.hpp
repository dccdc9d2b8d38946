/// \file
/// Rotations along a rod, four at a time.
#pragma once

#include "withy/core/spatial/pack.hpp"
#include "withy/core/sweep/sine_cosine.hpp"

namespace withy::sweep {

/// Three components, each of four lanes.
struct PackVector {
  Pack c[3];
  static PackVector zero() { return {spread(0.0), spread(0.0), spread(0.0)}; }
  Pack& operator[](int i) { return c[i]; }
  const Pack& operator[](int i) const { return c[i]; }
  friend PackVector operator+(const PackVector& a, const PackVector& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
  }
  friend PackVector operator-(const PackVector& a, const PackVector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  }
  friend PackVector operator*(const PackVector& a, double s) {
    return {a[0] * spread(s), a[1] * spread(s), a[2] * spread(s)};
  }
  friend PackVector cross(const PackVector& a, const PackVector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
};

/// Rotation vector of the turn over an interval of length h with middle s_m, for R′ = R κ̂: Magnus' expansion of order 6
/// (Blanes, Casas, Oteo & Ros 2009, section 5.4). With κ ≈ k₀ + k₁ (s − s_m) + k₂ (s − s_m)²,
/// a = (h k₀, h² k₁, h³ k₂) and a₀ + a₂/12 = ∫κ, given exactly in place of a₀:
///   θ = ∫κ + (20 a₀ + a₂ + c) × (a₁ − d)/240,  c = a₀ × a₁,  d = a₀ × (c − 2 a₂)/60.
/// The error is of the seventh power of h and vanishes where κ keeps its direction.
inline PackVector magnus(const PackVector& integral, const PackVector& a1, const PackVector& a2) {
  const PackVector a0 = integral - a2 * (1.0 / 12);
  const PackVector c = cross(a0, a1);
  const PackVector d = cross(a0, c - a2 * 2) * (1.0 / 60);
  return integral + cross(a0 * 20 + a2 + c, a1 - d) * (1.0 / 240);
}

struct PackQuaternion {
  Pack w;
  PackVector v;
};

/// Quaternions of rotation vectors. Series of cos and sin x/x in s = (|θ|/2)²; ten terms leave s¹⁰/20!, less than 1e-16
/// of it for turns to 2.6 rad.
inline PackQuaternion exponential(const PackVector& theta) {
  constexpr int terms = 10;
  const Pack s = (theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]) * spread(0.25);
  Pack cosine = spread(1.0), sinc = spread(1.0);
  for (int k = terms - 1; k >= 1; --k) {
    cosine = spread(1.0) - s * spread(1.0 / ((2 * k - 1) * (2 * k))) * cosine;
    sinc = spread(1.0) - s * spread(1.0 / ((2 * k) * (2 * k + 1))) * sinc;
  }
  const Pack half = sinc * spread(0.5);
  return {cosine, {theta[0] * half, theta[1] * half, theta[2] * half}};
}

/// Four quaternions as one pack (w, x, y, z) each.
inline void transpose(const PackQuaternion& q, Pack* out) {
  for (int lane = 0; lane < 4; ++lane) out[lane] = Pack{q.w[lane], q.v[0][lane], q.v[1][lane], q.v[2][lane]};
}
inline PackQuaternion untransposed(const Pack* in) {
  const auto lane = [&](int c) { return Pack{in[0][c], in[1][c], in[2][c], in[3][c]}; };
  return {lane(0), {lane(1), lane(2), lane(3)}};
}

/// Product of two quaternions (w, x, y, z).
inline Pack product(const Pack& a, const Pack& b) {
  using detail::shuffle;
  const Pack x = shuffle<1, 0, 3, 2>(b, b) * Pack{-1, 1, -1, 1};
  const Pack y = shuffle<2, 3, 0, 1>(b, b) * Pack{-1, 1, 1, -1};
  const Pack z = shuffle<3, 2, 1, 0>(b, b) * Pack{-1, -1, 1, 1};
  return (spread(a[0]) * b + spread(a[1]) * x) + (spread(a[2]) * y + spread(a[3]) * z);
}

/// Four rotation matrices by columns.
struct PackMatrix {
  PackVector column[3];
  friend PackVector operator*(const PackMatrix& m, const PackVector& v) {
    PackVector r;
    for (int i = 0; i < 3; ++i) r[i] = m.column[0][i] * v[0] + m.column[1][i] * v[1] + m.column[2][i] * v[2];
    return r;
  }
};

inline PackMatrix rotation(const PackQuaternion& q) {
  const Pack one = spread(1.0);
  const Pack w2 = q.w + q.w, x = q.v[0], y = q.v[1], z = q.v[2];
  const Pack x2 = x + x, y2 = y + y, z2 = z + z;
  const Pack xx = x * x2, yy = y * y2, zz = z * z2, xy = x * y2, xz = x * z2, yz = y * z2;
  const Pack wx = w2 * x, wy = w2 * y, wz = w2 * z;
  return {PackVector{one - (yy + zz), xy + wz, xz - wy}, PackVector{xy - wz, one - (xx + zz), yz + wx},
          PackVector{xz + wy, yz - wx, one - (xx + yy)}};
}

}  // namespace withy::sweep
