#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>
#include <string>

#include "withy/core/shape/modal_mass.hpp"
#include "withy/core/shape/vibrations.hpp"
#include "withy/core/simulation/elastic_modes.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/tests/bodies/beam_fixture.hpp"
#include "withy/tests/conformance/body_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

/// 3 + 2 bending modes and 2 of twist, 1.3 m long.
std::unique_ptr<Body> beam(Registry& registry) {
  return make_plugin<Body>(registry, "beam",
                           {{"length", Value(1.3)},
                            {"mass_per_length", Value(0.7)},
                            {"bending_y", strain(40, 3)},
                            {"bending_z", strain(25, 2)},
                            {"torsion", strain(30, 2, 0.002)},
                            {"damping_ratio", Value(0.01)}});
}

TEST(Body, rigid_conforms) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto body = make_plugin<Body>(registry, "rigid", {{"mass", Value(2.0)}});
  ASSERT_NE(body, nullptr);
  expect_body_conforms(*body);
}

/// No mass has a principal moment above the sum of the others: ∫(y²+z²) + ∫(x²+z²) − ∫(x²+y²) = 2∫z² ≥ 0. A plate has
/// the sum itself.
TEST(Body, rigid_refuses_moments_that_no_distribution_of_mass_has) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto accepted = [&](std::vector<double> inertia) {
    std::vector<Value> numbers;
    for (const double i : inertia) numbers.emplace_back(i);
    Diagnostics diagnostics;
    const auto body =
        make_plugin<Body>(registry, "rigid", {{"mass", Value(2.0)}, {"inertia", Value::list(numbers)}}, diagnostics);
    return body != nullptr;
  };
  EXPECT_TRUE(accepted({1, 1, 2, 0, 0, 0}));
  EXPECT_FALSE(accepted({1, 1, 2.001, 0, 0, 0}));
  EXPECT_FALSE(accepted({3, 1, 1, 0, 0, 0}));
  EXPECT_FALSE(accepted({1, 1, 1, 0, 0, -0.9})) << "principal moments 0.1, 1, 1.9";
  EXPECT_TRUE(accepted({1, 1, 1, 0, 0, -0.4})) << "principal moments 0.6, 1, 1.4";
}

TEST(Body, beam_conforms) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto body = beam(registry);
  ASSERT_NE(body, nullptr);
  expect_body_conforms(*body);
}

/// Each mode has the asked for part of its critical damping 2 √(K G), G with the rotary inertia that is all a torsion
/// mode has.
/// A beam takes what those before it with its fields have left.
TEST(Beam, is_the_same_to_the_last_bit_whatever_beams_have_been_before) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto make = [&](double mass, double stiffness) {
    return make_plugin<Body>(registry, "beam",
                             {{"length", Value(0.8317)},
                              {"mass_per_length", Value(mass)},
                              {"bending_y", strain(stiffness, 3)},
                              {"bending_z", strain(25, 1)},
                              {"damping_ratio", Value(0.01)}});
  };
  const auto first = make(0.7, 40);  // there were none with these fields
  for (const double mass : {2.1, 3.3}) {
    const auto one = make(mass, 55), other = make(mass, 60);  // and are no more
    ASSERT_EQ(first->shape().particles.size(), one->shape().particles.size());
    EXPECT_NE(first->shape().particles[1].mass, one->shape().particles[1].mass);
  }
  const auto again = make(0.7, 40), beside = make(0.9, 40);
  const ModalShape &a = first->shape(), &b = again->shape();
  EXPECT_EQ(a.mode_names, b.mode_names);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.damping, b.damping);
  ASSERT_EQ(a.particles.size(), b.particles.size());
  for (std::size_t k = 0; k < a.particles.size(); ++k) {
    const Particle &p = a.particles[k], &q = b.particles[k];
    EXPECT_EQ(p.mass, q.mass) << "point " << k;
    EXPECT_EQ(p.at.X, q.at.X) << "point " << k;
    EXPECT_EQ(p.at.phi, q.at.phi) << "point " << k;
    EXPECT_EQ(p.at.psi, q.at.psi) << "point " << k;
    EXPECT_EQ(p.at.gamma, q.at.gamma) << "point " << k;
    EXPECT_EQ(p.at.theta, q.at.theta) << "point " << k;
    EXPECT_NE(p.mass, beside->shape().particles[k].mass) << "point " << k;
  }
}

TEST(Beam, damping_is_the_asked_for_ratio_of_each_mode) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto body = beam(registry);
  const ModalShape& shape = body->shape();
  Eigen::VectorXd G = Eigen::VectorXd::Zero(shape.modes());
  for (const Particle& p : shape.particles) G += p.mass * p.at.phi.colwise().squaredNorm().transpose();
  for (const Section& s : shape.sections) G += (s.at.psi.transpose() * s.inertia * s.at.psi).diagonal();
  for (Eigen::Index i = 0; i < shape.modes(); ++i)
    EXPECT_NEAR(shape.damping(i, i) / (2 * std::sqrt(shape.stiffness(i, i) * G[i])), 0.01, 1e-14) << i;
}

/// v' D v = 2 ζ ω of the body's own modes, whatever functions describe them.
double ratio_of_mode(const ModalShape& shape, Eigen::Index k) {
  const ElasticModes modes = elastic_modes(shape);
  const Eigen::VectorXd v = modes.vectors.col(k);
  return v.dot(shape.damping * v) / (2 * modes.frequencies[k]);
}

TEST(Beam, damping_ratio_is_of_its_own_modes_in_every_family) {
  Registry registry;
  enroll_static_plugins(registry);
  for (const std::string family : {"clamped-free", "orthogonal-polynomials", "craig-bampton", "free-free"}) {
    Value bending = strain(40, 4);
    bending.set("family", Value(family));
    const auto body = make_plugin<Body>(registry, "beam",
                                        {{"length", Value(1.3)},
                                         {"mass_per_length", Value(0.7)},
                                         {"bending_y", bending},
                                         {"bending_z", bending},
                                         {"damping_ratio", Value(0.01)}});
    ASSERT_NE(body, nullptr) << family;
    const Eigen::Index count = elastic_modes(body->shape()).frequencies.size();
    for (Eigen::Index k = 0; k < count; ++k) EXPECT_NEAR(ratio_of_mode(body->shape(), k), 0.01, 1e-10) << family << k;
    EXPECT_TRUE(body->shape().damping.topRightCorner(4, 4).isZero(0)) << "planes stay apart, " << family;
  }
}

/// A hundred polynomials have squared frequencies 1e14 apart: the least is no rounding of the greatest. The lowest mode
/// by inverse iteration, which does not feel the others.
TEST(Beam, damping_ratio_is_of_the_lowest_mode_too_however_many_functions_there_are) {
  Registry registry;
  enroll_static_plugins(registry);
  for (const int n : {31, 32, 100}) {
    Value bending = strain(40, n);
    bending.set("family", Value(std::string("orthogonal-polynomials")));
    const auto body = make_plugin<Body>(registry, "beam",
                                        {{"length", Value(1.3)},
                                         {"mass_per_length", Value(0.7)},
                                         {"bending_y", bending},
                                         {"damping_ratio", Value(0.01)}});
    ASSERT_NE(body, nullptr);
    const Eigen::MatrixXd G = modal_mass(body->shape());
    const Eigen::LLT<Eigen::MatrixXd> stiffness(body->shape().stiffness);
    Eigen::VectorXd v = Eigen::VectorXd::Unit(n, 0);
    for (int i = 0; i < 20; ++i) v = stiffness.solve(Eigen::VectorXd(G * v)).normalized();
    const double omega = std::sqrt(v.dot(body->shape().stiffness * v) / v.dot(G * v));
    EXPECT_NEAR(omega / (3.5160152685 / (1.3 * 1.3) * std::sqrt(40 / 0.7)), 1, 1e-9) << n;
    EXPECT_NEAR(v.dot(body->shape().damping * v) / (2 * omega * v.dot(G * v)), 0.01, 1e-7) << n;
    const ElasticModes modes = elastic_modes(body->shape());
    ASSERT_EQ(modes.frequencies.size(), n) << "none is taken for a motion without strain";
    EXPECT_NEAR(modes.frequencies[0] / omega, 1, 1e-5) << n;
  }
}

/// Masses in a row on springs from 1 to 1e11 N/m: all of them together are held by none.
TEST(Vibrations, a_motion_without_strain_is_told_from_slow_vibrations) {
  constexpr Eigen::Index n = 12;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const Eigen::Vector2d ends(1, -1);
    K.block<2, 2>(i, i) += std::pow(10.0, static_cast<double>(i)) * ends * ends.transpose();
  }
  const Vibrations all = vibrations(K, Eigen::MatrixXd::Identity(n, n));
  EXPECT_EQ(all.rigid(), 1);
  // The first mass on the softest spring, all others as one.
  EXPECT_NEAR(all.squares[1], 1 + 1.0 / (n - 1), 0.2);
  EXPECT_THROW(static_cast<void>(vibrations(K, K)), std::domain_error);
  K(0, 0) -= 1e-3;  // as a file with few digits has it
  EXPECT_EQ(vibrations(K, Eigen::MatrixXd::Identity(n, n)).rigid(), 1);
}

TEST(Beam, single_modes_and_stiffness_have_damping_of_their_own) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto row = [](double mode, double ratio) { return Value::list({Value(mode), Value(ratio)}); };
  Value damping = Value::map({});
  damping.set("ratios", Value::list({row(1, 0.02), row(3, 0.05)}));
  damping.set("stiffness_proportional", Value(1e-4));
  const auto body = make_plugin<Body>(registry, "beam",
                                      {{"length", Value(1.3)},
                                       {"mass_per_length", Value(0.7)},
                                       {"bending_y", strain(40, 3)},
                                       {"bending_z", strain(25, 2)},
                                       {"damping_ratio", Value(0.01)},
                                       {"damping", damping}});
  ASSERT_NE(body, nullptr);
  const ElasticModes modes = elastic_modes(body->shape());
  const std::vector<double> asked = {0.02, 0.01, 0.05, 0.01, 0.01};
  for (Eigen::Index k = 0; k < 5; ++k)
    EXPECT_NEAR(ratio_of_mode(body->shape(), k), asked[static_cast<std::size_t>(k)] + 1e-4 * modes.frequencies[k] / 2,
                1e-12);
  EXPECT_TRUE(body->remarks().empty());
}

/// What is allowed and odd is said.
TEST(Beam, remarks_on_damping_beyond_critical_and_on_strains_without_modes) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto body = make_plugin<Body>(registry, "beam",
                                      {{"length", Value(1.3)},
                                       {"mass_per_length", Value(0.7)},
                                       {"bending_y", strain(40, 2)},
                                       {"bending_z", strain(25, 0)},
                                       {"damping_ratio", Value(5.0)}});
  ASSERT_NE(body, nullptr);
  EXPECT_THAT(body->remarks(), testing::ElementsAre(testing::HasSubstr("damping ratio 5 is above 1"),
                                                    testing::HasSubstr("bending_z has no modes")));
}

/// r′ = R e_x with R′ = R κ̂: an inextensible rod without shear, to second order in q. The defect of the second-order
/// expansion at amplitude ε is O(ε³), so halving ε divides it by eight; r′ by central differences of step 1e-4 m, whose
/// error of 1e-8 of the third derivative is below the defects compared.
TEST(Beam, second_order_kinematics_are_inextensible_and_shearless_to_second_order) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto body = beam(registry);
  Eigen::VectorXd q(7);
  q << 0.11, -0.02, 0.01, 0.08, 0.015, 0.3, -0.1;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(7);
  const auto defect = [&](double epsilon) {
    double worst = 0;
    for (const double x : {0.4, 0.8, 1.2}) {
      const double h = 1e-4;
      const auto at = [&](double s) {
        return point_motion<double>(*body->station(s), StrainOrder::quadratic, epsilon * q, rest);
      };
      const Vector3 tangent = (at(x + h).r - at(x - h).r) / (2 * h);
      worst = std::max(worst, (tangent - at(x).R.col(0)).norm());
    }
    return worst;
  };
  const double ratio = defect(0.4) / defect(0.2);
  EXPECT_NEAR(std::log2(ratio), 3.0, 0.25);
}

/// Foreshortening of a cantilever in its first mode, −½∫φ′² q²: ∫₀ᴸ φ₁′² dx = 4.6477761/L for the normalization
/// ∫φ² = L (Blevins 1979, table 8-1 gives the integral as 4.648).
TEST(Beam, foreshortening_of_the_first_mode) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto body = make_plugin<Body>(
      registry, "beam", {{"length", Value(2.0)}, {"mass_per_length", Value(1.0)}, {"bending_y", strain(10, 1)}});
  const auto tip = body->station(std::string("tip"));
  EXPECT_NEAR(tip->gamma[0](0, 0), -4.648 / 2.0, 1e-3);
  EXPECT_NEAR(tip->phi(1, 0), 2.0, 1e-12);
}

/// Frequencies of the cantilever: ω_k = β_k² √(EI/ρA L⁴), β = 1.87510407, 4.69409113, 7.85475744 (Blevins 1979).
TEST(Beam, cantilever_frequencies) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto body = make_plugin<Body>(
      registry, "beam", {{"length", Value(2.0)}, {"mass_per_length", Value(3.0)}, {"bending_z", strain(10, 3)}});
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(3, 3);
  for (const Particle& p : body->shape().particles) G += p.mass * p.at.phi.transpose() * p.at.phi;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(body->shape().stiffness, G);
  const double beta[] = {1.87510407, 4.69409113, 7.85475744};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double omega = beta[k] * beta[k] * std::sqrt(10 / (3.0 * 16));
    EXPECT_NEAR(std::sqrt(eigen.eigenvalues()[k]), omega, 1e-7 * omega);
  }
}

}  // namespace
}  // namespace withy::test
