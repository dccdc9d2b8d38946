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

/// Every place that a body speaks of is one.
inline void expect_stations_conform(const Body& body) {
  const Eigen::Index n = body.shape().modes();
  EXPECT_FALSE(body.stations().empty());
  EXPECT_FALSE(body.station(std::string("no such station")).has_value());
  std::vector<std::string> named = body.measured_beside();
  if (const std::string measured = body.measured_station(); !measured.empty()) named.push_back(measured);
  for (const std::string& name : named) EXPECT_TRUE(body.station(name).has_value()) << name;
  named.insert(named.end(), {"root", "tip"});
  for (const std::string& name : named)
    if (const auto at = body.station(name); at.has_value()) {
      EXPECT_EQ(find_fault(*at, n), "") << name;
    }
}

/// A rod is the body: its mass, its particles' fields, and strains that these are the integrals of.
inline void expect_rod_conforms(const Body& body) {
  const Rod* const rod = body.rod();
  if (rod == nullptr) return;
  EXPECT_EQ(find_fault(*rod, body.shape()), "");
  for (const double part : {0.0, 0.37, 1.0}) {
    const auto at = body.station(part * rod->length());
    ASSERT_TRUE(at.has_value()) << "a rod has a station wherever it is";
    const RodSection section = rod->section(part * rod->length());
    const double size = 1e-9 + at->phi.norm() + at->psi.norm();
    EXPECT_LT((section.deflection - at->phi).norm(), 1e-9 * size);
    EXPECT_LT((section.rotation - at->psi).norm(), 1e-9 * size);
  }
}

/// A cut has the section where the station is, and the mass beyond it falls from all of it to none.
inline void expect_cuts_conform(const Body& body) {
  const double length = body.shape().length;
  double before = 0;
  for (const Particle& p : body.shape().particles) before += p.mass;
  const double all = before;
  for (const double part : {0.0, 0.31, 0.64, 1.0}) {
    const auto cut = body.cut(part * length);
    const auto at = body.station(part * length);
    if (!cut) continue;
    ASSERT_TRUE(at.has_value()) << "what can be cut there has a station there";
    EXPECT_EQ(find_fault(*cut, body.shape().modes()), "");
    EXPECT_EQ(cut->at.X, at->X);
    EXPECT_EQ(cut->at.phi, at->phi);
    EXPECT_EQ(cut->at.psi, at->psi);
    double beyond = 0;
    for (const Particle& p : cut->particles) beyond += p.mass;
    EXPECT_LE(beyond, before * (1 + 1e-9));
    EXPECT_GE(beyond, part == 0 ? all * (1 - 1e-9) : 0);
    EXPECT_LE(beyond, part == 1 ? 1e-9 * all : all * (1 + 1e-9));
    before = beyond;
  }
}

/// Segments are bodies with both ends, and together have the mass of the whole.
inline void expect_segments_conform(const Body& body) {
  double whole = 0, together = 0;
  for (const Particle& p : body.shape().particles) whole += p.mass;
  for (const std::shared_ptr<const Body>& segment : body.segments()) {
    ASSERT_NE(segment, nullptr);
    EXPECT_EQ(find_fault(segment->shape()), "");
    for (const char* end : {"root", "tip"}) EXPECT_TRUE(segment->station(std::string(end)).has_value()) << end;
    for (const Particle& p : segment->shape().particles) together += p.mass;
  }
  if (!body.segments().empty()) {
    EXPECT_NEAR(together, whole, 1e-9 * whole);
  }
}

/// Content is finite and consistent; the modal mass is positive definite, stiffness positive, damping not negative;
/// every body has a root, and what it says of rods, cuts and segments agrees with that; linear and quadratic kinematics
/// of its mass are consistent with their derivatives.
inline void expect_body_conforms(const Body& body) {
  const ModalShape& shape = body.shape();
  EXPECT_EQ(find_fault(shape), "");
  ASSERT_TRUE(body.station(std::string("root")).has_value());
  expect_stations_conform(body);
  expect_rod_conforms(body);
  expect_cuts_conform(body);
  expect_segments_conform(body);
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
