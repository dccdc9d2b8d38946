/// \file
/// Rotations along a rod, four at a time.
#pragma once

#include <bit>

#include "withy/core/spatial/pack.hpp"

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

/// sine_cosine of a vector of doubles, Bits a vector of as many integers of 64 bits.
template <class Bits, class Vector>
inline void sine_cosine_of(const Vector& angle, Vector& sine, Vector& cosine) {
  constexpr double shift = 6755399441055744.0;  // 1.5·2⁵²: adding it rounds to an integer, which its last bits keep
  const Vector shifted = angle * 0.6366197723675814 + shift;
  const Bits quadrant = std::bit_cast<Bits>(shifted);
  const Vector multiple = shifted - shift;
  Vector x = angle - multiple * 1.57079632673412561417e+00;  // 33 bits: the product is exact
  x -= multiple * 6.07710050650619224932e-11;
  const Vector z = x * x;
  const auto polynomial = [&](const double(&c)[6]) {
    Vector p = c[4] + z * c[5];
    for (int k = 3; k >= 0; --k) p = c[k] + z * p;
    return p;
  };
  const Vector s =
      x + x * z *
              polynomial({-1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
                          2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10});
  const Vector c =
      1.0 - 0.5 * z +
      z * z *
          polynomial({4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
                      -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11});
  // Odd quadrants exchange the two; the sign follows the second bit.
  const Bits odd = -(quadrant & 1);
  const Bits sine_sign = (quadrant & 2) << 62, cosine_sign = ((quadrant + 1) & 2) << 62;
  const Bits s_bits = std::bit_cast<Bits>(s), c_bits = std::bit_cast<Bits>(c);
  sine = std::bit_cast<Vector>(((s_bits & ~odd) | (c_bits & odd)) ^ sine_sign);
  cosine = std::bit_cast<Vector>(((c_bits & ~odd) | (s_bits & odd)) ^ cosine_sign);
}

/// Sine and cosine of four angles below 1e5 in size, to 1e-16: reduction by multiples of π/2 in two parts (Cody &
/// Waite) and the polynomials of FreeBSD's k_sin.c and k_cos.c on [−π/4, π/4].
inline void sine_cosine(const Pack& angle, Pack& sine, Pack& cosine) {
#ifdef __AVX__
  sine_cosine_of<long __attribute__((vector_size(32)))>(angle, sine, cosine);
#else
  using Bits = long __attribute__((vector_size(16)));
  sine_cosine_of<Bits>(angle.low, sine.low, cosine.low);
  sine_cosine_of<Bits>(angle.high, sine.high, cosine.high);
#endif
}

}  // namespace withy::sweep
