/// \file
/// Loss of stability under weight against closed forms: det K = 0 of the exact tangent stiffness.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "column.hpp"

namespace withy::test {
namespace {

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

/// Euler's column: P L²/EI = π²/4. The mast weighs 1e-9 of its load. Clamped-free modes, which bear no moment's slope
/// at the tip, converge slowly; polynomials do not.
TEST(Buckling, a_column_falls_under_a_tip_load) {
  double before = 10;
  for (const int modes : {2, 4, 8}) {
    const double P = critical_load([&](double x) { return column(x, modes, 1e-9, 1); }, "quadratic", 2, 3);
    const double error = P / (std::numbers::pi * std::numbers::pi / 4) - 1;
    EXPECT_GT(error, 0) << "fewer modes are stiffer";
    EXPECT_LT(error, before / 4);
    before = error;
  }
  EXPECT_LT(before, 2e-4);
  const double P =
      critical_load([&](double x) { return column(x, 5, 1e-9, 1, "orthogonal-polynomials"); }, "quadratic", 2, 3);
  EXPECT_NEAR(P / (std::numbers::pi * std::numbers::pi / 4), 1, 1e-7);
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
  // Two modes: the dense equations of the energy's first order take long.
  EXPECT_EQ(critical_load([&](double x) { return lateral(x, 2); }, "symmetric-linear", 2, 6), 0);
  EXPECT_NEAR(critical_load([&](double x) { return lateral(x, 2); }, "symmetric", 2, 6), 4.0395, 0.5e-4)
      << "weight has a potential of second order";
}

/// Axial shortening alone buckles columns as the complete second order does, and nothing sideways.
TEST(Buckling, with_foreshortening_alone_columns_fall_and_cantilevers_do_not_tip_over) {
  for (const char* truncation : {"strict", "none"}) {
    const std::string choice =
        std::string("formulation: {kinematics: foreshortening, truncation: ") + truncation + "}\n";
    EXPECT_NEAR(critical_load([&](double x) { return column(x, 2, 1, 0) + choice; }, "", 5, 10), 7.8529, 0.5e-4);
    EXPECT_EQ(critical_load([&](double x) { return lateral(x, 4) + choice; }, "", 2, 6), 0) << truncation;
  }
}

}  // namespace
}  // namespace withy::test
