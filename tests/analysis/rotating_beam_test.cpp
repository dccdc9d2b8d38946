/// \file
/// Modes of the rotating cantilever against published figures and section 4.1 of Padilla & von Flotow (1989).
#include <gtest/gtest.h>

#include <cmath>

#include "blade.hpp"

namespace withy::test {
namespace {

/// One formulation at one rate.
std::vector<Mode> spun(const std::string& text, const std::string& formulation, double rate, const std::string& group) {
  AnalysedScene c(text, formulation);
  c.spin("axle", rate);
  const std::vector<Mode> modes = steady_modes(c, {"axle"});
  return of_group(c, modes, group);
}

constexpr double omega_1 = 3.5160152685;  // of the beam at rest

/// Frequencies √(ρA L⁴/EI) ω at rates √(ρA L⁴/EI) Ω: the table of Wright, Smith, Thresher & Wang (J. Appl. Mech. 49,
/// 1982) and Hodges & Rutkowski (AIAA J. 19, 1981), hub radius 0. In the plane ω² is less by Ω².
struct Row {
  double eta, flap_1, flap_2;
};
const std::vector<Row> table = {{0, 3.51602, 22.03449},  {1, 3.68165, 22.18101}, {2, 4.13732, 22.61492},
                                {4, 5.58500, 24.27335},  {6, 7.36037, 26.80908}, {10, 11.20233, 33.64037},
                                {12, 13.17015, 37.60311}};

class RotatingBeam : public testing::TestWithParam<std::string> {};

TEST_P(RotatingBeam, has_the_published_frequencies) {
  // Polynomials converge fast; six clamped-free modes are 1e-3 off at the highest rate.
  const std::string text = blade(8, 8, "", "", "[0, 0, 0]", "orthogonal-polynomials");
  for (const Row& row : table) {
    AnalysedScene c(text, GetParam());
    c.spin("axle", row.eta);
    const std::vector<Mode> modes = steady_modes(c, {"axle"});
    const std::vector<Mode> flap = of_group(c, modes, "bending_z"), lag = of_group(c, modes, "bending_y");
    ASSERT_EQ(flap.size(), 8U);
    EXPECT_NEAR(flap[0].frequency() / row.flap_1, 1, 1e-4) << row.eta;
    EXPECT_NEAR(flap[1].frequency() / row.flap_2, 1, 1e-4) << row.eta;
    EXPECT_NEAR(lag[0].frequency() / std::sqrt(row.flap_1 * row.flap_1 - row.eta * row.eta), 1, 1e-4) << row.eta;
    EXPECT_NEAR(lag[1].frequency() / std::sqrt(row.flap_2 * row.flap_2 - row.eta * row.eta), 1, 1e-4) << row.eta;
    EXPECT_LT(std::abs(flap[0].growth()), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(FirstOrderSeesStiffening, RotatingBeam, testing::Values("consistent", "quadratic", "exact"));

/// Axial shortening is all that a spinning beam needs.
TEST(RotatingBeamForeshortened, has_the_frequencies_of_the_complete_second_order) {
  const std::string text = blade(6, 6);
  for (const char* truncation : {"strict", "none"}) {
    const std::string choice =
        std::string("formulation: {kinematics: foreshortening, truncation: ") + truncation + "}\n";
    for (const char* group : {"bending_y", "bending_z"}) {
      const std::vector<Mode> complete = spun(text, "quadratic", 6, group), own = spun(text + choice, "", 6, group);
      ASSERT_EQ(complete.size(), own.size());
      for (std::size_t i = 0; i < own.size(); ++i)
        EXPECT_NEAR(own[i].frequency() / complete[i].frequency(), 1, 1e-10) << truncation << ' ' << group;
    }
  }
}

/// Timoshenko's beam, kGA L²/EI = 10, spun at Ω = √10 √(EI/μ)/L²: the tension T = ½ μ Ω² (L² − x²) works on
/// −½ ψ² − ψ γ, ψ the rotation of the section and γ the shear. Ritz' method with powers of x, ψ = Σ (k+2) x^(k+1) a_k
/// and γ = Σ (k+1) x^k b_k, gives 12.92422, 38.1924 in flap; without ψ γ it would be 11.1367, 36.2209.
TEST(RotatingBeamForeshortened, stiffens_a_beam_with_shear) {
  const std::string family = "modes: 6, family: orthogonal-polynomials}";
  const std::string timoshenko =
      "format: withy/1\ntime: {end: 1}\nbodies:\n  blade: {type: beam, length: 1, mass_per_length: 1, "
      "bending_z: {stiffness: 10, rotary_inertia: 0.002, " +
      family + ", shear_z: {stiffness: 100, " + family +
      "}\nhinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: blade}\n";
  for (const char* truncation : {"strict", "none"}) {
    const std::string choice =
        std::string("formulation: {kinematics: foreshortening, truncation: ") + truncation + "}\n";
    AnalysedScene c(timoshenko + choice, "");
    c.spin("axle", 10);
    const std::vector<Mode> modes = steady_modes(c, {"axle"});
    EXPECT_NEAR(modes[0].frequency() / 12.92422, 1, 1e-5) << truncation;
    EXPECT_NEAR(modes[1].frequency() / 38.1924, 1, 1e-5) << truncation;
  }
}

/// Kinetic energy of first order has nothing of what rotation does to stiffness: frequencies are those at rest.
TEST(RotatingBeamInFirstOrderOfEnergy, does_not_stiffen) {
  const std::vector<Mode> spinning = spun(blade(3, 3), "symmetric", 4, "bending_z"),
                          resting = spun(blade(3, 3), "ruthless", 0, "bending_z");
  ASSERT_EQ(spinning.size(), resting.size());
  for (std::size_t i = 0; i < resting.size(); ++i)
    EXPECT_NEAR(spinning[i].frequency() / resting[i].frequency(), 1, 1e-9);
}

/// Rayleigh's quotient with the mode at rest: ω² = ω₁² + (∫ ½(1−x²) φ′² dx − 1) Ω² in the plane, hub radius 0,
/// ∫φ² = 1. The integral by Simpson's rule on the closed form of φ.
double rayleigh_coefficient() {
  const double b = 1.8751040687119611, s = (std::sinh(b) - std::sin(b)) / (std::cosh(b) + std::cos(b));
  const auto slope = [&](double x) {
    return b * (std::sinh(b * x) + std::sin(b * x) - s * (std::cosh(b * x) - std::cos(b * x)));
  };
  const int n = 2000;
  double sum = 0;
  for (int i = 0; i <= n; ++i) {
    const double x = static_cast<double>(i) / n;
    sum += (i == 0 || i == n ? 1 : (i % 2 == 1 ? 4 : 2)) * 0.5 * (1 - x * x) * slope(x) * slope(x);
  }
  return sum / (3 * n) - 1;
}

/// [PvF 4.1] gives 0.193.
TEST(PadillaVonFlotow, consistent_lag_stiffens_at_low_rates) {
  const double coefficient = rayleigh_coefficient();
  EXPECT_NEAR(coefficient, 0.193, 5e-4);
  // One mode: exactly Rayleigh's quotient, at any rate.
  for (const double rate : {0.1, 1.0, 5.0}) {
    const Mode lag = spun(blade(1, 0), "consistent", rate, "bending_y")[0];
    EXPECT_NEAR(lag.squared_frequency(), omega_1 * omega_1 + coefficient * rate * rate, 1e-7 * (1 + rate * rate));
  }
  // Many: its tangent at rate zero; the second order of perturbation is below 1e-4 at Ω = ω₁/10.
  const double rate = 0.1 * omega_1;
  const Mode lag = spun(blade(6, 0), "consistent", rate, "bending_y")[0];
  EXPECT_NEAR((lag.squared_frequency() - omega_1 * omega_1) / (rate * rate), coefficient, 1e-4 * 10);
}

TEST(PadillaVonFlotow, inconsistent_lag_softens_and_diverges_past_its_frequency) {
  for (const double ratio : {0.2, 0.5, 0.9}) {
    const double rate = ratio * omega_1;
    const Mode lag = spun(blade(3, 0), "inconsistent", rate, "bending_y")[0];
    EXPECT_NEAR(lag.squared_frequency(), omega_1 * omega_1 - rate * rate, 1e-8);
    EXPECT_EQ(lag.growth(), 0.0);
  }
  for (const double ratio : {1.1, 1.5, 3.0}) {
    const double rate = ratio * omega_1;
    const Mode lag = spun(blade(3, 0), "inconsistent", rate, "bending_y")[0];
    EXPECT_NEAR(lag.growth() / std::sqrt(rate * rate - omega_1 * omega_1), 1, 1e-3);
    EXPECT_NEAR(lag.growth(), std::sqrt(rate * rate - omega_1 * omega_1), 1e-8);
  }
}

/// Out of the plane no inertial softening acts, and nothing stiffens without second-order kinematics.
TEST(PadillaVonFlotow, ruthless_and_inconsistent_flap_do_not_feel_the_rate) {
  for (const double rate : {1.0, 10.0}) {
    EXPECT_NEAR(spun(blade(2, 2), "ruthless", rate, "bending_y")[0].frequency(), omega_1, 1e-7);
    EXPECT_NEAR(spun(blade(2, 2), "ruthless", rate, "bending_z")[0].frequency(), omega_1, 1e-7);
    EXPECT_NEAR(spun(blade(2, 2), "inconsistent", rate, "bending_z")[0].frequency(), omega_1, 1e-7);
  }
}

/// Hub radius a: ω² = ω₁² + (K₀ + K₁ a) Ω² at low rates (Southwell), K₀ + K₁ a = ∫ (½(1−x²) + a(1−x)) φ′² dx with the
/// mode at rest, K₀ = 1.193, K₁ = 1.571.
TEST(RotatingBeamOnHub, a_hub_stiffens_more) {
  const std::string bodies =
      "  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {rim: {position: [1, 0, 0]}}}\n";
  const std::string hinges =
      "  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n"
      "  root: {type: weld, parent: hub.rim, child: blade}\n";
  const double rate = 0.2;
  const Mode flap = spun(blade(6, 6, bodies, hinges), "consistent", rate, "bending_z")[0];
  EXPECT_NEAR((flap.squared_frequency() - omega_1 * omega_1) / (rate * rate), 1.193 + 1.571, 2e-2);
}

/// A tip mass m against the closed form of the beam at rest: 1 + cos β cosh β = m β (sin β cosh β − cos β sinh β).
TEST(RotatingBeamWithTipMass, has_the_closed_form_frequency_at_rest) {
  const double m = 0.7;
  double low = 0.5, high = 1.9;
  for (int i = 0; i < 100; ++i) {
    const double b = 0.5 * (low + high);
    const double f = 1 + std::cos(b) * std::cosh(b) - m * b * (std::sin(b) * std::cosh(b) - std::cos(b) * std::sinh(b));
    (f > 0 ? low : high) = b;
  }
  const std::string hinges =
      "  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: blade}\n"
      "  end: {type: weld, parent: blade.tip, child: tip}\n";
  const std::string text = blade(8, 0, "  tip: {type: rigid, mass: 0.7}\n", hinges);
  // Clamped-free modes converge slowly with a tip mass: the shear at the end is none of theirs.
  EXPECT_NEAR(spun(text, "quadratic", 0, "bending_y")[0].frequency() / (low * low), 1, 1e-4);
}

}  // namespace
}  // namespace withy::test
