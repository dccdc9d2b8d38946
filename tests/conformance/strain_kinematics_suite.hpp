/// \file
/// What any strain kinematics must satisfy, built in or foreign.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "withy/core/plugin/body.hpp"

namespace withy::test {

/// Some fields of coordinates of a slender body, different for each `k`.
inline SectionField field(int k) {
  const auto number = [k](int i) { return std::sin(1.0 + 2.3 * i + 5.1 * k); };
  return {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}, {number(6), number(7), number(8)}};
}

/// Slopes are symmetric in their two coordinates, bilinear, finite, the same each time they are asked for, and turn
/// with the body about its own axis. A kinematics without second order is not asked.
inline void expect_strain_kinematics_conforms(const StrainKinematics& kinematics) {
  EXPECT_EQ(find_fault(kinematics), "");
  EXPECT_FALSE(kinematics.name().empty());
  if (kinematics.order() == StrainOrder::linear) {
    EXPECT_FALSE(kinematics.complete());
    return;
  }
  const SectionField a = field(1), b = field(2), c = field(3);
  const Vector3 theta(0.3, -0.2, 0.5);
  const auto rotation = [&](const SectionField& i, const SectionField& j) { return kinematics.rotation_slope(i, j); };
  const auto displacement = [&](const SectionField& i, const SectionField& j, const Vector3& t) {
    return kinematics.displacement_slope(i, j, t);
  };
  EXPECT_TRUE(rotation(a, b).allFinite() && displacement(a, b, theta).allFinite());
  EXPECT_EQ(rotation(a, b), rotation(a, b));
  EXPECT_LT((rotation(a, b) - rotation(b, a)).norm(), 1e-15);
  EXPECT_LT((displacement(a, b, theta) - displacement(b, a, theta)).norm(), 1e-15);

  const SectionField sum = {2.0 * a.rotation + c.rotation, 2.0 * a.curvature + c.curvature,
                            2.0 * a.elongation + c.elongation};
  const Vector3 other(-0.1, 0.4, 0.2);
  EXPECT_LT((rotation(sum, b) - 2.0 * rotation(a, b) - rotation(c, b)).norm(), 1e-14);
  EXPECT_LT(
      (displacement(sum, b, 2.0 * theta + other) - 2.0 * displacement(a, b, theta) - displacement(c, b, other)).norm(),
      1e-14);

  const Matrix3 R = Eigen::AngleAxisd(0.7, Vector3::UnitX()).toRotationMatrix();
  const auto turned = [&](const SectionField& f) {
    return SectionField{R * f.rotation, R * f.curvature, R * f.elongation};
  };
  EXPECT_LT((rotation(turned(a), turned(b)) - R * rotation(a, b)).norm(), 1e-14);
  EXPECT_LT((displacement(turned(a), turned(b), R * theta) - R * displacement(a, b, theta)).norm(), 1e-14);
}

/// A body expanded by it keeps everything but Γ and Θ, and has a station wherever it had one along x.
inline void expect_expands(const StrainKinematics& kinematics, const Body& body, double length) {
  const auto expanded = body.expanded(kinematics);
  ASSERT_NE(expanded, nullptr);
  EXPECT_EQ(expanded->shape().mode_names, body.shape().mode_names);
  EXPECT_EQ(expanded->shape().stiffness, body.shape().stiffness);
  EXPECT_EQ(expanded->shape().damping, body.shape().damping);
  ASSERT_EQ(expanded->shape().particles.size(), body.shape().particles.size());
  for (const double x : {0.0, 0.37 * length, length}) {
    const auto own = body.station(x), anew = expanded->station(x);
    ASSERT_TRUE(own && anew) << x;
    EXPECT_EQ(own->X, anew->X);
    EXPECT_EQ(own->phi, anew->phi);
    EXPECT_EQ(own->psi, anew->psi);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(anew->gamma[c], anew->gamma[c].transpose());
      EXPECT_EQ(anew->theta[c], anew->theta[c].transpose());
    }
  }
}

}  // namespace withy::test
