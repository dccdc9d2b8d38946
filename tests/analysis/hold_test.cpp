/// \file
/// Systems whose inputs are held from sample to sample, in units of any size.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "withy/core/analysis/linear_system.hpp"

namespace withy {
namespace {

/// A mass that a force moves, ẍ = f/m: x += T²/(2m) f, ẋ += T/m f.
TEST(HeldInputs, MoveAMassOfAnySize) {
  for (const double m : {1e12, 1.0, 1e-12, 1e-24}) {
    Eigen::Matrix2d A;
    A << 0, 1, 0, 0;
    const auto [Phi, Gamma] = hold(A, Eigen::Vector2d(0, 1 / m), 0.02);
    EXPECT_NEAR(Gamma(0, 0) * m, 0.02 * 0.02 / 2, 1e-18) << m;
    EXPECT_NEAR(Gamma(1, 0) * m, 0.02, 1e-16) << m;
    EXPECT_DOUBLE_EQ(Phi(0, 1), 0.02) << m;
  }
}

/// Two damped oscillators, coupled: the same in metres and newtons as where a length is 2⁻²⁰ m and a force 2⁻⁶⁰ N.
TEST(HeldInputs, AndStatesMayHaveAnyUnits) {
  Eigen::Matrix4d A;
  A << 0, 0, 1, 0, 0, 0, 0, 1, -4e4, 900, -3, 0.2, 700, -90, 0.1, -0.5;
  Eigen::Matrix<double, 4, 2> B;
  B << 0, 0, 0, 0, 2, 0.3, 0.1, 5;
  const auto [Phi, Gamma] = hold(A, B, 0.01);
  const Eigen::Vector4d units(1, std::exp2(-20.0), 1, std::exp2(-20.0));
  const Eigen::Vector2d inputs(std::exp2(-60.0), 1);
  const Eigen::Matrix4d A_small = units.cwiseInverse().asDiagonal() * A * units.asDiagonal();
  const Eigen::Matrix<double, 4, 2> B_small =
      units.cwiseInverse().asDiagonal() * B * inputs.cwiseInverse().asDiagonal();
  const auto [Phi_small, Gamma_small] = hold(A_small, B_small, 0.01);
  const Eigen::Matrix4d Phi_back = units.asDiagonal() * Phi_small * units.cwiseInverse().asDiagonal();
  const Eigen::Matrix<double, 4, 2> Gamma_back = units.asDiagonal() * Gamma_small * inputs.asDiagonal();
  EXPECT_LT(((Phi_back - Phi).array() / Phi.array()).abs().maxCoeff(), 1e-12);
  EXPECT_LT(((Gamma_back - Gamma).array() / Gamma.array()).abs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace withy
