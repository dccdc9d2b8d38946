/// \file
/// A number of each of several cases that are computed at once, and vectors and matrices of them. What becomes of a
/// lane depends on that lane alone: no operation mixes two of them.
#pragma once

#include <bit>

#include "withy/core/spatial/pack.hpp"

namespace withy {

#ifdef __AVX512F__
constexpr std::size_t cases_at_once = 8;
using LaneNumbers = double __attribute__((vector_size(64)));
inline LaneNumbers spread_to_lanes(double a) { return LaneNumbers{a, a, a, a, a, a, a, a}; }
inline void set_lane(LaneNumbers& p, std::size_t i, double a) { p[i] = a; }
#else
constexpr std::size_t cases_at_once = lanes;
using LaneNumbers = Pack;
inline LaneNumbers spread_to_lanes(double a) { return spread(a); }
#endif

/// A set of lanes, a bit each: those for which something holds.
struct LaneSet {
  unsigned bits = 0;
  static constexpr LaneSet all() { return {(1U << cases_at_once) - 1}; }
  [[nodiscard]] bool has(std::size_t lane) const { return (bits >> lane & 1U) != 0; }
  friend LaneSet operator&(LaneSet a, LaneSet b) { return {a.bits & b.bits}; }
};
inline bool none(LaneSet set) { return set.bits == 0; }
inline bool none(bool holds) { return !holds; }

/// One number of each case. A plain number stands for the same in all of them.
struct Lanes {
  LaneNumbers p;

  Lanes() = default;
  // Written out: as a copy of its bytes it would go through memory.
  Lanes(const Lanes& a) : p(a.p) {}
  Lanes& operator=(const Lanes& a) { return p = a.p, *this; }
  Lanes(double a)
      : p(spread_to_lanes(a)) {}  // NOLINT(google-explicit-constructor): constants stand in formulas as they are
  static Lanes of(const LaneNumbers& p) {
    Lanes a;
    a.p = p;
    return a;
  }
  double operator[](std::size_t lane) const { return p[lane]; }
  void set(std::size_t lane, double a) { set_lane(p, lane, a); }
  Lanes& operator+=(const Lanes& b) { return p += b.p, *this; }
  Lanes& operator-=(const Lanes& b) { return p -= b.p, *this; }
  friend Lanes operator+(const Lanes& a, const Lanes& b) { return of(a.p + b.p); }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return of(a.p - b.p); }
  friend Lanes operator-(const Lanes& a) { return of(-a.p); }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return of(a.p * b.p); }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return of(a.p / b.p); }
};

/// Where a pivot is positive; of a plain number whether it is.
inline LaneSet positive(const Lanes& a) {
#ifdef __AVX512F__
  using Bits = long long __attribute__((vector_size(64)));
  return {static_cast<unsigned>(__builtin_ia32_cvtq2mask512(std::bit_cast<Bits>(a.p > spread_to_lanes(0.0))))};
#elif defined(__AVX__)
  return {static_cast<unsigned>(__builtin_ia32_movmskpd256(std::bit_cast<Pack>(a.p > spread(0.0))))};
#else
  LaneSet set;
  for (std::size_t i = 0; i < cases_at_once; ++i) set.bits |= a[i] > 0 ? 1U << i : 0U;
  return set;
#endif
}
inline bool positive(double a) { return a > 0; }

/// What holds for all cases of a scalar.
template <class S>
constexpr auto everywhere() {
  return true;
}
template <>
constexpr auto everywhere<Lanes>() {
  return LaneSet::all();
}

/// What integrals over a body take at a time of its points: of one case a pack, of several cases one each.
template <class S>
struct GroupFor {
  using Type = Pack;
};
template <>
struct GroupFor<Lanes> {
  using Type = Lanes;
};
template <class S>
using GroupOf = typename GroupFor<S>::Type;

inline Lanes spread(const Lanes& a) { return a; }
inline Lanes sum(const Lanes& a) { return a; }
inline Lanes first(const Lanes& a) { return a; }
inline void add_to_first(Lanes& a, const Lanes& b) { a += b; }

/// A vector of three components.
struct LaneTriple {
  Lanes c[3];

  LaneTriple() = default;
  LaneTriple(const Lanes& x, const Lanes& y, const Lanes& z) : c{x, y, z} {}
  static LaneTriple zero() { return {0.0, 0.0, 0.0}; }
  const Lanes& operator[](int i) const { return c[i]; }
  LaneTriple& operator+=(const LaneTriple& b) { return c[0] += b[0], c[1] += b[1], c[2] += b[2], *this; }
  LaneTriple& operator-=(const LaneTriple& b) { return c[0] -= b[0], c[1] -= b[1], c[2] -= b[2], *this; }
  friend LaneTriple operator+(const LaneTriple& a, const LaneTriple& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
  }
  friend LaneTriple operator-(const LaneTriple& a, const LaneTriple& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  }
  friend LaneTriple operator-(const LaneTriple& a) { return {-a[0], -a[1], -a[2]}; }
  friend LaneTriple operator*(const LaneTriple& a, const Lanes& s) { return {a[0] * s, a[1] * s, a[2] * s}; }
  friend LaneTriple operator*(const Lanes& s, const LaneTriple& a) { return a * s; }
};

inline Lanes dot(const LaneTriple& a, const LaneTriple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
template <class... More>
inline Lanes dot(const LaneTriple& a, const LaneTriple& b, const More&... more) {
  return dot(a, b) + dot(more...);
}
inline LaneTriple products(const LaneTriple& a, const LaneTriple& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }
inline LaneTriple cross(const LaneTriple& a, const LaneTriple& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// A 3×3 matrix by columns.
struct LaneBlock {
  LaneTriple c[3];

  static LaneBlock zero() { return {{LaneTriple::zero(), LaneTriple::zero(), LaneTriple::zero()}}; }
  static LaneBlock skew(const LaneTriple& a) {
    return {{LaneTriple(0.0, a[2], -a[1]), LaneTriple(-a[2], 0.0, a[0]), LaneTriple(a[1], -a[0], 0.0)}};
  }
  const Lanes& operator()(int i, int j) const { return c[j].c[i]; }
  LaneBlock& operator+=(const LaneBlock& b) { return c[0] += b.c[0], c[1] += b.c[1], c[2] += b.c[2], *this; }
  LaneBlock& operator-=(const LaneBlock& b) { return c[0] -= b.c[0], c[1] -= b.c[1], c[2] -= b.c[2], *this; }
  friend LaneBlock operator+(LaneBlock a, const LaneBlock& b) { return a += b; }
  friend LaneBlock operator-(LaneBlock a, const LaneBlock& b) { return a -= b; }
  friend LaneTriple operator*(const LaneBlock& m, const LaneTriple& v) {
    return m.c[0] * v[0] + m.c[1] * v[1] + m.c[2] * v[2];
  }
  friend LaneBlock operator*(const LaneBlock& a, const LaneBlock& b) { return {{a * b.c[0], a * b.c[1], a * b.c[2]}}; }
  void subtract_outer(const LaneTriple& a, const LaneTriple& b) {
    for (int j = 0; j < 3; ++j) c[j] -= a * b[j];
  }
};

inline LaneBlock transpose(const LaneBlock& m) {
  return {{LaneTriple(m(0, 0), m(0, 1), m(0, 2)), LaneTriple(m(1, 0), m(1, 1), m(1, 2)),
           LaneTriple(m(2, 0), m(2, 1), m(2, 2))}};
}
inline LaneTriple transposed_times(const LaneBlock& m, const LaneTriple& v) {
  return {dot(m.c[0], v), dot(m.c[1], v), dot(m.c[2], v)};
}
inline LaneBlock times_skew(const LaneBlock& m, const LaneTriple& a) {
  return {{m.c[1] * a[2] - m.c[2] * a[1], m.c[2] * a[0] - m.c[0] * a[2], m.c[0] * a[1] - m.c[1] * a[0]}};
}
inline LaneBlock skew_times(const LaneTriple& a, const LaneBlock& m) {
  return {{cross(a, m.c[0]), cross(a, m.c[1]), cross(a, m.c[2])}};
}
inline LaneBlock turned(const LaneBlock& R, const LaneBlock& m) { return R * m * transpose(R); }

/// A symmetric 3×3 matrix, no element twice.
struct LaneSymmetric {
  Lanes xx, xy, xz, yy, yz, zz;

  static LaneSymmetric zero() { return {0.0, 0.0, 0.0, 0.0, 0.0, 0.0}; }
  /// Of a matrix that is symmetric.
  static LaneSymmetric of(const LaneBlock& m) { return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)}; }
  LaneSymmetric& operator+=(const LaneSymmetric& b) {
    xx += b.xx, xy += b.xy, xz += b.xz, yy += b.yy, yz += b.yz, zz += b.zz;
    return *this;
  }
  LaneSymmetric& operator+=(const LaneBlock& b) { return *this += of(b); }
  friend LaneTriple operator*(const LaneSymmetric& m, const LaneTriple& v) {
    return {m.xx * v[0] + m.xy * v[1] + m.xz * v[2], m.xy * v[0] + m.yy * v[1] + m.yz * v[2],
            m.xz * v[0] + m.yz * v[1] + m.zz * v[2]};
  }
  /// Subtracts a bᵀ, a along b.
  void subtract_outer(const LaneTriple& a, const LaneTriple& b) {
    xx -= a[0] * b[0], xy -= a[0] * b[1], xz -= a[0] * b[2];
    yy -= a[1] * b[1], yz -= a[1] * b[2], zz -= a[2] * b[2];
  }
};
inline LaneBlock full(const LaneSymmetric& m) {
  return {{LaneTriple(m.xx, m.xy, m.xz), LaneTriple(m.xy, m.yy, m.yz), LaneTriple(m.xz, m.yz, m.zz)}};
}
inline const Block& full(const Block& m) { return m; }
inline LaneTriple column(const LaneSymmetric& m, int j) { return full(m).c[j]; }
inline const Triple& column(const Block& m, int j) { return m.c[j]; }
inline LaneSymmetric turned_symmetric(const LaneBlock& R, const LaneSymmetric& m) {
  const LaneBlock left = R * full(m);
  const auto element = [&](int i, int j) { return left(i, 0) * R(j, 0) + left(i, 1) * R(j, 1) + left(i, 2) * R(j, 2); };
  return {element(0, 0), element(0, 1), element(0, 2), element(1, 1), element(1, 2), element(2, 2)};
}
inline Block turned_symmetric(const Block& R, const Block& m) { return turned(R, m); }
/// A + m + mᵀ.
inline LaneSymmetric with_both(const LaneSymmetric& A, const LaneBlock& m) {
  return {A.xx + (m(0, 0) + m(0, 0)), A.xy + (m(0, 1) + m(1, 0)), A.xz + (m(0, 2) + m(2, 0)),
          A.yy + (m(1, 1) + m(1, 1)), A.yz + (m(1, 2) + m(2, 1)), A.zz + (m(2, 2) + m(2, 2))};
}
inline Block with_both(const Block& A, const Block& m) { return A + m + transpose(m); }

/// Vectors and matrices of a scalar.
template <class S>
struct VectorsOf {
  using Vector = Triple;
  using Matrix = withy::Block;
  using Symmetric = withy::Block;
};
template <>
struct VectorsOf<Lanes> {
  using Vector = LaneTriple;
  using Matrix = LaneBlock;
  using Symmetric = LaneSymmetric;
};
template <class S>
using TripleOf = typename VectorsOf<S>::Vector;
template <class S>
using BlockOf = typename VectorsOf<S>::Matrix;
template <class S>
using SymmetricOf = typename VectorsOf<S>::Symmetric;

}  // namespace withy
