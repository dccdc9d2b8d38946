/// \file
/// Eigenvalues that are many powers of ten apart, each with the digits it has.
#pragma once

#include <Eigen/Core>

namespace withy {

struct Eigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  ///< a column for each
};

/// Of a regular matrix. The QR algorithm finds eigenvalues to rounding of the greatest, beside which the smallest may
/// be lost. Where they are far apart those in the lower half, on a logarithmic scale, are the greatest of the inverse:
/// what one algorithm finds least well is at the middle, and rounding there √(greatest/smallest) of the value.
/// \throws std::domain_error where A is not finite, or none are found
Eigenpairs eigenpairs(const Eigen::MatrixXd& A);

}  // namespace withy
