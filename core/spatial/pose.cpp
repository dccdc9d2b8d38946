#include "withy/core/spatial/pose.hpp"

namespace withy {

Pose Pose::operator*(const Pose& C) const { return {R * C.R, p + R * C.p}; }

Pose Pose::inverse() const { return {R.transpose(), -(R.transpose() * p)}; }

Matrix3 rotation_from_quaternion(double w, double x, double y, double z) {
  return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

Matrix3 rotation_between(const Vector3& from, const Vector3& to) {
  const Vector3 a = from.normalized(), b = to.normalized(), sum = a + b;
  if (sum.norm() > 1e-4) {
    const Vector3 middle = sum.normalized(), axis = a.cross(middle);
    return rotation_from_quaternion(a.dot(middle), axis.x(), axis.y(), axis.z());
  }
  // Their middle is lost in rounding: one reflection that leaves `from` and one that takes it to `to`.
  const auto reflection = [](const Vector3& n) { return Matrix3(Matrix3::Identity() - 2 * n * n.transpose()); };
  return reflection((b - a).normalized()) * reflection(a.unitOrthogonal());
}

}  // namespace withy
