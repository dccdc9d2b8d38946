/// \file
/// Loss of stability under weight against closed forms: det K = 0 of the exact tangent stiffness.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "blade.hpp"

namespace withy::test {
namespace {

/// The lowest load in [low, high] at which the tangent stiffness of the straight beam is singular; 0: none.
template <class TextOfLoad>
double critical_load(TextOfLoad&& text, const std::string& formulation, double low, double high) {
  const auto determinant = [&](double load) {
    AnalysedScene c(text(load), formulation);
    const Held held(c.layout().speeds, false);
    const Tangents t = c.dynamics->tangents(0, c.state.y, Eigen::VectorXd::Zero(c.speeds()));
    return t.by_position.determinant();
  };
  const double start = determinant(low);
  if (determinant(high) * start > 0) return 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (determinant(middle) * start > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Along −x on a beam that stands along x.
std::string column(double g, int modes, double mass_per_length, double tip) {
  std::ostringstream s;
  s.precision(17);
  s << "format: withy/1\ntime: {end: 1}\ngravity: [" << -g << ", 0, 0]\nbodies:\n  mast: {type: beam, length: 1, "
    << "mass_per_length: " << mass_per_length << ", bending_y: {stiffness: 1, modes: " << modes << "}}\n";
  if (tip > 0) s << "  top: {type: rigid, mass: " << tip << "}\n";
  s << "hinges:\n  foot: {type: weld, parent: world, child: mast}\n";
  if (tip > 0) s << "  end: {type: weld, parent: mast.tip, child: top}\n";
  return s.str();
}

/// ρ g L³/EI = 7.837347 (Greenhill 1881); with the clamped-free modes of the beam: 7.8697, 7.8529, 7.83738.
TEST(Buckling, a_column_falls_under_its_own_weight) {
  const std::vector<std::pair<int, double>> by_modes = {{1, 7.8697}, {2, 7.8529}, {8, 7.83738}};
  for (const std::string formulation : {"consistent", "quadratic", "exact"}) {
    for (const auto& [modes, expected] : by_modes) {
      const double g = critical_load([&](double x) { return column(x, modes, 1, 0); }, formulation, 5, 10);
      EXPECT_NEAR(g, expected, 0.5e-4 * (modes < 8 ? 1 : 0.2)) << formulation << " " << modes;
    }
  }
  EXPECT_NEAR(critical_load([&](double x) { return column(x, 8, 1, 0); }, "exact", 5, 10) / 7.837347, 1, 1e-5);
}

/// Euler's column: P L²/EI = π²/4. The mast weighs 1e-9 of its load. Each of n modes leaves about 1/n³ of the error.
TEST(Buckling, a_column_falls_under_a_tip_load) {
  double before = 10;
  for (const int modes : {2, 4, 8}) {
    const double P = critical_load([&](double x) { return column(x, modes, 1e-9, 1); }, "quadratic", 2, 3);
    const double error = P / (std::numbers::pi * std::numbers::pi / 4) - 1;
    EXPECT_GT(error, 0) << "fewer modes are stiffer";
    EXPECT_LT(error, before / 4);
    before = error;
  }
  EXPECT_LT(before, 1e-4);
}

/// Lateral buckling of a cantilever by a dead load at its tip, stiff in the load's plane: P L²/√(EI GJ) = 4.0126
/// (Timoshenko & Gere, section 6.3); with n bending and n twist modes 4.0395, 4.0154, 4.0135 for n = 2, 4, 6.
std::string lateral(double load, int modes) {
  std::ostringstream s;
  s.precision(17);
  s << "format: withy/1\ntime: {end: 1}\ngravity: [0, 0, " << -load << "]\nbodies:\n  arm: {type: beam, length: 1, "
    << "mass_per_length: 1e-9, bending_y: {stiffness: 1, modes: " << modes << "}, torsion: {stiffness: 1, "
    << "inertia: 1e-9, modes: " << modes << "}}\n  weight: {type: rigid, mass: 1}\n"
    << "hinges:\n  wall: {type: weld, parent: world, child: arm}\n  end: {type: weld, parent: arm.tip, child: "
       "weight}\n";
  return s.str();
}

TEST(Buckling, a_cantilever_tips_over_sideways) {
  for (const std::string formulation : {"consistent", "quadratic", "exact"}) {
    for (const auto& [modes, expected] : std::vector<std::pair<int, double>>{{2, 4.0395}, {4, 4.0154}, {6, 4.0135}}) {
      const double P = critical_load([&](double x) { return lateral(x, modes); }, formulation, 2, 6);
      EXPECT_NEAR(P, expected, 0.5e-4) << formulation << " " << modes;
    }
  }
  for (const std::string formulation : {"ruthless", "inconsistent", "linear"})
    EXPECT_EQ(critical_load([&](double x) { return lateral(x, 4); }, formulation, 2, 6), 0) << formulation;
}

}  // namespace
}  // namespace withy::test
