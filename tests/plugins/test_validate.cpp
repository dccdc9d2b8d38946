// What a body says is checked before anything is computed with it.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "withy/core/model/validate.hpp"

namespace {

using withy::ModalShape;
using withy::PointExpansion;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A point with every field filled with something unlike its neighbours.
PointExpansion point(Eigen::Index modes) {
  PointExpansion p = PointExpansion::rigid({1, 2, 3}, modes);
  for (Eigen::Index i = 0; i < modes; ++i) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      p.phi(c, i) = 0.1 * static_cast<double>(1 + i + c);
      p.psi(c, i) = 0.2 * static_cast<double>(1 + i - c);
      for (Eigen::Index j = 0; j < modes; ++j) {
        p.gamma[static_cast<std::size_t>(c)](i, j) = static_cast<double>(i + j - c);
        p.theta[static_cast<std::size_t>(c)](i, j) = static_cast<double>(i * j + c);
      }
    }
  }
  return p;
}

ModalShape good() {
  ModalShape s;
  s.mode_names = {"bending_y[1]", "bending_y[2]"};
  s.particles = {{1.5, point(2)}, {0.0, point(2)}};
  s.sections = {{withy::Vector3(0.1, 0, 0).asDiagonal(), point(2)}};
  s.stiffness = Eigen::Vector2d(10, 400).asDiagonal();
  s.damping = Eigen::Vector2d(0.1, 0).asDiagonal();
  s.length = 2;
  return s;
}

std::string fault_after(const std::function<void(ModalShape&)>& harm) {
  ModalShape s = good();
  harm(s);
  return find_fault(s);
}

TEST(Validate, finds_nothing_in_good_shapes_flexible_rigid_or_empty) {
  EXPECT_EQ(find_fault(good()), "");
  EXPECT_EQ(find_fault(ModalShape{}), "");
  ModalShape rigid;
  rigid.particles = {{1, PointExpansion::rigid({0, 0, 0}, 0)}};
  EXPECT_EQ(find_fault(rigid), "");
}

TEST(Validate, tolerates_the_rounding_of_a_quadrature_and_no_more) {
  // Sums of some hundred terms differ by their order of summation by about 1e-14 relative.
  EXPECT_EQ(fault_after([](ModalShape& s) { s.stiffness(0, 1) = 400 * 1e-13; }), "");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.stiffness(0, 1) = 400 * 1e-9; }),
            "the stiffness matrix is not symmetric");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping(1, 1) = -1e-13; }), "");
}

TEST(Validate, names_the_first_number_that_is_not_finite) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.stiffness(1, 0) = nan; }),
            "the stiffness matrix has nan in row 2, column 1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping(0, 1) = infinity; }),
            "the damping matrix has inf in row 1, column 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.length = nan; }), "its length is nan");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[1].mass = infinity; }), "particle 2: its mass is inf");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[1].at.X.z() = nan; }),
            "particle 2: X has nan in row 3, column 1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.phi(1, 1) = nan; }),
            "particle 1: Phi has nan in row 2, column 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].at.psi(2, 0) = -infinity; }),
            "section 1: Psi has -inf in row 3, column 1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.gamma[0](1, 1) = nan; }),
            "particle 1: Gamma_x has nan in row 2, column 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].at.theta[2](0, 0) = nan; }),
            "section 1: Theta_z has nan in row 1, column 1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].inertia(0, 0) = nan; }),
            "section 1: its inertia has nan in row 1, column 1");
}

TEST(Validate, names_sizes_that_do_not_agree_with_the_number_of_modes) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.mode_names.emplace_back("torsion[1]"); }),
            "the stiffness matrix is 2 by 2, not 3 by 3");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping.resize(0, 0); }), "the damping matrix is 0 by 0, not 2 by 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.phi = withy::Matrix3X::Zero(3, 1); }),
            "particle 1: Phi is 3 by 1, not 3 by 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.psi = {}; }), "particle 1: Psi is 3 by 0, not 3 by 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.gamma[1].resize(2, 1); }),
            "particle 1: Gamma_y is 2 by 1, not 2 by 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].at.theta[0].resize(0, 0); }),
            "section 1: Theta_x is 0 by 0, not 2 by 2");
  EXPECT_EQ(find_fault(point(2), 3), "Phi is 3 by 2, not 3 by 3");
}

TEST(Validate, names_what_should_be_symmetric_and_is_not) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping(0, 1) = 0.01; }), "the damping matrix is not symmetric");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.gamma[2](0, 1) += 0.5; }),
            "particle 1: Gamma_z is not symmetric");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.theta[1](1, 0) += 0.5; }),
            "particle 1: Theta_y is not symmetric");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].inertia(0, 2) = 0.05; }),
            "section 1: its inertia is not symmetric");
}

TEST(Validate, names_what_nature_does_not_allow) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].mass = -1; }), "particle 1: its mass is -1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.length = -2; }), "its length is -2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping(1, 1) = -0.5; }),
            "the damping matrix is not positive semidefinite");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].inertia(1, 1) = -0.25; }),
            "section 1: its inertia is not positive semidefinite");
}

TEST(Validate, names_modes_that_cannot_be_told_apart) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.mode_names[1] = s.mode_names[0]; }),
            "two modes are named 'bending_y[1]'");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.mode_names[0].clear(); }), "a mode has no name");
}

}  // namespace
