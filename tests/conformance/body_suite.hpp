/// \file
/// What any body must satisfy, built in or foreign, and what any strain kinematics must.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/body.hpp"

namespace withy::test {

inline Eigen::VectorXd random_modes(Eigen::Index n, double size, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-size, size);
  return Eigen::VectorXd::NullaryExpr(n, [&] { return number(random); });
}

/// Partial velocities are the derivatives of positions and rotations, biases those of the partial velocities; central
/// differences of step 1e-5 leave 1e-9 of fields of size one.
inline void expect_kinematics_conforms(const PointKinematics& kinematics) {
  std::mt19937 random(3);
  const Eigen::Index n = kinematics.modes();
  const std::size_t points = kinematics.points();
  const auto at = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    std::vector<PointMotion> m(points);
    kinematics.evaluate({q.data(), static_cast<std::size_t>(n)}, {v.data(), static_cast<std::size_t>(n)}, m);
    return m;
  };
  for (int k = 0; k < 5; ++k) {
    const Eigen::VectorXd q = random_modes(n, 0.05, random), v = random_modes(n, 0.5, random);
    const double h = 1e-5;
    const auto now = at(q, v), ahead = at(q + h * v, v), behind = at(q - h * v, v);
    for (std::size_t i = 0; i < points; ++i) {
      const Vector3 velocity = now[i].P * v, spin = now[i].W * v;
      const double size = 1 + velocity.norm() + spin.squaredNorm();
      EXPECT_LT(((ahead[i].r - behind[i].r) / (2 * h) - velocity).norm(), 1e-8 * size);
      const Matrix3 R_rate = (ahead[i].R - behind[i].R) / (2 * h);
      EXPECT_LT((R_rate - skew<double>(spin) * now[i].R).norm(), 1e-8 * size);
      EXPECT_LT(((ahead[i].P - behind[i].P) * v / (2 * h) - now[i].r_bias).norm(), 1e-7 * size);
      EXPECT_LT(((ahead[i].W - behind[i].W) * v / (2 * h) - now[i].w_bias).norm(), 1e-7 * size);
    }
  }
}

/// Content is finite and consistent; the modal mass is positive definite, stiffness positive, damping not negative;
/// every body has a root; linear and quadratic kinematics of its mass are consistent with their derivatives.
inline void expect_body_conforms(const Body& body) {
  const ModalShape& shape = body.shape();
  EXPECT_EQ(find_fault(shape), "");
  ASSERT_TRUE(body.station(std::string("root")).has_value());
  EXPECT_FALSE(body.station(std::string("no such station")).has_value());
  EXPECT_FALSE(body.stations().empty());
  double mass = 0;
  const Eigen::Index n = shape.modes();
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n);
  std::vector<PointExpansion> points;
  for (const Particle& p : shape.particles) {
    mass += p.mass;
    G += p.mass * p.at.phi.transpose() * p.at.phi;
    points.push_back(p.at);
  }
  for (const Section& s : shape.sections) {
    G += s.at.psi.transpose() * s.inertia * s.at.psi;
    points.push_back(s.at);
  }
  EXPECT_GT(mass, 0);
  if (n == 0) return;
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(G).info(), Eigen::Success) << "the modal mass is not positive definite";
  const Eigen::VectorXd k = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(shape.stiffness).eigenvalues();
  EXPECT_GE(k.minCoeff(), -1e-9 * k.maxCoeff());
  const Eigen::VectorXd d = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(shape.damping).eigenvalues();
  EXPECT_GE(d.minCoeff(), -1e-9 * (1e-300 + d.cwiseAbs().maxCoeff()));
  for (const StrainOrder order : {StrainOrder::linear, StrainOrder::quadratic}) {
    expect_kinematics_conforms(PolynomialKinematics(points, order, n));
  }
}

}  // namespace withy::test
