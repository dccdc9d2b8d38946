// The rotation that brings one direction to another, by which axes of other programs are met.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "withy/core/spatial/pose.hpp"

namespace withy::exchange {
namespace {

TEST(Rotation, BetweenTwoDirectionsIsTheLeastOneAndHasOneForOppositesToo) {
  const Vector3 a(0.3, -1.2, 2), n = a.unitOrthogonal();
  for (const double angle : {0.0, 1e-9, 0.7, 2.5, std::numbers::pi - 1e-3, std::numbers::pi - 1e-7, std::numbers::pi}) {
    const Vector3 b = 5 * (std::cos(angle) * a + std::sin(angle) * a.norm() * n);
    const Matrix3 R = rotation_between(a, b);
    EXPECT_LT((R * a.normalized() - b.normalized()).norm(), 1e-12) << angle;
    EXPECT_LT((R * R.transpose() - Matrix3::Identity()).norm(), 1e-14) << angle;
    EXPECT_NEAR(R.determinant(), 1, 1e-14) << angle;
    EXPECT_NEAR(Eigen::AngleAxisd(R).angle(), angle, 1e-4) << "the least angle";
  }
}

}  // namespace
}  // namespace withy::exchange
