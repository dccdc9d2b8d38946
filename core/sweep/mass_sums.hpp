/// \file
/// Products of fields over the mass of a flexible body, summed: what a group of points gives is added up lane by lane,
/// and sums over the lanes of a group are taken last.
///
/// Positions r, accelerations a and partial velocities P_i are times root masses; component c of a field stands c
/// strides behind its first.
#pragma once

#include <algorithm>

#include "withy/core/spatial/planar.hpp"
#include "withy/core/spatial/spatial.hpp"

namespace withy::sweep {

/// n where it is known at compile time, otherwise a run-time number.
template <int N>
constexpr int count(int n) {
  return N >= 0 ? N : n;
}

/// Sums ∫ r × f, one a component of a turn.
template <class Space>
requires(Space::angular == 1) inline void add_moment(const typename Space::Group* r, const typename Space::Group* f,
                                                     int stride, typename Space::Group* sums) {
  sums[0] += r[0] * f[stride] - r[stride] * f[0];
}
template <class Space>
requires(Space::angular == 3) inline void add_moment(const typename Space::Group* r, const typename Space::Group* f,
                                                     int stride, typename Space::Group* sums) {
  const int y = stride, z = 2 * stride;
  sums[0] += r[y] * f[z] - r[z] * f[y];
  sums[1] += r[z] * f[0] - r[0] * f[z];
  sums[2] += r[0] * f[y] - r[y] * f[0];
}
template <class Space>
requires(Space::angular == 1) inline void put_moment(const typename Space::Group* sums, typename Space::Twist& twist) {
  twist.w += sum(sums[0]);
}
template <class Space>
requires(Space::angular == 3) inline void put_moment(const typename Space::Group* sums, typename Space::Twist& twist) {
  twist.w += typename Space::Triple(sum(sums[0]), sum(sums[1]), sum(sums[2]));
}

/// Sums ∫ r rᵀ as far as turns need it: `squares` of them.
template <class Space>
constexpr int squares = Space::angular == 1 ? 1 : 6;

template <class Space>
requires(Space::angular == 1) inline void add_squares(const typename Space::Group* r, int stride,
                                                      typename Space::Group* sums) {
  sums[0] += r[0] * r[0] + r[stride] * r[stride];
}
template <class Space>
requires(Space::angular == 3) inline void add_squares(const typename Space::Group* r, int stride,
                                                      typename Space::Group* sums) {
  const auto &x = r[0], &y = r[stride], &z = r[2 * stride];
  sums[0] += x * x, sums[1] += y * y, sums[2] += z * z;
  sums[3] += x * y, sums[4] += x * z, sums[5] += y * z;
}
template <class Space>
requires(Space::angular == 1) inline void put_squares(const typename Space::Group* sums, typename Space::Inertia& I) {
  I.ww += sum(sums[0]);
}
template <class Space>
requires(Space::angular == 3) inline void put_squares(const typename Space::Group* sums, typename Space::Inertia& I) {
  using Triple = typename Space::Triple;
  const auto xx = sum(sums[0]), yy = sum(sums[1]), zz = sum(sums[2]);
  const auto xy = sum(sums[3]), xz = sum(sums[4]), yz = sum(sums[5]);
  I.A += typename Space::Block{{Triple(yy + zz, -xy, -xz), Triple(-xy, xx + zz, -yz), Triple(-xz, -yz, xx + yy)}};
}

/// f · g.
template <class Space>
inline typename Space::Group product(const typename Space::Group* f, const typename Space::Group* g, int stride) {
  typename Space::Group sum = f[0] * g[0];
  for (int c = 1; c < Space::linear; ++c) sum += f[c * stride] * g[c * stride];
  return sum;
}

/// Products of A rows of `length` groups with B others, those of the lower triangle added to G.
template <class Scalar, int A, int B, class Group>
inline void add_tile(const Group* left, const Group* right, int length, int i, int j, int n, Scalar* G) {
  left += i * length, right += j * length;
  Group sums[A][B];
  for (auto& of_row : sums)
    for (Group& s : of_row) s = spread(Scalar(0));
  for (int k = 0; k < length; ++k)
    for (int b = 0; b < B; ++b) {
      const Group other = right[b * length + k];
      for (int a = 0; a < A; ++a) sums[a][b] += left[a * length + k] * other;
    }
  for (int a = 0; a < A; ++a)
    for (int b = 0; b < B; ++b)
      if (j + b <= i + a) G[(i + a) * n + j + b] += sum(sums[a][b]);
}

/// Adds the products of n rows of `length` groups on the left with as many on the right to the lower triangle of G.
/// Eight sums at a time: as many as the processor adds to before the first is done, with what they read in the
/// registers that are left.
template <class Scalar, class Group>
[[gnu::noinline]] inline void add_gram(const Group* left, const Group* right, int length, int n, Scalar* G) {
  const auto tiles = [&](auto tall, int i) {
    constexpr int A = decltype(tall)::value;
    int j = 0;
    for (; j + 2 <= i + A; j += 2) add_tile<Scalar, A, 2>(left, right, length, i, j, n, G);
    if (j < i + A) add_tile<Scalar, A, 1>(left, right, length, i, j, n, G);
  };
  int i = 0;
  for (; i + 4 <= n; i += 4) tiles(std::integral_constant<int, 4>{}, i);
  if (n - i == 3) tiles(std::integral_constant<int, 3>{}, i);
  if (n - i == 2) tiles(std::integral_constant<int, 2>{}, i);
  if (n - i == 1) tiles(std::integral_constant<int, 1>{}, i);
}

/// Adds the sums of rows of `groups` groups, a component each: r and a of `linear` of them, P of n times as
/// many. For any number of modes and many groups.
template <class Space>
inline void add_rows(const typename Space::Group* r, const typename Space::Group* a, const typename Space::Group* P,
                     int groups, int n, typename Space::Inertia& I, typename Space::Twist* C, typename Space::Scalar* G,
                     typename Space::Twist& p, typename Space::Scalar* h) {
  using Group = typename Space::Group;
  using Scalar = typename Space::Scalar;
  constexpr int T = Space::angular, L = Space::linear;
  const Group zero = spread(Scalar(0));
  Group r_r[squares<Space>], r_a[T];
  for (Group& s : r_r) s = zero;
  for (Group& s : r_a) s = zero;
  for (int k = 0; k < groups; ++k) {
    add_squares<Space>(r + k, groups, r_r);
    add_moment<Space>(r + k, a + k, groups, r_a);
  }
  put_squares<Space>(r_r, I);
  put_moment<Space>(r_a, p);
  for (int i = 0; i < n; ++i) {
    const Group* Pi = P + i * L * groups;
    Group r_P[T], P_a = zero;
    for (Group& s : r_P) s = zero;
    for (int k = 0; k < groups; ++k) {
      add_moment<Space>(r + k, Pi + k, groups, r_P);
      P_a += product<Space>(Pi + k, a + k, groups);
    }
    put_moment<Space>(r_P, C[i]);
    h[i] += sum(P_a);
  }
  add_gram<Scalar>(P, P, L * groups, n, G);
}

}  // namespace withy::sweep
