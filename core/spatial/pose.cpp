#include "withy/core/spatial/pose.hpp"

namespace withy {

Matrix3 rotation_from_quaternion(double w, double x, double y, double z) {
  return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

}  // namespace withy
