/// \file
/// The algebra of the sweeps for motion in a plane; the third axis is its normal. Meaning of each function: space.hpp.
#pragma once

#include "withy/core/spatial/lanes.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy {

/// S: a number, or one of each of several cases (Lanes).
template <class S>
struct PlanarOf {
  using Scalar = S;
  using Group = GroupOf<S>;
  static constexpr int dim = 3;      ///< numbers in a twist
  static constexpr int angular = 1;  ///< of these, angular
  static constexpr int linear = 2;

  struct Position {
    S x, y;
    static Position zero() { return {0, 0}; }
    S operator[](int i) const { return i == 0 ? x : y; }
    Position& operator+=(const Position& b) { return x += b.x, y += b.y, *this; }
    friend Position operator+(const Position& a, const Position& b) { return {a.x + b.x, a.y + b.y}; }
    friend Position operator*(const Position& a, S s) { return {a.x * s, a.y * s}; }
    friend Position operator*(S s, const Position& a) { return a * s; }
  };
  using Angular = S;
  static Position position(const Vector3& a) { return {a.x(), a.y()}; }
  static Angular angle(const Vector3& a) { return a.z(); }

  struct Twist {
    S w, x, y;
    static Twist zero() { return {0, 0, 0}; }
    static Twist of(const Vector6& v) { return {v[2], v[3], v[4]}; }
    static Twist of(Angular w, const Position& v) { return {w, v.x, v.y}; }
    static Twist turning(S rate) { return {rate, 0, 0}; }
    static Twist sliding(S rate) { return {0, rate, 0}; }
    [[nodiscard]] S turn() const { return w; }
    [[nodiscard]] S slide() const { return x; }
    S& operator[](int i) { return i == 0 ? w : (i == 1 ? x : y); }
    S operator[](int i) const { return i == 0 ? w : (i == 1 ? x : y); }
    Twist& operator+=(const Twist& b) { return w += b.w, x += b.x, y += b.y, *this; }
    Twist& operator-=(const Twist& b) { return w -= b.w, x -= b.x, y -= b.y, *this; }
    friend Twist operator+(const Twist& a, const Twist& b) { return {a.w + b.w, a.x + b.x, a.y + b.y}; }
    friend Twist operator-(const Twist& a, const Twist& b) { return {a.w - b.w, a.x - b.x, a.y - b.y}; }
    friend Twist operator*(const Twist& a, S s) { return {a.w * s, a.x * s, a.y * s}; }
    friend Twist operator*(S s, const Twist& a) { return a * s; }
  };
  static S dot(const Twist& a, const Twist& b) { return a.w * b.w + a.x * b.x + a.y * b.y; }

  struct Rotation {
    S c = 1, s = 0;
  };
  struct Frame {
    Rotation R;
    Position p;
  };
  static Frame make(const Pose& X) { return {{X.R(0, 0), X.R(1, 0)}, {X.p.x(), X.p.y()}}; }
  static Rotation about_z(S cosine, S sine) { return {cosine, sine}; }
  static Rotation compose(const Rotation& A, const Rotation& B) {
    return {A.c * B.c - A.s * B.s, A.s * B.c + A.c * B.s};
  }
  static Position rotate(const Rotation& R, const Position& a) {
    return {R.c * a.x - R.s * a.y, R.s * a.x + R.c * a.y};
  }
  static Position unrotate(const Rotation& R, const Position& a) {
    return {R.c * a.x + R.s * a.y, R.c * a.y - R.s * a.x};
  }
  static Frame compose(const Frame& AB, const Frame& BC) { return {compose(AB.R, BC.R), AB.p + rotate(AB.R, BC.p)}; }
  static Frame inverse(const Frame& AB) {
    const Position p = unrotate(AB.R, AB.p);
    return {{AB.R.c, -AB.R.s}, {-p.x, -p.y}};
  }

  static Twist shift_to_child(const Position& p, const Twist& V) { return {V.w, V.x - V.w * p.y, V.y + V.w * p.x}; }
  static Twist to_child(const Frame& AB, const Twist& V) {
    const Twist U = shift_to_child(AB.p, V);
    return Twist::of(U.w, unrotate(AB.R, {U.x, U.y}));
  }
  static Twist from_child(const Frame& AB, const Twist& U) {
    const Position v = rotate(AB.R, {U.x, U.y});
    return {U.w, v.x + U.w * AB.p.y, v.y - U.w * AB.p.x};
  }
  static Twist shift_to_parent(const Position& p, const Twist& F) { return {F.w + p.x * F.y - p.y * F.x, F.x, F.y}; }
  static Twist to_parent(const Frame& AB, const Twist& F) {
    return shift_to_parent(AB.p, Twist::of(F.w, rotate(AB.R, {F.x, F.y})));
  }
  static Twist cross(const Twist& V, const Twist& U) { return {0, V.y * U.w - V.w * U.y, V.w * U.x - V.x * U.w}; }
  static Twist cross_force(const Twist& V, const Twist& F) { return {V.x * F.y - V.y * F.x, -V.w * F.y, V.w * F.x}; }

  /// A symmetric map of twists to wrenches: the upper triangle.
  struct Inertia {
    S ww, wx, wy, xx, xy, yy;
    static Inertia zero() { return {0, 0, 0, 0, 0, 0}; }
    Inertia& operator+=(const Inertia& b) {
      ww += b.ww, wx += b.wx, wy += b.wy, xx += b.xx, xy += b.xy, yy += b.yy;
      return *this;
    }
    friend Twist operator*(const Inertia& I, const Twist& V) {
      return {I.ww * V.w + I.wx * V.x + I.wy * V.y, I.wx * V.w + I.xx * V.x + I.xy * V.y,
              I.wy * V.w + I.xy * V.x + I.yy * V.y};
    }
    [[nodiscard]] Twist turn_column() const { return {ww, wx, wy}; }
    [[nodiscard]] Twist slide_column() const { return {wx, xx, xy}; }
    /// Subtracts (s u) uᵀ.
    void subtract_square(const Twist& u, S s) {
      const Twist v = u * s;
      ww -= v.w * u.w, wx -= v.w * u.x, wy -= v.w * u.y, xx -= v.x * u.x, xy -= v.x * u.y, yy -= v.y * u.y;
    }
  };
  static Inertia shift_to_parent(const Position& p, const Inertia& I) {
    const S wx = I.wx - p.y * I.xx + p.x * I.xy;
    const S wy = I.wy - p.y * I.xy + p.x * I.yy;
    return {I.ww - p.y * (I.wx + wx) + p.x * (I.wy + wy), wx, wy, I.xx, I.xy, I.yy};
  }
  static Inertia to_parent(const Frame& AB, const Inertia& I) {
    const S c = AB.R.c, s = AB.R.s;
    const S cxx = c * I.xx - s * I.xy, cxy = c * I.xy - s * I.yy;
    const S sxx = s * I.xx + c * I.xy, sxy = s * I.xy + c * I.yy;
    return shift_to_parent(AB.p, Inertia{I.ww, c * I.wx - s * I.wy, s * I.wx + c * I.wy, c * cxx - s * cxy,
                                         s * cxx + c * cxy, s * sxx + c * sxy});
  }

  /// Any map of twists to wrenches, row-major.
  struct Matrix {
    S m[9];
    static Matrix zero() { return {{0, 0, 0, 0, 0, 0, 0, 0, 0}}; }
    static Matrix of(const Inertia& I) { return {{I.ww, I.wx, I.wy, I.wx, I.xx, I.xy, I.wy, I.xy, I.yy}}; }
    Matrix& operator+=(const Matrix& b) {
      for (int i = 0; i < 9; ++i) m[i] += b.m[i];
      return *this;
    }
    Matrix& operator-=(const Matrix& b) {
      for (int i = 0; i < 9; ++i) m[i] -= b.m[i];
      return *this;
    }
    friend Matrix operator+(Matrix a, const Matrix& b) { return a += b; }
    friend Matrix operator-(Matrix a, const Matrix& b) { return a -= b; }
    friend Twist operator*(const Matrix& a, const Twist& v) {
      return {dot(a.row(0), v), dot(a.row(1), v), dot(a.row(2), v)};
    }
    [[nodiscard]] Twist row(int i) const { return {m[3 * i], m[3 * i + 1], m[3 * i + 2]}; }
    [[nodiscard]] Twist column(int j) const { return {m[j], m[3 + j], m[6 + j]}; }
    [[nodiscard]] Twist turn_row() const { return row(0); }
    [[nodiscard]] Twist slide_row() const { return row(1); }
    [[nodiscard]] Twist turn_column() const { return column(0); }
    [[nodiscard]] Twist slide_column() const { return column(1); }
    void subtract_outer(const Twist& a, const Twist& b) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) m[3 * i + j] -= a[i] * b[j];
      }
    }
  };
  static Twist transposed_times(const Matrix& a, const Twist& v) {
    return a.row(0) * v.w + a.row(1) * v.x + a.row(2) * v.y;
  }
  static Matrix times_cross(const Matrix& a, const Twist& V) {
    Matrix r;
    for (int i = 0; i < 3; ++i) {
      const Twist f = cross_force(V, a.row(i));  // V ×* = −(V ×)ᵀ
      for (int j = 0; j < 3; ++j) r.m[3 * i + j] = -f[j];
    }
    return r;
  }
  static Matrix cross_transposed_times(const Twist& V, const Matrix& a) {
    Matrix r;
    for (int j = 0; j < 3; ++j) {
      const Twist f = cross_force(V, a.column(j));
      for (int i = 0; i < 3; ++i) r.m[3 * i + j] = -f[i];
    }
    return r;
  }
  static Matrix shift_to_parent(const Position& p, const Matrix& M) {
    Matrix N = M;
    for (int j = 0; j < 3; ++j) N.m[j] += p.x * M.m[6 + j] - p.y * M.m[3 + j];
    for (int i = 0; i < 3; ++i) N.m[3 * i] += p.x * N.m[3 * i + 2] - p.y * N.m[3 * i + 1];
    return N;
  }
  static Matrix to_parent(const Frame& AB, const Matrix& M) {
    const S c = AB.R.c, s = AB.R.s;
    const S ax = s * AB.p.x - c * AB.p.y;
    const S ay = c * AB.p.x + s * AB.p.y;
    // Columns of to_child: (1, ax, ay), (0, c, −s), (0, s, c).
    const Twist r0 = M.row(0) + M.row(1) * ax + M.row(2) * ay;
    const Twist r1 = M.row(1) * c - M.row(2) * s;
    const Twist r2 = M.row(1) * s + M.row(2) * c;
    Matrix N;
    int k = 0;
    for (const Twist& r : {r0, r1, r2}) {
      N.m[k++] = r.w + ax * r.x + ay * r.y;
      N.m[k++] = c * r.x - s * r.y;
      N.m[k++] = s * r.x + c * r.y;
    }
    return N;
  }
};

using Planar = PlanarOf<double>;

}  // namespace withy
