/// \file
/// What a singular linear problem leaves over.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <cstddef>
#include <limits>

namespace withy {

/// What rounding leaves of a sum over so many bodies, of the sizes of its terms: each body adds some, weight, inertia
/// and wrenches among them, turned from axes to axes by sums of three products, each known to the last digit.
inline double rounding_of_sums(std::size_t bodies) {
  constexpr double of_a_body = 16;
  return of_a_body * static_cast<double>(1 + bodies) * std::numeric_limits<double>::epsilon();
}

/// Whether what is left over where no column of A leads is small against what is in play there.
/// \param nowhere independent columns L of Lᵀ A = 0
/// \param in_play sizes of the terms that `left` is the sum of, not less than zero; zero admits nothing but zero
inline bool reaches(const Eigen::MatrixXd& nowhere, const Eigen::VectorXd& left, const Eigen::VectorXd& in_play) {
  /// Data are seldom typed more exactly.
  constexpr double share = 1e-9;
  if (!left.allFinite() || !in_play.allFinite()) return false;
  for (const auto& direction : nowhere.colwise())
    if (!(std::abs(direction.dot(left)) <= share * direction.cwiseAbs().dot(in_play))) return false;
  return true;
}

/// The same of a matrix of that rank.
inline bool reaches(const Eigen::MatrixXd& A, Eigen::Index rank, const Eigen::VectorXd& left,
                    const Eigen::VectorXd& in_play) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullU);
  return reaches(svd.matrixU().rightCols(A.rows() - rank), left, in_play);
}

/// The direction among those that nothing holds along which what is left over pushes, or any where it pushes along
/// none: a unit vector.
/// \param none independent columns, one or more
inline Eigen::VectorXd along_unheld(const Eigen::MatrixXd& none, const Eigen::VectorXd& left) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> along(none);
  const Eigen::VectorXd pushed = none * along.solve(left);
  const double size = pushed.norm();
  return size > 0 ? Eigen::VectorXd(pushed / size) : Eigen::VectorXd(none.rightCols<1>().normalized());
}

/// The same of the directions that a matrix of that rank, less than its size, takes to nothing.
inline Eigen::VectorXd unheld(const Eigen::MatrixXd& A, Eigen::Index rank, const Eigen::VectorXd& left) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  return along_unheld(svd.matrixV().rightCols(A.cols() - rank), left);
}

}  // namespace withy
