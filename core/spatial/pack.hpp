/// \file
/// Four numbers that the compiler keeps in one or two vector registers, and vectors of three in them.
#pragma once

#include <cstddef>

namespace withy {

constexpr std::size_t lanes = 4;

#ifdef __AVX__

/// Four lanes. Sums over lanes have a fixed order, so that results do not depend on the instruction set's width.
using Pack = double __attribute__((vector_size(32)));
inline Pack spread(double a) { return Pack{a, a, a, a}; }
inline void set_lane(Pack& p, std::size_t i, double a) { p[i] = a; }
inline void add_to_first(Pack& p, double a) { p[0] += a; }

namespace detail {
/// Lanes i, j, k, l of two packs' eight.
template <int i, int j, int k, int l>
inline Pack shuffle(const Pack& a, const Pack& b) {
  return __builtin_shufflevector(a, b, i, j, k, l);
}
}  // namespace detail

#else

namespace detail {
using Half = double __attribute__((vector_size(16)));
}

/// The same in two registers. A vector type wider than the registers would be taken apart through memory.
struct Pack {
  detail::Half low, high;

  Pack() = default;
  Pack(double a, double b, double c, double d) : low{a, b}, high{c, d} {}
  Pack(const detail::Half& first, const detail::Half& second) : low(first), high(second) {}
  double operator[](std::size_t i) const { return i < 2 ? low[i] : high[i - 2]; }
  Pack& operator+=(const Pack& b) { return low += b.low, high += b.high, *this; }
  Pack& operator-=(const Pack& b) { return low -= b.low, high -= b.high, *this; }
  friend Pack operator+(const Pack& a, const Pack& b) { return {a.low + b.low, a.high + b.high}; }
  friend Pack operator-(const Pack& a, const Pack& b) { return {a.low - b.low, a.high - b.high}; }
  friend Pack operator*(const Pack& a, const Pack& b) { return {a.low * b.low, a.high * b.high}; }
  friend Pack operator*(double s, const Pack& a) { return {a.low * s, a.high * s}; }
  friend Pack operator/(const Pack& a, const Pack& b) { return {a.low / b.low, a.high / b.high}; }
  friend Pack operator-(const Pack& a) { return {-a.low, -a.high}; }
};
inline Pack spread(double a) { return {a, a, a, a}; }
inline void set_lane(Pack& p, std::size_t i, double a) {
  if (i < 2) {
    p.low[i] = a;
  } else {
    p.high[i - 2] = a;
  }
}
inline void add_to_first(Pack& p, double a) { p.low[0] += a; }

namespace detail {
template <int i>
inline const Half& half(const Pack& a, const Pack& b) {
  if constexpr (i < 4) {
    return i < 2 ? a.low : a.high;
  } else {
    return i < 6 ? b.low : b.high;
  }
}
template <int i, int j, int k, int l>
inline Pack shuffle(const Pack& a, const Pack& b) {
  return {__builtin_shufflevector(half<i>(a, b), half<j>(a, b), i % 2, 2 + j % 2),
          __builtin_shufflevector(half<k>(a, b), half<l>(a, b), k % 2, 2 + l % 2)};
}
}  // namespace detail

#endif

inline Pack mirrored(const Pack& p) { return detail::shuffle<3, 2, 1, 0>(p, p); }
inline void store(const Pack& p, double* at) {
  for (std::size_t i = 0; i < lanes; ++i) at[i] = p[i];
}
inline double first(const Pack& p) { return p[0]; }
inline double sum(const Pack& p) { return (p[0] + p[2]) + (p[1] + p[3]); }

/// A vector of three components; the fourth lane is zero.
struct Triple {
  Pack p;

  Triple() = default;
  Triple(Pack components) : p(components) {}  // NOLINT(google-explicit-constructor): the same thing
  Triple(double x, double y, double z) : p{x, y, z, 0} {}
  static Triple zero() { return Pack{0, 0, 0, 0}; }

  double operator[](int i) const { return p[static_cast<std::size_t>(i)]; }
  Triple& operator+=(const Triple& b) { return p += b.p, *this; }
  Triple& operator-=(const Triple& b) { return p -= b.p, *this; }
  friend Triple operator+(const Triple& a, const Triple& b) { return a.p + b.p; }
  friend Triple operator-(const Triple& a, const Triple& b) { return a.p - b.p; }
  friend Triple operator-(const Triple& a) { return -a.p; }
  friend Triple operator*(const Triple& a, double s) { return a.p * spread(s); }
  friend Triple operator*(double s, const Triple& a) { return a.p * spread(s); }
};

inline double dot(const Triple& a, const Triple& b) { return sum(a.p * b.p); }
/// a·b + c·d + e·f, summed over the components last.
inline double dot(const Triple& a, const Triple& b, const Triple& c, const Triple& d) {
  return sum(a.p * b.p + c.p * d.p);
}
inline double dot(const Triple& a, const Triple& b, const Triple& c, const Triple& d, const Triple& e,
                  const Triple& f) {
  return sum(a.p * b.p + c.p * d.p + e.p * f.p);
}
/// Products of the components.
inline Triple products(const Triple& a, const Triple& b) { return a.p * b.p; }

inline Triple cross(const Triple& a, const Triple& b) {
  const Pack a1 = detail::shuffle<1, 2, 0, 3>(a.p, a.p);
  const Pack b1 = detail::shuffle<1, 2, 0, 3>(b.p, b.p);
  const Pack c = a.p * b1 - a1 * b.p;
  return detail::shuffle<1, 2, 0, 3>(c, c);
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
  const Pack low = shuffle<0, 4, 2, 6>(m.c[0].p, m.c[1].p);   // 00 01 20 21
  const Pack high = shuffle<1, 5, 3, 7>(m.c[0].p, m.c[1].p);  // 10 11 0 0
  return {
      {shuffle<0, 1, 4, 7>(low, m.c[2].p), shuffle<0, 1, 5, 7>(high, m.c[2].p), shuffle<2, 3, 6, 7>(low, m.c[2].p)}};
}

/// mᵀ v.
inline Triple transposed_times(const Block& m, const Triple& v) {
  using detail::shuffle;
  const Pack a = m.c[0].p * v.p, b = m.c[1].p * v.p, c = m.c[2].p * v.p, none = {0, 0, 0, 0};
  const Pack ab = shuffle<0, 4, 2, 6>(a, b) + shuffle<1, 5, 3, 7>(a, b);
  const Pack cc = shuffle<0, 4, 2, 6>(c, none) + shuffle<1, 5, 3, 7>(c, none);
  return shuffle<0, 1, 4, 5>(ab, cc) + shuffle<2, 3, 6, 7>(ab, cc);
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
