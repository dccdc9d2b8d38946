#include "withy/core/shape/modal_shape.hpp"

namespace withy {

PointExpansion PointExpansion::rigid(const Vector3& X, Eigen::Index modes) {
  PointExpansion e;
  e.X = X;
  e.phi = Matrix3X::Zero(3, modes);
  e.psi = Matrix3X::Zero(3, modes);
  e.gamma.fill(Eigen::MatrixXd::Zero(modes, modes));
  e.theta.fill(Eigen::MatrixXd::Zero(modes, modes));
  return e;
}

}  // namespace withy
