/// \file
/// Four numbers that the compiler keeps in one or two vector registers, and vectors of three in them.
#pragma once

#include <cstddef>

namespace withy {

/// Four lanes. Sums over lanes have a fixed order, so that results do not depend on the instruction set's width.
using Pack = double __attribute__((vector_size(32)));
constexpr std::size_t lanes = 4;

inline double sum(const Pack& p) { return (p[0] + p[2]) + (p[1] + p[3]); }
inline Pack spread(double a) { return Pack{a, a, a, a}; }

namespace detail {
/// Lanes of two packs, as a shuffle instruction takes them.
inline Pack shuffle(const Pack& a, const Pack& b, long i, long j, long k, long l) {
  using Lanes = long __attribute__((vector_size(32)));
  return __builtin_shuffle(a, b, Lanes{i, j, k, l});
}
}  // namespace detail

/// A vector of three components; the fourth lane is zero.
struct Triple {
  Pack p;

  Triple() = default;
  Triple(Pack components) : p(components) {}  // NOLINT(google-explicit-constructor): the same thing
  Triple(double x, double y, double z) : p{x, y, z, 0} {}
  static Triple zero() { return Pack{0, 0, 0, 0}; }

  double operator[](int i) const { return p[i]; }
  Triple& operator+=(const Triple& b) { return p += b.p, *this; }
  Triple& operator-=(const Triple& b) { return p -= b.p, *this; }
  friend Triple operator+(const Triple& a, const Triple& b) { return a.p + b.p; }
  friend Triple operator-(const Triple& a, const Triple& b) { return a.p - b.p; }
  friend Triple operator-(const Triple& a) { return -a.p; }
  friend Triple operator*(const Triple& a, double s) { return a.p * spread(s); }
  friend Triple operator*(double s, const Triple& a) { return a.p * spread(s); }
};

inline double dot(const Triple& a, const Triple& b) { return sum(a.p * b.p); }

inline Triple cross(const Triple& a, const Triple& b) {
  const Pack a1 = detail::shuffle(a.p, a.p, 1, 2, 0, 3);
  const Pack b1 = detail::shuffle(b.p, b.p, 1, 2, 0, 3);
  const Pack c = a.p * b1 - a1 * b.p;
  return detail::shuffle(c, c, 1, 2, 0, 3);
}

/// A 3×3 matrix by columns.
struct Block {
  Triple c[3];

  static Block zero() { return {{Triple::zero(), Triple::zero(), Triple::zero()}}; }
  static Block identity() { return {{Triple(1, 0, 0), Triple(0, 1, 0), Triple(0, 0, 1)}}; }
  /// a × as a matrix.
  static Block skew(const Triple& a) {
    return {{Triple(0, a[2], -a[1]), Triple(-a[2], 0, a[0]), Triple(a[1], -a[0], 0)}};
  }
  double operator()(int i, int j) const { return c[j].p[i]; }
  Block& operator+=(const Block& b) {
    for (int j = 0; j < 3; ++j) c[j] += b.c[j];
    return *this;
  }
  Block& operator-=(const Block& b) {
    for (int j = 0; j < 3; ++j) c[j] -= b.c[j];
    return *this;
  }
  friend Block operator+(Block a, const Block& b) { return a += b; }
  friend Block operator-(Block a, const Block& b) { return a -= b; }
  friend Triple operator*(const Block& m, const Triple& v) {
    return m.c[0].p * spread(v.p[0]) + m.c[1].p * spread(v.p[1]) + m.c[2].p * spread(v.p[2]);
  }
  friend Block operator*(const Block& a, const Block& b) { return {{a * b.c[0], a * b.c[1], a * b.c[2]}}; }
  /// Subtracts a bᵀ.
  void subtract_outer(const Triple& a, const Triple& b) {
    for (int j = 0; j < 3; ++j) c[j].p -= a.p * spread(b.p[j]);
  }
};

inline Block transpose(const Block& m) {
  using detail::shuffle;
  const Pack low = shuffle(m.c[0].p, m.c[1].p, 0, 4, 2, 6);   // 00 01 20 21
  const Pack high = shuffle(m.c[0].p, m.c[1].p, 1, 5, 3, 7);  // 10 11 0 0
  return {
      {shuffle(low, m.c[2].p, 0, 1, 4, 7), shuffle(high, m.c[2].p, 0, 1, 5, 7), shuffle(low, m.c[2].p, 2, 3, 6, 7)}};
}

/// mᵀ v.
inline Triple transposed_times(const Block& m, const Triple& v) {
  using detail::shuffle;
  const Pack a = m.c[0].p * v.p, b = m.c[1].p * v.p, c = m.c[2].p * v.p, none = {0, 0, 0, 0};
  const Pack ab = shuffle(a, b, 0, 4, 2, 6) + shuffle(a, b, 1, 5, 3, 7);
  const Pack cc = shuffle(c, none, 0, 4, 2, 6) + shuffle(c, none, 1, 5, 3, 7);
  return shuffle(ab, cc, 0, 1, 4, 5) + shuffle(ab, cc, 2, 3, 6, 7);
}
/// m aˆ, aˆ = a ×.
inline Block times_skew(const Block& m, const Triple& a) {
  const Pack x = spread(a.p[0]), y = spread(a.p[1]), z = spread(a.p[2]);
  return {{m.c[1].p * z - m.c[2].p * y, m.c[2].p * x - m.c[0].p * z, m.c[0].p * y - m.c[1].p * x}};
}
/// aˆ m.
inline Block skew_times(const Triple& a, const Block& m) {
  return {{cross(a, m.c[0]), cross(a, m.c[1]), cross(a, m.c[2])}};
}
/// R m Rᵀ.
inline Block turned(const Block& R, const Block& m) {
  const Block left = R * m;
  Block result;
  for (int j = 0; j < 3; ++j) {
    result.c[j] =
        left.c[0].p * spread(R.c[0].p[j]) + left.c[1].p * spread(R.c[1].p[j]) + left.c[2].p * spread(R.c[2].p[j]);
  }
  return result;
}

}  // namespace withy
