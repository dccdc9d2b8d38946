/// \file
/// The algebra of the sweeps, once for motion in a plane and once in three dimensions.
///
/// A twist is (angular; linear) of a frame's origin in that frame's axes, a wrench (moment; force) about it: 1 + 2
/// numbers in the plane, 3 + 3 in space. An acceleration is the component-wise derivative of a twist in its own moving
/// frame (Featherstone's spatial acceleration). Pose X_AB: axes and origin of B in A.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "withy/core/spatial/pose.hpp"

namespace withy {

/// Motion in three dimensions.
struct Spatial {
  static constexpr int dim = 6;      ///< size of a twist
  static constexpr int angular = 3;  ///< of these, angular
  static constexpr int linear = 3;
  using Twist = Eigen::Matrix<double, 6, 1>;
  using Matrix = Eigen::Matrix<double, 6, 6>;
  using Position = Eigen::Vector3d;
  using Angular = Eigen::Vector3d;
  using Rotation = Eigen::Matrix3d;
  struct Frame {
    Rotation R;
    Position p;
  };

  static Rotation identity() { return Rotation::Identity(); }
  static Frame make(const Pose& X) { return {X.R, X.p}; }
  /// Rotation by an angle about the first (x = 0) … third (z = 2) axis.
  static Rotation about_z(double cosine, double sine) {
    Rotation R;
    R << cosine, -sine, 0, sine, cosine, 0, 0, 0, 1;
    return R;
  }
  static Position rotate(const Rotation& R, const Position& a) { return R * a; }
  static Position unrotate(const Rotation& R, const Position& a) { return R.transpose() * a; }
  static Position unrotate_axis(const Rotation& R, const Angular& a) { return R.transpose() * a; }
  static Frame compose(const Frame& AB, const Frame& BC) { return {AB.R * BC.R, AB.p + AB.R * BC.p}; }

  /// Twist of B from that of A, both parts of one rigid body.
  static Twist to_child(const Frame& AB, const Twist& V) {
    Twist U;
    const Eigen::Vector3d w = V.head<3>();
    U.head<3>() = AB.R.transpose() * w;
    U.tail<3>() = AB.R.transpose() * (V.tail<3>() + w.cross(AB.p));
    return U;
  }
  /// The inverse of `to_child`.
  static Twist from_child(const Frame& AB, const Twist& U) {
    Twist V;
    const Eigen::Vector3d w = AB.R * U.head<3>();
    V.head<3>() = w;
    V.tail<3>() = AB.R * U.tail<3>() - w.cross(AB.p);
    return V;
  }
  static Frame inverse(const Frame& AB) { return {AB.R.transpose(), -(AB.R.transpose() * AB.p)}; }
  /// Wrench about A from that about B: the transpose of `to_child`.
  static Twist to_parent(const Frame& AB, const Twist& F) {
    Twist G;
    const Eigen::Vector3d f = AB.R * F.tail<3>();
    G.tail<3>() = f;
    G.head<3>() = AB.R * F.head<3>() + AB.p.cross(f);
    return G;
  }
  /// Xᵀ M X with X = to_child, for any M that maps twists to wrenches.
  static Matrix matrix_to_parent(const Frame& AB, const Matrix& M) {
    const Eigen::Matrix3d& R = AB.R;
    const Eigen::Matrix3d P = skew<double>(AB.p);
    const Eigen::Matrix3d aa = R * M.topLeftCorner<3, 3>() * R.transpose();
    const Eigen::Matrix3d al = R * M.topRightCorner<3, 3>() * R.transpose();
    const Eigen::Matrix3d la = R * M.bottomLeftCorner<3, 3>() * R.transpose();
    const Eigen::Matrix3d ll = R * M.bottomRightCorner<3, 3>() * R.transpose();
    // In A's axes: Sᵀ N S with S = [1 0; −P 1].
    Matrix N;
    const Eigen::Matrix3d lower = la - ll * P;
    N.topLeftCorner<3, 3>() = aa - al * P + P * lower;
    N.topRightCorner<3, 3>() = al + P * ll;
    N.bottomLeftCorner<3, 3>() = lower;
    N.bottomRightCorner<3, 3>() = ll;
    return N;
  }
  /// V × U, twists.
  static Twist cross(const Twist& V, const Twist& U) {
    Twist W;
    const Eigen::Vector3d w = V.head<3>();
    W.head<3>() = w.cross(U.head<3>());
    W.tail<3>() = w.cross(U.tail<3>()) + V.tail<3>().cross(U.head<3>());
    return W;
  }
  /// V ×* F, a wrench: V ×* = −(V ×)ᵀ.
  static Twist cross_force(const Twist& V, const Twist& F) {
    Twist W;
    const Eigen::Vector3d w = V.head<3>();
    W.head<3>() = w.cross(F.head<3>()) + V.tail<3>().cross(F.tail<3>());
    W.tail<3>() = w.cross(F.tail<3>());
    return W;
  }
  /// The matrix of V ×.
  static Matrix cross_matrix(const Twist& V) {
    Matrix m = Matrix::Zero();
    m.topLeftCorner<3, 3>() = m.bottomRightCorner<3, 3>() = skew<double>(Eigen::Vector3d(V.head<3>()));
    m.bottomLeftCorner<3, 3>() = skew<double>(Eigen::Vector3d(V.tail<3>()));
    return m;
  }
};

/// Motion in a plane; the third axis is its normal.
struct Planar {
  static constexpr int dim = 3;
  static constexpr int angular = 1;
  static constexpr int linear = 2;
  using Twist = Eigen::Matrix<double, 3, 1>;
  using Matrix = Eigen::Matrix<double, 3, 3>;
  using Position = Eigen::Vector2d;
  using Angular = Eigen::Matrix<double, 1, 1>;
  struct Rotation {
    double c = 1, s = 0;
  };
  struct Frame {
    Rotation R;
    Position p;
  };

  static Rotation identity() { return {}; }
  static Frame make(const Pose& X) { return {{X.R(0, 0), X.R(1, 0)}, X.p.head<2>()}; }
  static Rotation about_z(double cosine, double sine) { return {cosine, sine}; }
  static Position rotate(const Rotation& R, const Position& a) {
    return {R.c * a.x() - R.s * a.y(), R.s * a.x() + R.c * a.y()};
  }
  static Position unrotate(const Rotation& R, const Position& a) {
    return {R.c * a.x() + R.s * a.y(), R.c * a.y() - R.s * a.x()};
  }
  static Angular unrotate_axis(const Rotation& /*R*/, const Angular& a) { return a; }
  static Frame compose(const Frame& AB, const Frame& BC) {
    return {{AB.R.c * BC.R.c - AB.R.s * BC.R.s, AB.R.s * BC.R.c + AB.R.c * BC.R.s}, AB.p + rotate(AB.R, BC.p)};
  }

  static Twist to_child(const Frame& AB, const Twist& V) {
    const double x = V[1] - V[0] * AB.p.y();
    const double y = V[2] + V[0] * AB.p.x();
    return {V[0], AB.R.c * x + AB.R.s * y, AB.R.c * y - AB.R.s * x};
  }
  static Twist from_child(const Frame& AB, const Twist& U) {
    return {U[0], AB.R.c * U[1] - AB.R.s * U[2] + U[0] * AB.p.y(), AB.R.s * U[1] + AB.R.c * U[2] - U[0] * AB.p.x()};
  }
  static Frame inverse(const Frame& AB) { return {{AB.R.c, -AB.R.s}, -unrotate(AB.R, AB.p)}; }
  static Twist to_parent(const Frame& AB, const Twist& F) {
    const double x = AB.R.c * F[1] - AB.R.s * F[2];
    const double y = AB.R.s * F[1] + AB.R.c * F[2];
    return {F[0] + AB.p.x() * y - AB.p.y() * x, x, y};
  }
  static Matrix matrix_to_parent(const Frame& AB, const Matrix& M) {
    // Columns of X = to_child: unit angular velocity, unit x, unit y in A.
    const double c = AB.R.c, s = AB.R.s;
    const double ax = c * -AB.p.y() + s * AB.p.x();
    const double ay = c * AB.p.x() + s * AB.p.y();
    Matrix MX;
    MX.col(0) = M.col(0) + ax * M.col(1) + ay * M.col(2);
    MX.col(1) = c * M.col(1) - s * M.col(2);
    MX.col(2) = s * M.col(1) + c * M.col(2);
    Matrix N;
    N.row(0) = MX.row(0) + ax * MX.row(1) + ay * MX.row(2);
    N.row(1) = c * MX.row(1) - s * MX.row(2);
    N.row(2) = s * MX.row(1) + c * MX.row(2);
    return N;
  }
  static Twist cross(const Twist& V, const Twist& U) {
    return {0, V[2] * U[0] - V[0] * U[2], V[0] * U[1] - V[1] * U[0]};
  }
  static Twist cross_force(const Twist& V, const Twist& F) {
    return {V[1] * F[2] - V[2] * F[1], -V[0] * F[2], V[0] * F[1]};
  }
  static Matrix cross_matrix(const Twist& V) {
    Matrix m;
    m << 0, 0, 0, V[2], 0, -V[0], -V[1], V[0], 0;
    return m;
  }
};

}  // namespace withy
