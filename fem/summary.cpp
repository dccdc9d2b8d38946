#include "summary.hpp"

#include <algorithm>

namespace withy::fem {
namespace {

/// Rigid motions of the mesh: translations, then rotations about the body's origin; 3N×6.
Eigen::MatrixXd rigid_motions(const Matrix3X& X) {
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(3 * X.cols(), 6);
  for (Eigen::Index a = 0; a < X.cols(); ++a) {
    R.block<3, 3>(3 * a, 0).setIdentity();
    R.block<3, 3>(3 * a, 3) = -skew<double>(Vector3(X.col(a)));
  }
  return R;
}

/// xx yy zz xy xz yz of a SID.
Matrix3 matrix_of(const Eigen::MatrixXd& six) {
  Matrix3 J;
  J << six(0), six(3), six(4), six(3), six(1), six(5), six(4), six(5), six(2);
  return J;
}

}  // namespace

Summary summary_of(const Matrices& matrices, const Reduction& body, const sid::Data& data) {
  Summary s;
  const Eigen::MatrixXd R = rigid_motions(body.X);
  const Eigen::MatrixXd MR = matrices.M * R;
  const Eigen::Matrix<double, 6, 6> mesh = R.transpose() * MR;
  s.mass = data.mass;
  const Vector3 moment = data.mdCM.m0;
  s.centre = moment / s.mass;
  const Matrix3 J = matrix_of(data.J.m0);
  const Matrix3 c = skew<double>(s.centre);
  s.inertia = J + s.mass * c * c;
  // ∫ r̃ couples the rotations with the translations.
  const double size = body.X.colwise().norm().maxCoeff();
  for (Eigen::Index i = 0; i < 3; ++i)
    s.mesh_difference = std::max(s.mesh_difference, std::abs(mesh(i, i) - s.mass) / s.mass);
  const Matrix3 coupling = mesh.block<3, 3>(3, 0) - skew<double>(moment);
  s.mesh_difference = std::max(s.mesh_difference, coupling.cwiseAbs().maxCoeff() / (s.mass * size));
  const Matrix3 turning = mesh.block<3, 3>(3, 3) - J;
  s.mesh_difference = std::max(s.mesh_difference, turning.cwiseAbs().maxCoeff() / J.cwiseAbs().maxCoeff());
  Eigen::MatrixXd unit = R;
  unit.rightCols(3) /= size;
  s.rigid_stiffness =
      (matrices.K * unit).cwiseAbs().maxCoeff() / Eigen::VectorXd(matrices.K.diagonal()).cwiseAbs().maxCoeff();
  const Eigen::MatrixXd participation = body.modes.transpose() * MR;
  s.effective_mass = participation.cwiseAbs2();
  for (Eigen::Index d = 0; d < 6; ++d) {
    s.effective_mass.col(d) /= mesh(d, d);
    s.held[static_cast<std::size_t>(d)] = s.effective_mass.col(d).sum();
  }
  return s;
}

}  // namespace withy::fem
