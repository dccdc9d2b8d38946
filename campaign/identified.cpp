#include "withy/campaign/identified.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace withy::campaign {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<Undetermined> undetermined(const Sensitivity& s) {
  constexpr double beyond_error = 3, rounding = 1e-12, noted = 0.01;
  std::vector<Undetermined> found;
  std::vector<Index> kept;
  const double greatest = s.J.colwise().norm().maxCoeff();
  for (Index j = 0; j < s.J.cols(); ++j) {
    const VectorXd column = s.J.col(j);
    const MatrixXd known = s.J(Eigen::all, kept);
    const VectorXd c = kept.empty() ? VectorXd() : VectorXd(known.colPivHouseholderQr().solve(column));
    double error = s.error[j] + rounding * greatest;
    for (Index k = 0; k < c.size(); ++k) error += std::abs(c[k]) * s.error[kept[static_cast<std::size_t>(k)]];
    const double rest = kept.empty() ? column.norm() : (column - known * c).norm();
    if (rest > beyond_error * error) {
      kept.push_back(j);
      continue;
    }
    Undetermined u{static_cast<std::size_t>(j), {}};
    const bool has_effect = column.norm() > beyond_error * (s.error[j] + rounding * greatest);
    for (Index k = 0; has_effect && k < c.size(); ++k)
      if (std::abs(c[k]) > noted)
        u.same_as.emplace_back(static_cast<std::size_t>(kept[static_cast<std::size_t>(k)]), c[k]);
    found.push_back(std::move(u));
  }
  return found;
}

namespace {

/// The triangle of J = Q R: few rows for whatever follows.
MatrixXd triangle(const MatrixXd& J) {
  const Eigen::HouseholderQR<MatrixXd> qr(J);
  return qr.matrixQR().topRows(J.cols()).triangularView<Eigen::Upper>();
}

}  // namespace

VectorXd singular_values(const MatrixXd& J) { return Eigen::JacobiSVD<MatrixXd>(triangle(J)).singularValues(); }

MatrixXd covariance(const MatrixXd& J, const VectorXd& variances) {
  const MatrixXd R = triangle(J);
  const MatrixXd half = R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(R.rows(), R.cols()));
  const MatrixXd inverse = half * half.transpose();
  const MatrixXd middle = J.transpose() * variances.asDiagonal() * J;
  return inverse * middle * inverse;
}

}  // namespace withy::campaign
