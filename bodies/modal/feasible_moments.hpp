/// \file
/// Moments of fields that some mass has.
#pragma once

#include "mass_integrals.hpp"

namespace withy {

/// Orthonormal functions over the mass that span 1 and X, and what of other fields lies in that span.
class RigidBasis {
 public:
  /// \throws std::domain_error where no mass has these ∫1, ∫X, ∫XXᵀ.
  explicit RigidBasis(const MassIntegrals& m);

  /// Coefficients of a vector field f (columns: its components) from ∫ f and ∫ X fᵀ. Directions in which the body has
  /// no extent have none; what the integrals ask for there is `left`, in the unit of ∫ X f.
  [[nodiscard]] Eigen::Matrix<double, 4, 3> coefficients(const Vector3& f, const Matrix3& x_f, double& left) const;
  /// The same for X.
  [[nodiscard]] Eigen::Matrix<double, 4, 3> position() const;
  /// Of all Φ_k side by side, 4 by 3n.
  [[nodiscard]] Eigen::MatrixXd modes(const MassIntegrals& m, double& left) const;

 private:
  double root_mass_;
  Vector3 center_, roots_;  ///< ∫X / mass; √ of the principal central second moments, 0: no extent
  Matrix3 axes_;
};

/// The matrix of all ∫ Φ_ka Φ_lb, 3n by 3n.
Eigen::MatrixXd mode_moments(const MassIntegrals& m);

/// Makes ∫ Φ_k Φ_lᵀ such that some mass has them: keeps traces (the modal mass) and skew parts (gyroscopic coupling)
/// and changes the rest where it must. \returns the largest error left in what it keeps, relative to the modal masses.
/// \throws std::domain_error where no mass has these integrals, or the error exceeds 1e-6.
double make_feasible(MassIntegrals& m);

}  // namespace withy
