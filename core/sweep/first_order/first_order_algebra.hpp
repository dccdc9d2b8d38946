/// \file
/// Pairs of orders of twists and wrenches, and the inertia between them, for the sweep of first order.
#pragma once

#include "withy/core/spatial/space.hpp"

namespace withy::sweep {

/// An acceleration A0 + εA1 as its two orders (A0, A1), or a wrench F0 + εF1 as what answers to them: F0 + F1 to A0, F0
/// to A1, so that `dot` is the sum of both orders of their product, F0·A0 + F0·A1 + F1·A0.
template <class Space>
struct Orders {
  using Twist = typename Space::Twist;
  Twist zero, one;

  static Orders none() { return {Twist::zero(), Twist::zero()}; }
  /// The wrench F0 + εF1.
  static Orders wrench(const Twist& F0, const Twist& F1) { return {F0 + F1, F0}; }
  Orders& operator+=(const Orders& b) { return zero += b.zero, one += b.one, *this; }
  Orders& operator-=(const Orders& b) { return zero -= b.zero, one -= b.one, *this; }
  friend Orders operator+(Orders a, const Orders& b) { return a += b; }
  friend Orders operator-(Orders a, const Orders& b) { return a -= b; }
  friend Orders operator*(const Orders& a, double s) { return {a.zero * s, a.one * s}; }
  friend double dot(const Orders& a, const Orders& b) { return Space::dot(a.zero, b.zero) + Space::dot(a.one, b.one); }
};

/// M + Mᵀ.
inline Planar::Inertia with_transpose(const Planar::Matrix& M) {
  const double* m = M.m;
  return {2 * m[0], m[1] + m[3], m[2] + m[6], 2 * m[4], m[5] + m[7], 2 * m[8]};
}
inline Spatial::Inertia with_transpose(const Spatial::Matrix& M) {
  Spatial::Inertia I{M.AA, M.LA, M.LL};
  I.A += transpose(M.AA);
  I.L += transpose(M.AL);
  I.M += transpose(M.LL);
  return I;
}

/// The symmetric map [Q P; Pᵀ R] of pairs: of a rigid part with inertia I0 + εI1 it is [I0 + I1, I0; I0, 0], indefinite
/// although M₀ + M₁ is positive definite where the sweep gets through.
template <class Space>
struct OrdersInertia {
  typename Space::Inertia Q;
  typename Space::Matrix P;
  typename Space::Inertia R;

  static OrdersInertia none() { return {Space::Inertia::zero(), Space::Matrix::zero(), Space::Inertia::zero()}; }
  OrdersInertia& operator+=(const OrdersInertia& b) { return Q += b.Q, P += b.P, R += b.R, *this; }
  friend Orders<Space> operator*(const OrdersInertia& I, const Orders<Space>& a) {
    return {I.Q * a.zero + I.P * a.one, Space::transposed_times(I.P, a.zero) + I.R * a.one};
  }
  /// Subtracts (s u) uᵀ.
  void subtract_square(const Orders<Space>& u, double s) {
    Q.subtract_square(u.zero, s);
    P.subtract_outer(u.zero * s, u.one);
    R.subtract_square(u.one, s);
  }
  /// Column of an acceleration of order zero about the third or along the first axis.
  [[nodiscard]] Orders<Space> turn_column() const { return {Q.turn_column(), P.turn_row()}; }
  [[nodiscard]] Orders<Space> slide_column() const { return {Q.slide_column(), P.slide_row()}; }
};

/// Between frames whose pose has no first order.
template <class Space>
inline Orders<Space> to_child(const typename Space::Frame& X, const Orders<Space>& V) {
  return {Space::to_child(X, V.zero), Space::to_child(X, V.one)};
}
template <class Space>
inline Orders<Space> to_parent(const typename Space::Frame& X, const Orders<Space>& F) {
  return {Space::to_parent(X, F.zero), Space::to_parent(X, F.one)};
}
template <class Space>
inline OrdersInertia<Space> to_parent(const typename Space::Frame& X, const OrdersInertia<Space>& I) {
  return {Space::to_parent(X, I.Q), Space::to_parent(X, I.P), Space::to_parent(X, I.R)};
}

/// Between a frame and a section at X whose axes are parallel to it but for the displacement ξ of first order:
/// A_S = (1 − εξ×) X A_B.
template <class Space>
inline Orders<Space> to_section(const typename Space::Position& X, const typename Space::Twist& xi,
                                const Orders<Space>& V) {
  const typename Space::Twist zero = Space::shift_to_child(X, V.zero);
  return {zero, Space::shift_to_child(X, V.one) - Space::cross(xi, zero)};
}
template <class Space>
inline Orders<Space> from_section(const typename Space::Position& X, const typename Space::Twist& xi,
                                  const Orders<Space>& F) {
  return {Space::shift_to_parent(X, F.zero + Space::cross_force(xi, F.one)), Space::shift_to_parent(X, F.one)};
}
template <class Space>
inline OrdersInertia<Space> from_section(const typename Space::Position& X, const typename Space::Twist& xi,
                                         const OrdersInertia<Space>& I) {
  // Lᵀ I L with L = [1 0; N 1], N = −ξ×: P + NᵀR, and Q + S + Sᵀ with S = (P + ½NᵀR) N.
  using Matrix = typename Space::Matrix;
  const typename Space::Twist back = xi * -1.0;
  const Matrix half = Space::cross_transposed_times(back * 0.5, Matrix::of(I.R));
  Matrix P = I.P + half;
  typename Space::Inertia Q = with_transpose(Space::times_cross(P, back));
  Q += I.Q;
  P += half;
  return {Space::shift_to_parent(X, Q), Space::shift_to_parent(X, P), Space::shift_to_parent(X, I.R)};
}

}  // namespace withy::sweep
