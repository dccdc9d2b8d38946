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
  /// What its elements may be off by where those of A may be by this.
  [[nodiscard]] Eigen::MatrixXd rounding(const Eigen::MatrixXd& of_A) const;
  /// The eigenvectors of A of the eigenvalues, none of them zero, from those of the matrix.
  [[nodiscard]] Eigen::MatrixXcd vectors(const Eigen::VectorXcd& values, const Eigen::MatrixXcd& of_matrix) const;
  /// Its left eigenvectors from those of the matrix: they see none of the directions.
  [[nodiscard]] Eigen::MatrixXcd left_vectors(const Eigen::MatrixXcd& of_matrix) const;
  /// Columns that stand for those of the matrix.
  [[nodiscard]] Eigen::MatrixXd lifted(const Eigen::MatrixXd& of_matrix) const;
  /// What A makes of those columns along the directions.
  [[nodiscard]] Eigen::MatrixXd along(const Eigen::MatrixXd& of_matrix) const {
    return apart_.columns * (dropped_ * of_matrix);
  }

 private:
  Apart apart_;
  std::vector<Eigen::Index> kept_;
  Eigen::MatrixXd matrix_, dropped_;
};

/// What elements of a matrix may be off by: rounding of their columns, whose elements are made of the same terms, and
/// of what the QR algorithm leaves of its greatest.
Eigen::MatrixXd rounding_of(const Eigen::MatrixXd& A);

/// Independent columns that A takes to nothing where elements within `rounding` are zero, and each row and column is
/// measured by itself.
Eigen::MatrixXd unheld_but_for(const Eigen::MatrixXd& A, const Eigen::MatrixXd& rounding);

/// A matrix freed of its zeros link by link: motions that nothing holds are chains of them.
class Unchained {
 public:
  /// \param first independent columns that A takes to nothing; where there are none it has no zeros
  Unchained(const Eigen::MatrixXd& A, const Eigen::MatrixXd& first);

  /// Vectors of A, one a zero, those of `first` first.
  [[nodiscard]] const Eigen::MatrixXd& directions() const { return directions_; }
  /// Directions among `first` that A itself leads to: ends of chains, which go on at any rate.
  [[nodiscard]] const Eigen::MatrixXd& led_to() const { return led_to_; }
  /// What is left: the other eigenvalues of A.
  [[nodiscard]] const Eigen::MatrixXd& matrix() const { return matrix_; }
  /// The eigenvectors of A of these, from those of the matrix, right and left.
  [[nodiscard]] Eigen::MatrixXcd vectors(const Eigen::VectorXcd& values, Eigen::MatrixXcd of_matrix) const;
  [[nodiscard]] Eigen::MatrixXcd left_vectors(Eigen::MatrixXcd of_matrix) const;

 private:
  [[nodiscard]] Eigen::MatrixXd unheld() const;

  Eigen::MatrixXd matrix_, directions_, led_to_;
  double share_;  ///< rounding of what A was
  std::vector<Quotient> links_;
};

}  // namespace withy
