/// \file
/// Particles of equal mass in the place of a distribution of mass.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace withy {

/// Values of fields at particles of equal mass, from the coefficients of the fields (a column each) in orthonormal
/// functions over the mass [kg], the first of which is constant: two particles for each function but that one, as far
/// on the one side of the fields' means as on the other, 2 (count − 1) rows. Integrals over the mass of products of two
/// fields are sums over the particles, to rounding. Third moments about the mean vanish, as those of what is symmetric
/// do, and a mirror image of the mass has a mirror image of the particles: loads that are not linear in place feel it.
inline Eigen::MatrixXd at_particle_pairs(const Eigen::MatrixXd& coefficients, double mass) {
  const Eigen::Index pairs = coefficients.rows() - 1;
  const Eigen::MatrixXd away = std::sqrt(static_cast<double>(pairs) / mass) * coefficients.bottomRows(pairs);
  const Eigen::RowVectorXd mean = coefficients.row(0) / std::sqrt(mass);
  Eigen::MatrixXd values(2 * pairs, coefficients.cols());
  values << away.rowwise() + mean, (-away).rowwise() + mean;
  return values;
}

}  // namespace withy
