#include "feasible_moments.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <stdexcept>

namespace withy {
namespace {

using Eigen::MatrixXd;

/// Below this part of the greatest second moment a body has no extent.
constexpr double no_extent = 1e-13;

/// Trace and skew part of every 3×3 block, the rest zero: orthogonal projection.
MatrixXd kept_part(const MatrixXd& m) {
  MatrixXd out(m.rows(), m.cols());
  for (Eigen::Index k = 0; k < m.rows(); k += 3) {
    for (Eigen::Index l = 0; l < m.cols(); l += 3) {
      const Matrix3 b = m.block<3, 3>(k, l);
      out.block<3, 3>(k, l) = b.trace() / 3 * Matrix3::Identity() + 0.5 * (b - b.transpose());
    }
  }
  return out;
}

/// Y = kept_part(Y) with kept_part(Y R + R Y) = E, by conjugate gradients: the operator is symmetric and semidefinite
/// on that space, and E lies in it.
MatrixXd correction(const MatrixXd& R, const MatrixXd& E) {
  const auto apply = [&R](const MatrixXd& Y) {
    const MatrixXd YR = Y * R;
    return kept_part(YR + YR.transpose());
  };
  MatrixXd Y = MatrixXd::Zero(R.rows(), R.cols()), r = E, p = E;
  double rr = r.squaredNorm();
  const double small = 1e-28 * rr;
  for (int k = 0; k < 1000 && rr > small; ++k) {
    const MatrixXd Ap = apply(p);
    const double curvature = p.cwiseProduct(Ap).sum();
    if (curvature <= 0) break;
    const double alpha = rr / curvature;
    Y += alpha * p;
    r -= alpha * Ap;
    const double next = r.squaredNorm();
    p = r + next / rr * p;
    rr = next;
  }
  return Y;
}

/// A semidefinite matrix with the kept part of `given`: from its nearest one, with eigenvalues of at least `floor` of
/// the greatest, by congruences R → (1 + Y) R (1 + Y), Newton's method for the kept part. They keep the range.
MatrixXd semidefinite(const MatrixXd& given, double floor, double& error) {
  const MatrixXd target = kept_part(given);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(given);
  const MatrixXd V = eigen.eigenvectors();
  const double least = floor * eigen.eigenvalues().cwiseAbs().maxCoeff();
  MatrixXd R = V * eigen.eigenvalues().cwiseMax(least).asDiagonal() * V.transpose();
  MatrixXd best = R;
  error = (target - kept_part(R)).cwiseAbs().maxCoeff();
  for (int k = 0; k < 100 && error > 1e-15; ++k) {
    MatrixXd Y = correction(R, target - kept_part(R));
    if (const double size = Y.norm(); size > 0.5) Y *= 0.5 / size;
    Y.diagonal().array() += 1;
    R = Y * R * Y.transpose();
    R = 0.5 * (R + R.transpose()).eval();
    if (const double e = (target - kept_part(R)).cwiseAbs().maxCoeff(); e < error) {
      error = e;
      best = R;
    } else if (error < 1e-13) {
      break;  // rounding
    }
  }
  return best;
}

}  // namespace

RigidBasis::RigidBasis(const MassIntegrals& m) : root_mass_(std::sqrt(m.mass)), center_(m.x / m.mass) {
  const Matrix3 central = m.xx - m.mass * center_ * center_.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(central);
  const double greatest = std::max(m.xx.trace(), 0.0);
  if (eigen.eigenvalues()[0] < -1e-9 * greatest || (greatest == 0 && !central.isZero(0))) {
    throw std::domain_error(
        fmt::format("mass, mdCM and J contradict each other: some direction would have a mean squared extent of {} m^2",
                    eigen.eigenvalues()[0] / m.mass));
  }
  axes_ = eigen.eigenvectors();
  for (Eigen::Index a = 0; a < 3; ++a) {
    const double d = eigen.eigenvalues()[a];
    roots_[a] = d > no_extent * greatest ? std::sqrt(d) : 0;
  }
}

Eigen::Matrix<double, 4, 3> RigidBasis::coefficients(const Vector3& f, const Matrix3& x_f, double& left) const {
  Eigen::Matrix<double, 4, 3> c;
  c.row(0) = f.transpose() / root_mass_;
  const Matrix3 along = axes_.transpose() * (x_f - center_ * f.transpose());
  for (Eigen::Index a = 0; a < 3; ++a) {
    if (roots_[a] > 0) {
      c.row(1 + a) = along.row(a) / roots_[a];
    } else {
      c.row(1 + a).setZero();
      left = std::max(left, along.row(a).norm());
    }
  }
  return c;
}

Eigen::Matrix<double, 4, 3> RigidBasis::position() const {
  Eigen::Matrix<double, 4, 3> c;
  c.row(0) = root_mass_ * center_.transpose();
  c.bottomRows<3>() = roots_.asDiagonal() * axes_.transpose();
  return c;
}

MatrixXd RigidBasis::modes(const MassIntegrals& m, double& left) const {
  MatrixXd c(4, 3 * m.modes());
  for (Eigen::Index k = 0; k < m.modes(); ++k) {
    c.middleCols(3 * k, 3) = coefficients(m.phi.col(k), m.x_phi[static_cast<std::size_t>(k)], left);
  }
  return c;
}

MatrixXd mode_moments(const MassIntegrals& m) {
  const Eigen::Index n = m.modes();
  MatrixXd D(3 * n, 3 * n);
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index l = 0; l < n; ++l) D.block<3, 3>(3 * k, 3 * l) = m.phi_phi[m.pair(k, l)];
  }
  return 0.5 * (D + D.transpose());
}

double make_feasible(MassIntegrals& m) {
  const Eigen::Index n = m.modes();
  if (n == 0) return 0;
  double left = 0;
  const MatrixXd rigid = RigidBasis(m).modes(m, left);
  const MatrixXd D = mode_moments(m);
  Eigen::VectorXd scale(3 * n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double modal = D.block<3, 3>(3 * k, 3 * k).trace();
    const double least = rigid.middleCols(3 * k, 3).squaredNorm();
    if (!(modal > 0) || least > modal * (1 + 1e-6)) {
      throw std::domain_error(fmt::format(
          "no mass has these integrals: Ct, Cr and J make a rigid motion of kinetic energy {} a unit of rate part of "
          "mode {}, whose whole energy by Me is {}",
          least / 2, k + 1, modal / 2));
    }
    scale.segment<3>(3 * k).setConstant(1 / std::sqrt(modal));
  }
  const MatrixXd projected = rigid.transpose() * rigid;
  const MatrixXd R = scale.asDiagonal() * (D - projected) * scale.asDiagonal();
  const double lowest = Eigen::SelfAdjointEigenSolver<MatrixXd>(R, Eigen::EigenvaluesOnly).eigenvalues()[0];
  if (lowest > -1e-14 * static_cast<double>(n)) return 0;
  // In the range of the given moments first; where that has none, with a little of every direction.
  double error = 0;
  MatrixXd better = semidefinite(R, 0, error);
  if (error > 1e-12) {
    double other = 0;
    const MatrixXd wider = semidefinite(R, 1e-6, other);
    if (other < error) {
      better = wider;
      error = other;
    }
  }
  if (error > 1e-6) {
    throw std::domain_error(
        fmt::format("no mass has these integrals: Me contradicts Ct, Cr, J or Ge by {:.2g} of the "
                    "modal masses",
                    error));
  }
  const Eigen::VectorXd back = scale.cwiseInverse();
  const MatrixXd all = projected + MatrixXd(back.asDiagonal() * better * back.asDiagonal());
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index l = 0; l < n; ++l) m.phi_phi[m.pair(k, l)] = all.block<3, 3>(3 * k, 3 * l);
  }
  return error;
}

}  // namespace withy
