/// \file
/// Beams whose section varies along them, and rotary inertia of the sections.
#include <cmath>
#include <numbers>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/tests/bodies/beam_fixture.hpp"
#include "withy/tests/conformance/body_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

constexpr double length = 1.6;

/// A property that is linear between these values at equal distances.
Value table(const std::vector<double>& values) {
  std::vector<Value> rows;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = length * static_cast<double>(i) / static_cast<double>(values.size() - 1);
    rows.push_back(Value::list({Value(x), Value(values[i])}));
  }
  return Value::list(std::move(rows));
}

struct Section {
  Value mass = Value(1.0), stiffness = Value(1.0);
  const char* family = "clamped-free";
  double modes = 3;
  Value inertia{};
  const char* strain = "bending_y";
};

std::unique_ptr<Body> beam(const Section& s) {
  Registry registry;
  enroll_static_plugins(registry);
  Value strain =
      Value::map({{"stiffness", s.stiffness}, {"modes", Value(s.modes)}, {"family", Value(std::string(s.family))}});
  if (s.inertia.kind() != Value::Kind::null) {
    strain.set(std::string(s.strain) == "torsion" ? "inertia" : "rotary_inertia", s.inertia);
  }
  return make_plugin<Body>(registry, "beam",
                           {{"length", Value(length)}, {"mass_per_length", s.mass}, {s.strain, strain}});
}

/// ω² over EI₀/(m₀ L⁴), rising.
Eigen::VectorXd squared_frequencies(const Body& body) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(modal_mass(body), body.shape().stiffness);
  return eigen.eigenvalues().reverse().cwiseInverse() * std::pow(length, 4);
}

/// A table of one value everywhere is that value: panels end at the rows, so the integrals differ by rounding alone.
TEST(BeamSection, constant_tables_are_constants) {
  const auto plain = beam({});
  const auto tabled = beam({.mass = table({1, 1, 1, 1}), .stiffness = table({1, 1, 1})});
  EXPECT_LT((modal_mass(*plain) - modal_mass(*tabled)).norm(), 1e-13 * modal_mass(*plain).norm());
  EXPECT_LT((plain->shape().stiffness - tabled->shape().stiffness).norm(), 1e-13 * plain->shape().stiffness.norm());
  for (const double x : {0.0, 0.3, length / 3, 0.9, length}) {
    const PointExpansion a = *plain->station(x), b = *tabled->station(x);
    EXPECT_LT((a.gamma[0] - b.gamma[0]).norm(), 1e-12 * (1 + a.gamma[0].norm()));
  }
}

/// Mass and first moment of a zigzag: exact, since no panel has a kink inside.
TEST(BeamSection, mass_properties_of_a_table_are_exact) {
  const auto body = beam({.mass = table({2, 0.5, 3, 1}), .stiffness = table({1, 2})});
  double mass = 0, moment = 0;
  for (const Particle& p : body->shape().particles) {
    mass += p.mass;
    moment += p.mass * p.at.X.x();
  }
  const double h = length / 3;
  double exact_mass = 0, exact_moment = 0;
  const double m[] = {2, 0.5, 3, 1};
  for (int i = 0; i < 3; ++i) {
    exact_mass += h * (m[i] + m[i + 1]) / 2;
    exact_moment += h * (i * h * (m[i] + m[i + 1]) / 2 + h * (m[i] + 2 * m[i + 1]) / 6);
  }
  EXPECT_NEAR(mass, exact_mass, 1e-13 * exact_mass);
  EXPECT_NEAR(moment, exact_moment, 1e-13 * exact_moment);
  expect_body_conforms(*body);
}

/// First squared frequencies of the clamped beam with m = m₀(1 − cξ), EI = EI₀(1 − cξ) from an independent Ritz basis,
/// the monomials ξ^(k+2), whose integrals are fractions: ∫ ξᵖ (1 − cξ) = 1/(p+1) − c/(p+2). Eight leave 1e-9.
Eigen::VectorXd monomial_ritz(double c) {
  const int n = 8;
  const auto integral = [&](int p) { return 1.0 / (p + 1) - c / (p + 2); };
  Eigen::MatrixXd M(n, n), K(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      M(i, j) = integral(i + j + 4);
      K(i, j) = (i + 2) * (i + 1) * (j + 2) * (j + 1) * integral(i + j);
    }
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(M, K);
  return eigen.eigenvalues().reverse().cwiseInverse();
}

/// A cantilever whose width falls to half at the tip. Mode families are Ritz functions then; every complete one comes
/// within 1e-4 of the frequency.
TEST(BeamSection, frequencies_of_a_tapered_cantilever) {
  const Eigen::VectorXd exact = monomial_ritz(0.5);
  for (const auto& [family, modes] :
       {std::pair("clamped-free", 6.0), std::pair("orthogonal-polynomials", 7.0), std::pair("craig-bampton", 8.0)}) {
    const auto body = beam({.mass = table({1, 0.5}), .stiffness = table({1, 0.5}), .family = family, .modes = modes});
    const Eigen::VectorXd found = squared_frequencies(*body);
    EXPECT_NEAR(found[0] / exact[0], 1, 2e-4) << family;
    EXPECT_NEAR(found[1] / exact[1], 1, 2e-4) << family;
    EXPECT_GT(found[0] / exact[0], 1 - 1e-8) << family;
  }
}

/// Rayleigh's beam between pins, in closed form: ω² = (EI/m)(kπ/L)⁴/(1 + (ρI/m)(kπ/L)²), sines being its modes too.
TEST(BeamSection, rotary_inertia_lowers_the_frequencies_as_rayleigh_says) {
  const double rotary = 0.003;
  const auto body = beam({.family = "pinned-pinned", .modes = 4, .inertia = Value(rotary)});
  const Eigen::VectorXd found = squared_frequencies(*body) / std::pow(length, 4);
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double b = static_cast<double>(k + 1) * std::numbers::pi / length;
    const double exact = std::pow(b, 4) / (1 + rotary * b * b);
    EXPECT_NEAR(found[k] / exact, 1, 1e-11);
  }
  expect_body_conforms(*body);
}

/// The sections' inertia is about the axis the strain turns them about, and stays without modes. The line of mass of
/// such a beam is a section of its own: ρL³/12 about y and z.
TEST(BeamSection, rotary_inertia_is_about_the_axis_of_bending) {
  for (const auto& [strain, axis] :
       {std::pair("bending_y", Vector3::UnitZ()), {"bending_z", Vector3::UnitY()}, {"torsion", Vector3::UnitX()}}) {
    const auto body = beam({.modes = 0, .inertia = table({0.002, 0.004}), .strain = strain});
    Matrix3 sum = Matrix3::Zero();
    for (const withy::Section& s : body->shape().sections) sum += s.inertia;
    const double line = std::pow(length, 3) / 12;
    const Matrix3 exact = 0.003 * length * axis * axis.transpose() + Matrix3(Vector3(0, line, line).asDiagonal());
    EXPECT_LT((sum - exact).norm(), 1e-15) << strain;
  }
}

/// Torsion with GJ and ρI_p both falling linearly as 1 − cξ: the same independent basis, ξ^(k+1) being held at the
/// root.
TEST(BeamSection, frequencies_of_a_tapered_rod) {
  const int n = 7;
  const double c = 0.6;
  const auto integral = [&](int p) { return 1.0 / (p + 1) - c / (p + 2); };
  Eigen::MatrixXd M(n, n), K(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      M(i, j) = integral(i + j + 2);
      K(i, j) = (i + 1) * (j + 1) * integral(i + j);
    }
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(M, K);
  const double exact = 1 / eigen.eigenvalues()[n - 1];
  const auto body = beam({.stiffness = table({1, 0.4}),
                          .family = "orthogonal-polynomials",
                          .modes = 7,
                          .inertia = table({1, 0.4}),
                          .strain = "torsion"});
  const double found = squared_frequencies(*body)[0] / (length * length);
  EXPECT_NEAR(found / exact, 1, 1e-8);
}

}  // namespace
}  // namespace withy::test
