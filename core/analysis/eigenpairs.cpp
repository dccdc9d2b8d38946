#include "withy/core/analysis/eigenpairs.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <vector>

#include "withy/core/analysis/linear_system.hpp"

namespace withy {
namespace {

/// Greatest over smallest: up to here the QR algorithm leaves digits enough.
constexpr double far_apart = 1e4;
/// Neighbours between which what is fast and what is slow may be told apart: no pair, and nothing that is double.
constexpr double told_apart = 1.01;

/// The greatest first.
Eigenpairs in_order(const Eigenpairs& found) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(found.values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::abs(found.values[a]) > std::abs(found.values[b]);
  });
  return {found.values(order), found.vectors(Eigen::all, order)};
}

Eigenpairs balanced_pairs(const Eigen::MatrixXd& A) {
  const Eigen::VectorXd units = balance_of_states(A);
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(units.cwiseInverse().asDiagonal() * A * units.asDiagonal());
  if (solver.info() != Eigen::Success) throw std::domain_error("the eigenvalues were not found");
  Eigenpairs found{solver.eigenvalues(), units.asDiagonal() * solver.eigenvectors()};
  for (Eigen::Index i = 0; i < found.vectors.cols(); ++i) found.vectors.col(i).normalize();
  return in_order(found);
}

/// Elements that are rows' and columns' own rounding stay so: each is measured by itself.
std::optional<Eigen::MatrixXd> inverse(const Eigen::MatrixXd& A) {
  Eigen::VectorXd rows = A.rowwise().lpNorm<Eigen::Infinity>();
  for (double& row : rows) row = row > 0 ? 1 / row : 1.0;
  Eigen::MatrixXd scaled = rows.asDiagonal() * A;
  Eigen::VectorXd columns = scaled.colwise().lpNorm<Eigen::Infinity>();
  for (double& column : columns) column = column > 0 ? 1 / column : 1.0;
  scaled *= columns.asDiagonal();
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(scaled);
  if (!lu.isInvertible()) return {};
  Eigen::MatrixXd found = columns.asDiagonal() * lu.inverse() * rows.asDiagonal();
  if (!found.allFinite()) return {};
  return found;
}

/// How many of the greatest the matrix tells and the inverse the rest: next to the middle of all that are clearly apart
/// there in both.
std::optional<Eigen::Index> fast_ones(const Eigen::VectorXd& of_matrix, const Eigen::VectorXd& of_inverse) {
  const double middle = std::sqrt(of_matrix[0]) * std::sqrt(of_inverse[of_inverse.size() - 1]);
  std::optional<Eigen::Index> best;
  double least = 0;
  for (Eigen::Index k = 1; k < of_matrix.size(); ++k) {
    if (!(of_matrix[k - 1] > told_apart * of_matrix[k]) || !(of_inverse[k - 1] > told_apart * of_inverse[k])) continue;
    // The last of the fast ones as the matrix has it, the first of the slow ones as the inverse does.
    if (!(of_matrix[k - 1] > of_inverse[k])) continue;
    const double away = std::abs(std::log(of_matrix[k - 1] / middle) + std::log(of_inverse[k] / middle));
    if (!best || away < least) best = k, least = away;
  }
  return best;
}

}  // namespace

Eigenpairs eigenpairs(const Eigen::MatrixXd& A) {
  if (!A.allFinite()) throw std::domain_error("the derivatives at this state are not finite");
  if (A.rows() == 0) return {};
  Eigenpairs found = balanced_pairs(A);
  const Eigen::Index n = A.rows();
  if (std::abs(found.values[0]) <= far_apart * std::abs(found.values[n - 1])) return found;
  const std::optional<Eigen::MatrixXd> inverted = inverse(A);
  if (!inverted) return found;
  Eigenpairs slow = balanced_pairs(*inverted);
  slow.values = slow.values.reverse().cwiseInverse().eval();
  slow.vectors = slow.vectors.rowwise().reverse().eval();
  const std::optional<Eigen::Index> fast = fast_ones(found.values.cwiseAbs(), slow.values.cwiseAbs());
  if (!fast) return found;
  found.values.tail(n - *fast) = slow.values.tail(n - *fast);
  found.vectors.rightCols(n - *fast) = slow.vectors.rightCols(n - *fast);
  return found;
}

}  // namespace withy
