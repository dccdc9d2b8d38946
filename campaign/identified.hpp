/// \file
/// What residuals say of the coordinates that they depend on: which of them they determine, and how well.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace withy::campaign {

/// Derivatives of residuals with what is known of their error.
struct Sensitivity {
  Eigen::MatrixXd J;      ///< one column a coordinate
  Eigen::VectorXd error;  ///< of each column's norm
};

/// A coordinate that the residuals do not determine beside those before it.
struct Undetermined {
  std::size_t coordinate = 0;
  /// Coordinates whose change by the factor has the effect of its change by 1, within the error of the derivatives;
  /// none: it has no effect at all.
  std::vector<std::pair<std::size_t, double>> same_as;
};

/// Goes through the coordinates in their order: one is not determined where its column is a combination of those of
/// the determined ones before it, up to a few times the error of these derivatives.
std::vector<Undetermined> undetermined(const Sensitivity& sensitivity);

/// Singular values of J, decreasing.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& J);

/// Covariance of the z of least squares, (JᵀJ)⁻¹ Jᵀ Σ J (JᵀJ)⁻¹, for residuals that are independent of one another.
/// \param variances of the residuals, the diagonal of Σ. J has full rank.
Eigen::MatrixXd covariance(const Eigen::MatrixXd& J, const Eigen::VectorXd& variances);

}  // namespace withy::campaign
