/// \file
/// Nonlinear least squares within bounds.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

namespace withy::campaign {

/// Residuals r(z) whose sum of squares is to be least.
struct LeastSquaresProblem {
  Eigen::VectorXd lower, upper;  ///< bounds of z; infinite where there are none
  Eigen::Index residuals = 0;    ///< their count, at least that of z
  /// Sets r; false where there are none at this z: a step to it is rejected.
  std::function<bool(const Eigen::VectorXd& z, Eigen::VectorXd& r)> evaluate;
  /// Sets dr/dz, one column a coordinate; false where it cannot be found: the search ends.
  std::function<bool(const Eigen::VectorXd& z, Eigen::MatrixXd& J)> derivatives;
  std::function<bool()> interrupted;
};

struct LeastSquaresResult {
  Eigen::VectorXd z;
  bool converged = false;  ///< not where points without residuals are in the way of steps that lessen the sum
  bool interrupted = false;
  std::string reason;  ///< why the search ended, a clause
};

/// The nearest minimum by the method of Levenberg and Marquardt (MINPACK's, in Eigen), z of order one: the first steps
/// are at most half a unit long. Bounds by a change of variables (James and Roos, 1975): a start at a bound begins a
/// thousandth inside.
/// \param start where `evaluate` has residuals
LeastSquaresResult least_squares(const LeastSquaresProblem& problem, const Eigen::VectorXd& start);

}  // namespace withy::campaign
