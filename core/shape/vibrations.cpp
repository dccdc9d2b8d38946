#include "withy/core/shape/vibrations.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace withy {

bool is_rounding(double square, double greatest) {
  return std::abs(square) <= 16 * std::numeric_limits<double>::epsilon() * greatest;
}

Eigen::Index Vibrations::rigid() const {
  if (squares.size() == 0) return 0;
  const double greatest = squares.cwiseAbs().maxCoeff();
  return std::count_if(squares.begin(), squares.end(), [&](double s) { return s < 0 || is_rounding(s, greatest); });
}

std::vector<std::vector<Eigen::Index>> coupled_coordinates(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G) {
  const Eigen::Index n = K.rows();
  std::vector<std::vector<Eigen::Index>> groups;
  std::vector<bool> taken(static_cast<std::size_t>(n), false);
  const auto couples = [](const Eigen::MatrixXd& m, Eigen::Index i, Eigen::Index j) {
    return std::abs(m(i, j)) > 1e-12 * std::sqrt(std::abs(m(i, i) * m(j, j)));
  };
  for (Eigen::Index first = 0; first < n; ++first) {
    if (taken[static_cast<std::size_t>(first)]) continue;
    std::vector<Eigen::Index> group = {first};
    taken[static_cast<std::size_t>(first)] = true;
    for (std::size_t k = 0; k < group.size(); ++k) {
      for (Eigen::Index j = 0; j < n; ++j) {
        if (taken[static_cast<std::size_t>(j)] || !(couples(K, group[k], j) || couples(G, group[k], j))) continue;
        taken[static_cast<std::size_t>(j)] = true;
        group.push_back(j);
      }
    }
    std::sort(group.begin(), group.end());
    groups.push_back(std::move(group));
  }
  return groups;
}

Vibrations vibrations(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G) {
  if (Eigen::LLT<Eigen::MatrixXd>(G).info() != Eigen::Success)
    throw std::domain_error("the mass matrix is not positive definite");
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, G);
  Vibrations v{solver.eigenvalues(), solver.eigenvectors()};
  for (Eigen::Index i = 0; i < v.squares.size(); ++i) {
    const Eigen::VectorXd force = K * v.vectors.col(i);
    v.squares[i] = v.vectors.col(i).dot(force);
  }
  return v;
}

}  // namespace withy
