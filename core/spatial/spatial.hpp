/// \file
/// The algebra of the sweeps for motion in three dimensions. Meaning of each function: space.hpp.
#pragma once

#include "withy/core/spatial/lanes.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy {

/// S: a number, or one of each of several cases (Lanes).
template <class S>
struct SpatialOf {
  using Scalar = S;
  using Group = GroupOf<S>;
  using Triple = TripleOf<S>;
  using Block = BlockOf<S>;
  static constexpr int dim = 6;
  static constexpr int angular = 3;
  static constexpr int linear = 3;

  using Position = Triple;
  using Angular = Triple;
  static Position position(const Vector3& a) { return {a.x(), a.y(), a.z()}; }
  static Angular angle(const Vector3& a) { return {a.x(), a.y(), a.z()}; }
  static Block block(const Matrix3& m) { return {{position(m.col(0)), position(m.col(1)), position(m.col(2))}}; }

  struct Twist {
    Triple w, v;  ///< angular, linear
    static Twist zero() { return {Triple::zero(), Triple::zero()}; }
    static Twist of(const Vector6& a) { return {position(a.head<3>()), position(a.tail<3>())}; }
    static Twist of(const Angular& w, const Position& v) { return {w, v}; }
    static Twist turning(S rate) { return {Triple(0, 0, rate), Triple::zero()}; }
    static Twist sliding(S rate) { return {Triple::zero(), Triple(rate, 0, 0)}; }
    [[nodiscard]] S turn() const { return w[2]; }
    [[nodiscard]] S slide() const { return v[0]; }
    [[nodiscard]] Vector6 array() const {
      Vector6 a;
      a << w[0], w[1], w[2], v[0], v[1], v[2];
      return a;
    }
    Twist& operator+=(const Twist& b) { return w += b.w, v += b.v, *this; }
    Twist& operator-=(const Twist& b) { return w -= b.w, v -= b.v, *this; }
    friend Twist operator+(const Twist& a, const Twist& b) { return {a.w + b.w, a.v + b.v}; }
    friend Twist operator-(const Twist& a, const Twist& b) { return {a.w - b.w, a.v - b.v}; }
    friend Twist operator*(const Twist& a, S s) { return {a.w * s, a.v * s}; }
    friend Twist operator*(S s, const Twist& a) { return a * s; }
  };
  static S dot(const Twist& a, const Twist& b) { return withy::dot(a.w, b.w, a.v, b.v); }

  using Rotation = Block;
  struct Frame {
    Rotation R;
    Position p;
  };
  static Frame make(const Pose& X) { return {block(X.R), position(X.p)}; }
  static Rotation about_z(S c, S s) { return {{Triple(c, s, 0), Triple(-s, c, 0), Triple(0, 0, 1)}}; }
  static Rotation compose(const Rotation& A, const Rotation& B) { return A * B; }
  static Position rotate(const Rotation& R, const Position& a) { return R * a; }
  static Position unrotate(const Rotation& R, const Position& a) { return withy::transposed_times(R, a); }
  static Frame compose(const Frame& AB, const Frame& BC) { return {AB.R * BC.R, AB.p + AB.R * BC.p}; }
  static Frame inverse(const Frame& AB) {
    const Block turned_back = transpose(AB.R);
    return {turned_back, -(turned_back * AB.p)};
  }

  static Twist shift_to_child(const Position& p, const Twist& V) { return {V.w, V.v + withy::cross(V.w, p)}; }
  static Twist to_child(const Frame& AB, const Twist& V) {
    return {withy::transposed_times(AB.R, V.w), withy::transposed_times(AB.R, V.v + withy::cross(V.w, AB.p))};
  }
  static Twist from_child(const Frame& AB, const Twist& U) {
    const Triple w = AB.R * U.w;
    return {w, AB.R * U.v - withy::cross(w, AB.p)};
  }
  static Twist shift_to_parent(const Position& p, const Twist& F) { return {F.w + withy::cross(p, F.v), F.v}; }
  static Twist to_parent(const Frame& AB, const Twist& F) {
    return shift_to_parent(AB.p, Twist{AB.R * F.w, AB.R * F.v});
  }
  static Twist cross(const Twist& V, const Twist& U) {
    return {withy::cross(V.w, U.w), withy::cross(V.w, U.v) + withy::cross(V.v, U.w)};
  }
  static Twist cross_force(const Twist& V, const Twist& F) {
    return {withy::cross(V.w, F.w) + withy::cross(V.v, F.v), withy::cross(V.w, F.v)};
  }

  /// A symmetric map of twists to wrenches [A Lᵀ; L M].
  struct Inertia {
    SymmetricOf<S> A;
    Block L;
    SymmetricOf<S> M;
    static Inertia zero() { return {SymmetricOf<S>::zero(), Block::zero(), SymmetricOf<S>::zero()}; }
    Inertia& operator+=(const Inertia& b) { return A += b.A, L += b.L, M += b.M, *this; }
    friend Twist operator*(const Inertia& I, const Twist& V) {
      return {I.A * V.w + withy::transposed_times(I.L, V.v), I.L * V.w + I.M * V.v};
    }
    [[nodiscard]] Twist turn_column() const { return {column(A, 2), L.c[2]}; }
    [[nodiscard]] Twist slide_column() const { return {Triple(L(0, 0), L(0, 1), L(0, 2)), column(M, 0)}; }
    /// Subtracts (s u) uᵀ.
    void subtract_square(const Twist& u, S s) {
      const Twist v = u * s;
      A.subtract_outer(v.w, u.w);
      L.subtract_outer(v.v, u.w);
      M.subtract_outer(v.v, u.v);
    }
  };
  static Inertia shift_to_parent(const Position& p, const Inertia& I) {
    // Sᵀ I S with S = [1 0; −p̂ 1].
    const Block Mp = times_skew(full(I.M), p);
    Inertia N;
    N.M = I.M;
    N.L = I.L - Mp;
    // A + p̂L + (p̂L)ᵀ − p̂Mp̂, the last term halved and symmetrized with the others.
    Block half = I.L;
    for (int j = 0; j < 3; ++j) half.c[j] -= 0.5 * Mp.c[j];
    N.A = with_both(I.A, skew_times(p, half));
    return N;
  }
  static Inertia to_parent(const Frame& AB, const Inertia& I) {
    return shift_to_parent(AB.p, Inertia{turned_symmetric(AB.R, I.A), turned(AB.R, I.L), turned_symmetric(AB.R, I.M)});
  }

  /// Any map of twists to wrenches, [AA AL; LA LL].
  struct Matrix {
    Block AA, AL, LA, LL;
    static Matrix zero() { return {Block::zero(), Block::zero(), Block::zero(), Block::zero()}; }
    static Matrix of(const Inertia& I) { return {I.A, withy::transpose(I.L), I.L, I.M}; }
    Matrix& operator+=(const Matrix& b) { return AA += b.AA, AL += b.AL, LA += b.LA, LL += b.LL, *this; }
    Matrix& operator-=(const Matrix& b) { return AA -= b.AA, AL -= b.AL, LA -= b.LA, LL -= b.LL, *this; }
    friend Matrix operator+(Matrix a, const Matrix& b) { return a += b; }
    friend Matrix operator-(Matrix a, const Matrix& b) { return a -= b; }
    friend Twist operator*(const Matrix& a, const Twist& v) {
      return {a.AA * v.w + a.AL * v.v, a.LA * v.w + a.LL * v.v};
    }
    [[nodiscard]] Twist turn_row() const { return {row(AA, 2), row(AL, 2)}; }
    [[nodiscard]] Twist slide_row() const { return {row(LA, 0), row(LL, 0)}; }
    [[nodiscard]] Twist turn_column() const { return {AA.c[2], LA.c[2]}; }
    [[nodiscard]] Twist slide_column() const { return {AL.c[0], LL.c[0]}; }
    void subtract_outer(const Twist& a, const Twist& b) {
      AA.subtract_outer(a.w, b.w);
      AL.subtract_outer(a.w, b.v);
      LA.subtract_outer(a.v, b.w);
      LL.subtract_outer(a.v, b.v);
    }

   private:
    static Triple row(const Block& m, int i) { return {m(i, 0), m(i, 1), m(i, 2)}; }
  };
  static Twist transposed_times(const Matrix& a, const Twist& v) {
    return {withy::transposed_times(a.AA, v.w) + withy::transposed_times(a.LA, v.v),
            withy::transposed_times(a.AL, v.w) + withy::transposed_times(a.LL, v.v)};
  }
  static Matrix times_cross(const Matrix& a, const Twist& V) {
    return {times_skew(a.AA, V.w) + times_skew(a.AL, V.v), times_skew(a.AL, V.w),
            times_skew(a.LA, V.w) + times_skew(a.LL, V.v), times_skew(a.LL, V.w)};
  }
  static Matrix cross_transposed_times(const Twist& V, const Matrix& a) {
    const Triple w = -V.w, v = -V.v;
    return {skew_times(w, a.AA) + skew_times(v, a.LA), skew_times(w, a.AL) + skew_times(v, a.LL), skew_times(w, a.LA),
            skew_times(w, a.LL)};
  }
  static Matrix shift_to_parent(const Position& p, Matrix N) {
    N.LA -= times_skew(N.LL, p);
    N.AA -= times_skew(N.AL, p);
    N.AA += skew_times(p, N.LA);
    N.AL += skew_times(p, N.LL);
    return N;
  }
  static Matrix to_parent(const Frame& AB, const Matrix& M) {
    return shift_to_parent(AB.p,
                           Matrix{turned(AB.R, M.AA), turned(AB.R, M.AL), turned(AB.R, M.LA), turned(AB.R, M.LL)});
  }
};

using Spatial = SpatialOf<double>;

}  // namespace withy
