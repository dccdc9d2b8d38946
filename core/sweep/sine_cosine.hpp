/// \file
/// Sine and cosine of a number, of a pack, and of several cases.
#pragma once

#include <bit>
#include <cmath>

#include "withy/core/spatial/lanes.hpp"

namespace withy::sweep {

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

inline void sine_cosine(double angle, double& sine, double& cosine) {
  sine = std::sin(angle);
  cosine = std::cos(angle);
}
/// Those of lanes that are not `near`, whose angles are too large for sine_cosine_of. Apart: what calls a function is
/// not to be in the way of what hardly ever does.
[[gnu::noinline, gnu::cold]] inline void sine_cosine_of_far(LaneSet near, const Lanes& angle, Lanes& sine,
                                                            Lanes& cosine) {
  for (std::size_t i = 0; i < cases_at_once; ++i) {
    if (near.has(i)) continue;
    sine.set(i, std::sin(angle[i]));
    cosine.set(i, std::cos(angle[i]));
  }
}
/// Of an angle of each case, each on its own.
inline void sine_cosine(const Lanes& angle, Lanes& sine, Lanes& cosine) {
  Lanes s, c;
#ifdef __AVX512F__
  sine_cosine_of<long __attribute__((vector_size(64)))>(angle.p, s.p, c.p);
#else
  sine_cosine(angle.p, s.p, c.p);
#endif
  const Lanes furthest = 1e5;
  const LaneSet near = positive(furthest - angle) & positive(furthest + angle);
  if (near.bits != LaneSet::all().bits) [[unlikely]] {
    const Lanes far = angle;
    Lanes far_s = s, far_c = c;
    sine_cosine_of_far(near, far, far_s, far_c);
    s = far_s, c = far_c;
  }
  sine = s, cosine = c;
}

}  // namespace withy::sweep
