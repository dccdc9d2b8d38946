#include "withy/core/shape/modal_shape.hpp"

#include <Eigen/Cholesky>

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

double ModalShape::compliance(const PointExpansion& at) const {
  if (modes() == 0) return 0;
  const double largest = stiffness.cwiseAbs().maxCoeff();
  constexpr double least = 1e-12;
  const Eigen::MatrixXd K =
      stiffness + least * (largest > 0 ? largest : 1) * Eigen::MatrixXd::Identity(modes(), modes());
  return (at.phi * K.ldlt().solve(at.phi.transpose())).trace();
}

}  // namespace withy
