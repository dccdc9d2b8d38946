// Least squares within bounds, and the covariance of what they find.
#include "withy/campaign/least_squares.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "withy/campaign/identified.hpp"

namespace withy::campaign {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

/// Of (z − target)² from 0 on.
LeastSquaresResult nearest(double target, double lower, double upper) {
  LeastSquaresProblem problem;
  problem.lower = Eigen::VectorXd::Constant(1, lower);
  problem.upper = Eigen::VectorXd::Constant(1, upper);
  problem.residuals = 1;
  problem.evaluate = [&](const Eigen::VectorXd& z, Eigen::VectorXd& r) {
    EXPECT_TRUE(lower <= z[0] && z[0] <= upper) << z[0];
    r = Eigen::VectorXd::Constant(1, z[0] - target);
    return true;
  };
  problem.derivatives = [](const Eigen::VectorXd& /*z*/, Eigen::MatrixXd& J) {
    J = Eigen::MatrixXd::Ones(1, 1);
    return true;
  };
  return least_squares(problem, Eigen::VectorXd::Zero(1));
}

TEST(LeastSquares, AreFoundBetweenBoundsOnEitherSideAndAtThem) {
  for (const auto& [lower, upper] : {std::pair(-none, none), {-1.0, none}, {-none, 1.0}, {-1.0, 1.0}})
    for (const double target : {-3.0, -0.4, 0.7, 3.0}) {
      const LeastSquaresResult found = nearest(target, lower, upper);
      EXPECT_TRUE(found.converged) << found.reason;
      EXPECT_NEAR(found.z[0], std::min(std::max(target, lower), upper), 1e-3) << lower << " to " << upper;
    }
}

/// Of z − target from 0 on, where points beyond `last` have no residuals.
LeastSquaresResult nearest_before(double target, double last) {
  LeastSquaresProblem problem;
  problem.lower = Eigen::VectorXd::Constant(1, -none);
  problem.upper = Eigen::VectorXd::Constant(1, none);
  problem.residuals = 2;
  problem.evaluate = [&](const Eigen::VectorXd& z, Eigen::VectorXd& r) {
    r = Eigen::Vector2d(z[0] - target, 0.1);
    return z[0] <= last;
  };
  problem.derivatives = [](const Eigen::VectorXd& /*z*/, Eigen::MatrixXd& J) {
    J = Eigen::Vector2d(1, 0);
    return true;
  };
  return least_squares(problem, Eigen::VectorXd::Zero(1));
}

TEST(LeastSquares, HaveNotConvergedWherePointsWithoutResidualsHoldThemUp) {
  for (const double target : {0.3, 0.7, 1.9})
    for (const double last : {0.001, 0.1, 0.2999, 0.31, 0.5, 0.6999, 0.8, 1.5, 2.0}) {
      const LeastSquaresResult found = nearest_before(target, last);
      EXPECT_EQ(found.converged, target <= last) << target << " before " << last << ": " << found.reason;
      EXPECT_NEAR(found.z[0], std::min(target, last), 1e-3) << target << " before " << last;
    }
}

TEST(Covariance, WeighsEachResidualWithItsOwnVariance) {
  const Eigen::MatrixXd J = Eigen::Vector2d(1, 2);
  EXPECT_NEAR(covariance(J, Eigen::Vector2d(1, 4))(0, 0), (1.0 + 4 * 4) / (5 * 5), 1e-15);
}

}  // namespace
}  // namespace withy::campaign
