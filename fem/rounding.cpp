#include "rounding.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace withy::fem {
namespace {

/// The nodes that K couples with node a, itself among them.
std::vector<Eigen::Index> neighbours(const SparseMatrix& K, Eigen::Index a) {
  std::vector<Eigen::Index> nodes;
  for (Eigen::Index c = 0; c < 3; ++c)
    for (SparseMatrix::InnerIterator it(K, 3 * a + c); it; ++it) nodes.push_back(it.row() / 3);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// Rotations by which the neighbours move about node a in each mode, by least squares; 3×n.
Matrix3X rotations_about(Eigen::Index a, const std::vector<Eigen::Index>& near, const Matrix3X& X,
                         const Eigen::MatrixXd& modes) {
  Matrix3 sum = Matrix3::Zero();
  Matrix3X moments = Matrix3X::Zero(3, modes.cols());
  for (const Eigen::Index b : near) {
    const Vector3 arm = X.col(b) - X.col(a);
    sum += arm.squaredNorm() * Matrix3::Identity() - arm * arm.transpose();
    moments += skew<double>(arm) * (modes.middleRows(3 * b, 3) - modes.middleRows(3 * a, 3));
  }
  return sum.completeOrthogonalDecomposition().solve(moments);
}

/// Forces under what the neighbours of each node do as one rigid piece, 3N×n, and of each mode the work of all forces
/// of strain by their magnitudes [N m].
struct Split {
  Eigen::MatrixXd rigid;
  Eigen::VectorXd strain;
};

Split split(const Matrices& m, const Eigen::MatrixXd& modes) {
  Split s{Eigen::MatrixXd::Zero(modes.rows(), modes.cols()), Eigen::VectorXd::Zero(modes.cols())};
  for (Eigen::Index a = 0; a < m.X.cols(); ++a) {
    const Matrix3X turns = rotations_about(a, neighbours(m.K, a), m.X, modes);
    for (Eigen::Index c = 0; c < 3; ++c) {
      for (SparseMatrix::InnerIterator it(m.K, 3 * a + c); it; ++it) {
        const Eigen::Index b = it.row() / 3, axis = it.row() % 3;
        const Vector3 arm = m.X.col(b) - m.X.col(a);
        const Eigen::RowVectorXd rigid =
            modes.row(3 * a + axis) + Vector3::Unit(axis).transpose() * -skew<double>(arm) * turns;
        s.rigid.row(3 * a + c) += it.value() * rigid;
        s.strain += (std::abs(it.value()) * modes.row(3 * a + c).cwiseProduct(modes.row(it.row()) - rigid).cwiseAbs())
                        .transpose();
      }
    }
  }
  return s;
}

}  // namespace

int digits_of(double unit) {
  return static_cast<int>(std::lround(-std::log10(std::max(unit, std::numeric_limits<double>::epsilon()))));
}

// The greatest sum of a row's elements, which a translation of the mesh is, relative to that of their magnitudes.
double rounding_unit(const SparseMatrix& K) {
  double unit = 0;
  for (Eigen::Index i = 0; i < K.outerSize(); ++i) {
    Vector3 sum = Vector3::Zero();
    double magnitude = 0;
    for (SparseMatrix::InnerIterator it(K, i); it; ++it) {
      sum[it.row() % 3] += it.value();
      magnitude += std::abs(it.value());
    }
    if (magnitude > 0) unit = std::max(unit, sum.cwiseAbs().maxCoeff() / magnitude);
  }
  return unit;
}

Rounding rounding_of(const Matrices& matrices, const Eigen::MatrixXd& modes, const Eigen::VectorXd& omega) {
  const Split s = split(matrices, modes);
  Rounding rounding{rounding_unit(matrices.K), {}};
  const Eigen::MatrixXd excess = modes.transpose() * s.rigid;
  Eigen::MatrixXd without = -0.5 * (excess + excess.transpose());
  without.diagonal() += omega.cwiseAbs2();
  const Eigen::VectorXd squares =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(without, Eigen::EigenvaluesOnly).eigenvalues();
  rounding.frequency_error = (squares.cwiseMax(0).cwiseSqrt().cwiseQuotient(omega).array() - 1).abs().matrix() +
                             0.5 * rounding.unit * s.strain.cwiseQuotient(omega.cwiseAbs2());
  rounding.frequency_error = rounding.frequency_error.cwiseMin(1);
  return rounding;
}

}  // namespace withy::fem
