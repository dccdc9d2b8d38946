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
