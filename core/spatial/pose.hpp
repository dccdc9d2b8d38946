/// \file
/// Poses in three dimensions, for set-up, diagnostics and everything that is not a hot path.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace withy {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix3X = Eigen::Matrix3Xd;

/// Pose X_AB of a frame B in a frame A: rotation R_AB (columns: axes of B in A) and position p_AB of B's origin [m].
struct Pose {
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();

  /// X_AC = X_AB X_BC. Not inline: every source that includes this would compile Eigen's products anew (0.4 s).
  [[nodiscard]] Pose operator*(const Pose& C) const;
  /// X_BA from X_AB.
  [[nodiscard]] Pose inverse() const;
};

/// Cross-product matrix: skew(a) b = a × b.
template <class Scalar>
Eigen::Matrix<Scalar, 3, 3> skew(const Eigen::Matrix<Scalar, 3, 1>& a) {
  Eigen::Matrix<Scalar, 3, 3> m;
  m << Scalar(0), -a.z(), a.y(), a.z(), Scalar(0), -a.x(), -a.y(), a.x(), Scalar(0);
  return m;
}

/// Rotation matrix of a quaternion w, x, y, z, which need not have unit length (it is scaled).
Matrix3 rotation_from_quaternion(double w, double x, double y, double z);

/// A rotation R that turns one direction to another, R from/|from| = to/|to|: the least one, and where they are
/// opposite (to 1e-4 rad) a half turn about some normal of `from`. Neither is zero. (Eigen's FromTwoVectors would have
/// each of its users compile a singular value decomposition: 10 s.)
Matrix3 rotation_between(const Vector3& from, const Vector3& to);

}  // namespace withy
