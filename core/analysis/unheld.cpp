#include "withy/core/analysis/unheld.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace withy {
namespace {

/// Of the greatest pivot: what derivatives are known to at the worst.
constexpr double rank_share = 1e-11;

/// Takes the part along the columns away.
Eigen::VectorXd without_part(const Eigen::VectorXd& x, const Eigen::MatrixXd& columns) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> along(columns);
  return x - columns * along.solve(x);
}

}  // namespace

GradedMatrix::GradedMatrix(const Eigen::MatrixXd& A, const Eigen::VectorXd& floor)
    : rows_(Eigen::VectorXd::Ones(A.rows())), columns_(rows_) {
  const Eigen::Index n = A.rows();
  Eigen::MatrixXd sizes = A.cwiseAbs();
  for (Eigen::Index i = 0; i < floor.size(); ++i) sizes(i, i) = std::max(sizes(i, i), floor[i]);
  // Of a positive matrix no element is greater than what its diagonal allows: units of that are units of all.
  for (Eigen::Index i = 0; i < n; ++i)
    if (sizes(i, i) > 0) rows_[i] = columns_[i] = 1 / std::sqrt(sizes(i, i));
  // Of another they are found in turns (Ruiz 2001).
  constexpr int rounds = 20;
  for (int round = 0; round < rounds; ++round) {
    const Eigen::MatrixXd now = rows_.asDiagonal() * sizes * columns_.asDiagonal();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (const double row = now.row(i).maxCoeff(); row > 0) rows_[i] /= std::sqrt(row);
      if (const double column = now.col(i).maxCoeff(); column > 0) columns_[i] /= std::sqrt(column);
    }
  }
  solver_.setThreshold(rank_share);
  solver_.compute(rows_.asDiagonal() * A * columns_.asDiagonal());
}

Eigen::MatrixXd GradedMatrix::unheld() const {
  const Eigen::Index n = rows_.size();
  Eigen::MatrixXd last = Eigen::MatrixXd::Zero(n, missing());
  last.bottomRows(missing()).setIdentity();
  const Eigen::MatrixXd Z = solver_.matrixZ();
  return columns_.asDiagonal() * (solver_.colsPermutation() * (Z.transpose() * last));
}

Eigen::MatrixXd GradedMatrix::unreached() const {
  const Eigen::MatrixXd Q = solver_.householderQ() * Eigen::MatrixXd::Identity(rows_.size(), rows_.size());
  return rows_.asDiagonal() * Q.rightCols(missing());
}

Eigen::VectorXd GradedMatrix::solve(const Eigen::VectorXd& b) const {
  const auto any = [&](const Eigen::VectorXd& right) -> Eigen::VectorXd {
    return columns_.cwiseProduct(solver_.solve(rows_.cwiseProduct(right)));
  };
  if (missing() == 0) return any(b);
  return without_part(any(without_part(b, unreached())), unheld());
}

Apart::Apart(Eigen::MatrixXd given, const Apart* others) : columns(std::move(given)) {
  if (others != nullptr) {
    for (std::size_t k = 0; k < others->rows.size(); ++k)
      columns -= (others->columns.col(static_cast<Eigen::Index>(k)) * columns.row(others->rows[k])).eval();
  }
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    Eigen::Index row = 0, column = 0;
    columns.rightCols(columns.cols() - k).cwiseAbs().maxCoeff(&row, &column);
    if (column > 0) columns.col(k).swap(columns.col(k + column));
    columns.col(k) /= double(columns(row, k));
    for (Eigen::Index j = 0; j < columns.cols(); ++j)
      if (j != k) columns.col(j) -= double(columns(row, j)) * columns.col(k);
    rows.push_back(row);
  }
}

Quotient::Quotient(const Eigen::MatrixXd& A, const Eigen::MatrixXd& directions) : apart_(directions) {
  const std::vector<Eigen::Index>& gone = apart_.rows;
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    if (std::find(gone.begin(), gone.end(), i) == gone.end()) kept_.push_back(i);
  // Each vector stands as the one without the rows that are gone: what A adds there goes along the directions.
  dropped_ = A(gone, kept_);
  matrix_ = A(kept_, kept_) - apart_.columns(kept_, Eigen::all) * dropped_;
}

Eigen::MatrixXd Quotient::rounding(const Eigen::MatrixXd& of_A) const {
  return of_A(kept_, kept_) + apart_.columns(kept_, Eigen::all).cwiseAbs() * of_A(apart_.rows, kept_);
}

Eigen::MatrixXcd Quotient::vectors(const Eigen::VectorXcd& values, const Eigen::MatrixXcd& of_matrix) const {
  Eigen::MatrixXcd all = Eigen::MatrixXcd::Zero(apart_.columns.rows(), of_matrix.cols());
  all(kept_, Eigen::all) = of_matrix;
  const Eigen::MatrixXcd along = dropped_ * of_matrix * values.cwiseInverse().asDiagonal();
  return all + apart_.columns * along;
}

Eigen::MatrixXcd Quotient::left_vectors(const Eigen::MatrixXcd& of_matrix) const {
  Eigen::MatrixXcd all(apart_.columns.rows(), of_matrix.cols());
  all(kept_, Eigen::all) = of_matrix;
  // Each direction alone moves one of the rows that are gone.
  all(apart_.rows, Eigen::all) = -apart_.columns(kept_, Eigen::all).transpose() * of_matrix;
  return all;
}

Eigen::MatrixXd Quotient::lifted(const Eigen::MatrixXd& of_matrix) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(apart_.columns.rows(), of_matrix.cols());
  all(kept_, Eigen::all) = of_matrix;
  return all;
}

Eigen::MatrixXd rounding_of(const Eigen::MatrixXd& A) {
  constexpr double of_terms = 1e-13, of_greatest = 2e-16;
  if (A.size() == 0) return A;
  const auto n = static_cast<double>(A.rows());
  const Eigen::RowVectorXd columns = A.cwiseAbs().colwise().maxCoeff();
  return (n * (of_terms * columns.array() + of_greatest * columns.maxCoeff())).matrix().replicate(A.rows(), 1);
}

Eigen::MatrixXd unheld_but_for(const Eigen::MatrixXd& A, const Eigen::MatrixXd& rounding) {
  if (A.size() == 0) return A;
  const Eigen::MatrixXd known = (A.array().abs() > rounding.array()).select(A, 0.0);
  return GradedMatrix(known, Eigen::VectorXd()).unheld();
}

Unchained::Unchained(const Eigen::MatrixXd& A, const Eigen::MatrixXd& first)
    : matrix_(A),
      directions_(A.rows(), 0),
      led_to_(A.rows(), 0),
      share_(A.rows() > 0 ? 1e-13 * static_cast<double>(A.rows()) * A.colwise().norm().maxCoeff() : 0.0) {
  for (Eigen::MatrixXd next = first; next.cols() > 0; next = unheld()) {
    if (links_.size() == 1) led_to_ = links_[0].along(next);
    Eigen::MatrixXd lifted = next;
    for (auto link = links_.rbegin(); link != links_.rend(); ++link) lifted = link->lifted(lifted);
    directions_.conservativeResize(Eigen::NoChange, directions_.cols() + next.cols());
    directions_.rightCols(next.cols()) = lifted;
    links_.emplace_back(matrix_, next);
    matrix_ = links_.back().matrix();
  }
}

/// What is left takes these to nothing, but for rounding of what A was.
Eigen::MatrixXd Unchained::unheld() const {
  const Eigen::Index n = matrix_.rows();
  const double largest = n > 0 ? matrix_.colwise().norm().maxCoeff() : 0.0;
  if (!(largest > 0)) return Eigen::MatrixXd::Identity(n, n);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> rows(n, n);
  rows.setThreshold(share_ / largest);
  rows.compute(matrix_);
  const Eigen::MatrixXd Z = rows.matrixZ();
  return rows.colsPermutation() * Z.bottomRows(n - rows.rank()).transpose();
}

Eigen::MatrixXcd Unchained::vectors(const Eigen::VectorXcd& values, Eigen::MatrixXcd of_matrix) const {
  for (auto link = links_.rbegin(); link != links_.rend(); ++link) of_matrix = link->vectors(values, of_matrix);
  return of_matrix;
}

Eigen::MatrixXcd Unchained::left_vectors(Eigen::MatrixXcd of_matrix) const {
  for (auto link = links_.rbegin(); link != links_.rend(); ++link) of_matrix = link->left_vectors(of_matrix);
  return of_matrix;
}

}  // namespace withy
