/// \file
/// Particles of equal mass in the place of a distribution of mass.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace withy {

/// Values of fields at particles of equal mass, from the coefficients of the fields (a column each) in orthonormal
/// functions over the mass [kg], the first of which is constant: as many particles as functions, row for row. Integrals
/// over the mass of products of fields are sums over the particles, to rounding: the orthogonal matrix between the two,
/// a reflection, takes the first function to a constant one.
inline Eigen::MatrixXd at_equal_particles(const Eigen::MatrixXd& coefficients, double mass) {
  const Eigen::Index count = coefficients.rows();
  const double root = std::sqrt(static_cast<double>(count));
  Eigen::MatrixXd values = root / std::sqrt(mass) * coefficients;
  if (count > 1) {
    Eigen::VectorXd w = Eigen::VectorXd::Constant(count, -1 / root);
    w[0] += 1;
    const Eigen::RowVectorXd along = 2 / w.squaredNorm() * w.transpose() * values;
    values -= w * along;
  }
  return values;
}

/// The same by two particles for each function but the constant one, as far on the one side of the fields' means as on
/// the other: 2 (count − 1) particles. Their third moments about the mean vanish, as those of what is symmetric do, and
/// a mirror image of the mass has a mirror image of them. Loads that are not linear in place feel these.
inline Eigen::MatrixXd at_particle_pairs(const Eigen::MatrixXd& coefficients, double mass) {
  const Eigen::Index pairs = coefficients.rows() - 1;
  const Eigen::MatrixXd away = std::sqrt(static_cast<double>(pairs) / mass) * coefficients.bottomRows(pairs);
  const Eigen::RowVectorXd mean = coefficients.row(0) / std::sqrt(mass);
  Eigen::MatrixXd values(2 * pairs, coefficients.cols());
  values << away.rowwise() + mean, (-away).rowwise() + mean;
  return values;
}

}  // namespace withy
