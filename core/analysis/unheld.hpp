/// \file
/// What a stiffness does not hold, beside others that may be larger by any power of ten.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <vector>

namespace withy {

/// A square matrix whose rows and columns are each measured by themselves: what is soft is not rounding of what is
/// stiff. Element i of the diagonal counts as no less than a floor: the size of the terms that make it, beside which
/// it may be rounding.
class GradedMatrix {
 public:
  GradedMatrix() = default;
  /// \param floor for the first rows and columns; those beyond it have none
  GradedMatrix(const Eigen::MatrixXd& A, const Eigen::VectorXd& floor);

  [[nodiscard]] Eigen::Index rank() const { return solver_.rank(); }
  [[nodiscard]] Eigen::Index missing() const { return rows_.size() - rank(); }
  /// Independent columns that A takes to nothing, N of A N = 0.
  [[nodiscard]] Eigen::MatrixXd unheld() const;
  /// Independent columns that A leads to no part of, L of Lᵀ A = 0.
  [[nodiscard]] Eigen::MatrixXd unreached() const;
  /// The shortest x that leaves the shortest b − A x.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  Eigen::VectorXd rows_, columns_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver_;
};

/// Columns that span the same, such that each has a row, that of its greatest element, in which all others are zero.
struct Apart {
  Eigen::MatrixXd columns;
  std::vector<Eigen::Index> rows;

  /// \param others whose rows are to be zero too; null: none
  explicit Apart(Eigen::MatrixXd given, const Apart* others = nullptr);
};

/// A matrix A without what it takes to nothing: what it does to vectors of which those that differ by such a direction
/// are one. Its eigenvalues are those of A but for as many zeros.
class Quotient {
 public:
  /// \param directions independent columns, A directions = 0
  Quotient(const Eigen::MatrixXd& A, const Eigen::MatrixXd& directions);

  [[nodiscard]] const Eigen::MatrixXd& matrix() const { return matrix_; }
  /// The eigenvectors of A of the eigenvalues, none of them zero, from those of the matrix.
  [[nodiscard]] Eigen::MatrixXcd vectors(const Eigen::VectorXcd& values, const Eigen::MatrixXcd& of_matrix) const;
  /// Columns that stand for those of the matrix.
  [[nodiscard]] Eigen::MatrixXd lifted(const Eigen::MatrixXd& of_matrix) const;

 private:
  Apart apart_;
  std::vector<Eigen::Index> kept_;
  Eigen::MatrixXd matrix_, dropped_;
};

}  // namespace withy
