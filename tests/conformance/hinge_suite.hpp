/// \file
/// What any hinge must satisfy, built in or foreign. Call from a test with the hinge.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/hinge.hpp"

namespace withy::test {

/// Derivatives are checked by central differences with step 1e-5: of analytic functions of size one they leave 1e-10 of
/// truncation and 1e-11 of rounding.
constexpr double hinge_tolerance = 1e-9;

struct HingePoint {
  std::vector<double> x, u;
};

inline HingePoint random_hinge_point(const Hinge& hinge, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  HingePoint p{std::vector<double>(hinge.coordinates()), std::vector<double>(hinge.speeds())};
  for (double& x : p.x) x = number(random);
  for (double& u : p.u) u = number(random);
  hinge.normalize(p.x);
  return p;
}

inline HingeMotion motion_at(const Hinge& hinge, const HingePoint& p, double h) {
  std::vector<double> rate(hinge.coordinates());
  hinge.derivatives(p.x, p.u, rate);
  std::vector<double> x = p.x;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += h * rate[i];
  HingeMotion m;
  m.H.resize(6, static_cast<Eigen::Index>(hinge.speeds()));
  hinge.motion(x, p.u, m);
  return m;
}

/// V_FM = H ẋ is the rate of the pose: Ṙ = R ω̂, ṗ = R v; and `bias` that of H at constant rates. Pose and H are those
/// of the coordinates alone.
inline void expect_rates_are_derivatives(const Hinge& hinge) {
  std::mt19937 random(1);
  for (int k = 0; k < 20; ++k) {
    const HingePoint p = random_hinge_point(hinge, random);
    const Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(p.u.data(), static_cast<Eigen::Index>(p.u.size()));
    const double h = 1e-5;
    const HingeMotion m = motion_at(hinge, p, 0), ahead = motion_at(hinge, p, h), behind = motion_at(hinge, p, -h);
    const Vector6 V = m.H * u;
    const Matrix3 R_rate = (ahead.pose.R - behind.pose.R) / (2 * h);
    EXPECT_LT((R_rate - m.pose.R * skew<double>(Vector3(V.head<3>()))).cwiseAbs().maxCoeff(), hinge_tolerance);
    EXPECT_LT(((ahead.pose.p - behind.pose.p) / (2 * h) - m.pose.R * V.tail<3>()).norm(), hinge_tolerance);
    EXPECT_LT(((ahead.H * u - behind.H * u) / (2 * h) - m.bias).norm(), hinge_tolerance);
    EXPECT_LT((m.pose.R * m.pose.R.transpose() - Matrix3::Identity()).norm(), 1e-14);
    EXPECT_GT(m.pose.R.determinant(), 0) << "a reflection";
    EXPECT_EQ(m.H.cols(), static_cast<Eigen::Index>(p.u.size()));
    const HingeMotion still = motion_at(hinge, {p.x, std::vector<double>(p.u.size(), 0.0)}, 0);
    EXPECT_EQ(still.pose.R, m.pose.R) << "where it is does not depend on its rates";
    EXPECT_EQ(still.pose.p, m.pose.p);
    EXPECT_EQ(still.H, m.H);
    EXPECT_TRUE(still.bias.isZero(0));
  }
}

/// Derivatives of H and of the bias along each rate.
inline void expect_motion_derivatives(const Hinge& hinge) {
  std::mt19937 random(3);
  for (int k = 0; k < 5; ++k) {
    const HingePoint p = random_hinge_point(hinge, random);
    for (std::size_t along = 0; along < p.u.size(); ++along) {
      const double h = 1e-5;
      const auto displaced = [&](double distance) {
        std::vector<double> unit(p.u.size(), 0.0), direction(p.x.size());
        unit[along] = 1;
        hinge.derivatives(p.x, unit, direction);
        HingePoint at = p;
        for (std::size_t i = 0; i < at.x.size(); ++i) at.x[i] += distance * direction[i];
        return motion_at(hinge, at, 0);
      };
      const HingeMotion ahead = displaced(h), behind = displaced(-h);
      HingeMotion derivative;
      hinge.motion_derivative(p.x, p.u, along, derivative);
      EXPECT_LT(((ahead.H - behind.H) / (2 * h) - derivative.H).norm(), hinge_tolerance);
      EXPECT_LT(((ahead.bias - behind.bias) / (2 * h) - derivative.bias).norm(), hinge_tolerance);
      // What a hinge that does not override it gets.
      hinge.Hinge::motion_derivative(p.x, p.u, along, derivative);
      EXPECT_LT(((ahead.H - behind.H) / (2 * h) - derivative.H).norm(), hinge_tolerance);
    }
  }
}

/// The reference pose is the identity, and normalizing twice is normalizing once.
inline void expect_reference_and_normalization(const Hinge& hinge) {
  std::vector<double> x(hinge.coordinates(), 0.5);
  hinge.reference(x);
  std::vector<double> again = x;
  hinge.normalize(again);
  EXPECT_EQ(again, x);
  HingeMotion m;
  const std::vector<double> u(hinge.speeds(), 0.0);
  m.H.resize(6, static_cast<Eigen::Index>(u.size()));
  hinge.motion(x, u, m);
  EXPECT_EQ(m.pose.R, Matrix3::Identity());
  EXPECT_EQ(m.pose.p, Vector3::Zero());
}

/// A hinge that says it is a motion the sweeps inline moves exactly so.
inline void expect_kernel_is_the_motion(const Hinge& hinge) {
  const auto kernel = hinge.kernel();
  if (!kernel) return;
  std::mt19937 random(2);
  const HingePoint p = random_hinge_point(hinge, random);
  const HingeMotion m = motion_at(hinge, p, 0);
  Pose expected;
  using enum HingeKernel::Kind;
  switch (kernel->kind) {
    case weld:
      break;
    case revolute:
      expected.R = Eigen::AngleAxisd(p.x[0], kernel->axis).toRotationMatrix();
      break;
    case prismatic:
      expected.p = kernel->axis * p.x[0];
      break;
    case HingeKernel::Kind::free:
      expected.p = Vector3(p.x[4], p.x[5], p.x[6]);
      [[fallthrough]];
    case spherical:
      expected.R = rotation_from_quaternion(p.x[0], p.x[1], p.x[2], p.x[3]);
      break;
  }
  EXPECT_LT((m.pose.R - expected.R).norm() + (m.pose.p - expected.p).norm(), 1e-15);
}

inline void expect_hinge_conforms(const Hinge& hinge) {
  ASSERT_EQ(find_fault(hinge), "");
  expect_rates_are_derivatives(hinge);
  expect_motion_derivatives(hinge);
  expect_reference_and_normalization(hinge);
  expect_kernel_is_the_motion(hinge);
}

}  // namespace withy::test
