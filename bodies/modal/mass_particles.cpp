#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

#include "feasible_moments.hpp"
#include "mass_integrals.hpp"
#include "withy/bodies/equal_particles.hpp"

namespace withy {
namespace {

using Eigen::MatrixXd;

/// Coefficients of all Φ in orthonormal functions beyond the rigid ones: Lᵀ L is what their moments have beside the
/// rigid part.
MatrixXd elastic_coefficients(const MassIntegrals& m, const MatrixXd& rigid) {
  const MatrixXd R = mode_moments(m) - rigid.transpose() * rigid;
  // Modes have different units: scaled, each by its own modal mass, small ones are not lost beside great ones.
  Eigen::VectorXd root(R.rows());
  for (Eigen::Index k = 0; k < m.modes(); ++k) {
    root.segment<3>(3 * k).setConstant(std::sqrt(m.phi_phi[m.pair(k, k)].trace()));
  }
  const Eigen::VectorXd scale = root.cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * R * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scaled);
  MatrixXd L(R.rows(), R.cols());
  Eigen::Index rank = 0;
  for (Eigen::Index i = R.rows() - 1; i >= 0 && eigen.eigenvalues()[i] > 1e-16; --i, ++rank) {
    L.row(rank) = std::sqrt(eigen.eigenvalues()[i]) * eigen.eigenvectors().col(i).cwiseProduct(root).transpose();
  }
  return L.topRows(rank);
}

}  // namespace

std::vector<Particle> particles_of(const MassIntegrals& m, double& defect) {
  const Eigen::Index n = m.modes();
  const RigidBasis basis(m);
  double left = 0;
  const MatrixXd rigid = basis.modes(m, left);
  const MatrixXd elastic = n > 0 ? elastic_coefficients(m, rigid) : MatrixXd(0, 0);
  const Eigen::Index count = 4 + elastic.rows();
  MatrixXd all(count, 3 * n);
  all.topRows<4>() = rigid;
  all.bottomRows(elastic.rows()) = elastic;
  double size = 0;
  for (const Matrix3& x_phi : m.x_phi) size = std::max(size, x_phi.cwiseAbs().maxCoeff());
  if (size > 0) defect = std::max(defect, left / size);

  const auto at_particles = [&](const MatrixXd& rigid_coefficients) {
    MatrixXd padded = MatrixXd::Zero(count, rigid_coefficients.cols());
    padded.topRows<4>() = rigid_coefficients;
    return at_particle_pairs(padded, m.mass);
  };
  const MatrixXd X = at_particles(basis.position());
  const MatrixXd phi = at_particle_pairs(all, m.mass);
  std::vector<Particle> particles(static_cast<std::size_t>(phi.rows()));
  for (Eigen::Index i = 0; i < phi.rows(); ++i) {
    Particle& p = particles[static_cast<std::size_t>(i)];
    p.mass = m.mass / static_cast<double>(phi.rows());
    p.at = PointExpansion::rigid(X.row(i).transpose(), n);
    for (Eigen::Index k = 0; k < n; ++k) p.at.phi.col(k) = phi.block<1, 3>(i, 3 * k).transpose();
  }
  left = size = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index l = 0; l < n; ++l) {
      const std::size_t at = m.pair(k, l);
      const MatrixXd g = at_particles(basis.coefficients(m.gamma[at], m.x_gamma[at], left));
      size = std::max({size, m.x_gamma[at].cwiseAbs().maxCoeff(), m.phi_phi[at].cwiseAbs().maxCoeff()});
      for (Eigen::Index i = 0; i < phi.rows(); ++i) {
        for (Eigen::Index c = 0; c < 3; ++c) {
          particles[static_cast<std::size_t>(i)].at.gamma[static_cast<std::size_t>(c)](k, l) = g(i, c);
        }
      }
    }
  }
  if (size > 0) defect = std::max(defect, left / size);
  return particles;
}

}  // namespace withy
