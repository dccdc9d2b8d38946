/// \file
/// What a singular linear problem leaves over.
#pragma once

#include <Eigen/Core>
#include <Eigen/SVD>
#include <cmath>

namespace withy {

/// Whether what is left over where no column of A leads, a matrix of that rank, is small against what is in play there.
/// \param in_play sizes of the terms that `left` is the sum of, not less than zero; zero admits nothing but zero
inline bool reaches(const Eigen::MatrixXd& A, Eigen::Index rank, const Eigen::VectorXd& left,
                    const Eigen::VectorXd& in_play) {
  /// Data are seldom typed more exactly.
  constexpr double share = 1e-9;
  if (!left.allFinite() || !in_play.allFinite()) return false;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullU);
  for (Eigen::Index i = rank; i < A.rows(); ++i) {
    const Eigen::VectorXd direction = svd.matrixU().col(i);
    if (!(std::abs(direction.dot(left)) <= share * direction.cwiseAbs().dot(in_play))) return false;
  }
  return true;
}

/// The direction that A takes to nothing along which what is left over pushes, or any where it pushes along none: a
/// unit vector. \param rank of A, less than its size
inline Eigen::VectorXd unheld(const Eigen::MatrixXd& A, Eigen::Index rank, const Eigen::VectorXd& left) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  const auto none = svd.matrixV().rightCols(A.cols() - rank);
  const Eigen::VectorXd pushed = none * (none.transpose() * left);
  const double size = pushed.norm();
  return size > 0 ? Eigen::VectorXd(pushed / size) : Eigen::VectorXd(svd.matrixV().rightCols<1>());
}

}  // namespace withy
