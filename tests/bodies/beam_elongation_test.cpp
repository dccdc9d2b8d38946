/// \file
/// Beams with extension and shear: closed forms of rods and of Timoshenko's beam, and their second-order kinematics.
#include <gmock/gmock.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numbers>

#include "withy/core/deformation/rod_motion.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"
#include "withy/tests/bodies/beam_fixture.hpp"
#include "withy/tests/conformance/body_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

using std::numbers::pi;
constexpr double L = 1.6, mass = 1.3;  ///< m, kg/m

Value along(double stiffness, int modes, const char* family = "orthogonal-polynomials", double rotary = 0) {
  Value v = Value::map(
      {{"stiffness", Value(stiffness)}, {"modes", Value(double(modes))}, {"family", Value(std::string(family))}});
  if (rotary > 0) v.set("rotary_inertia", Value(rotary));
  return v;
}

std::unique_ptr<Body> elastic_beam(std::vector<Value::Member> strains) {
  Registry registry;
  enroll_static_plugins(registry);
  strains.insert(strains.begin(), {{"length", Value(L)}, {"mass_per_length", Value(mass)}});
  return make_plugin<Body>(registry, "beam", std::move(strains));
}

/// The beam with the Γ and Θ of a strain kinematics.
std::shared_ptr<const Body> expanded(const Body& body, const std::string& kinematics) {
  Registry registry;
  enroll_static_plugins(registry);
  return body.expanded(*make_plugin<StrainKinematics>(registry, kinematics));
}

/// Angular frequencies, rising.
Eigen::VectorXd frequencies(const Body& body) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(body.shape().stiffness, modal_mass(body));
  return eigen.eigenvalues().cwiseSqrt();
}

/// (2k − 1) π/2 √(EA/μ)/L: clamped-free functions are the eigenfunctions; eight polynomials have the first three to
/// 1e-8.
TEST(BeamElongation, rods_have_their_frequencies) {
  for (const char* key : {"extension", "shear_y", "shear_z"}) {
    const double EA = 5e4;
    const Eigen::VectorXd waves = frequencies(*elastic_beam({{key, along(EA, 3, "clamped-free")}}));
    const Eigen::VectorXd polynomials = frequencies(*elastic_beam({{key, along(EA, 8)}}));
    for (int k = 1; k <= 3; ++k) {
      const double exact = (2 * k - 1) * pi / 2 * std::sqrt(EA / mass) / L;
      EXPECT_NEAR(waves[k - 1] / exact, 1, 1e-12) << key;
      EXPECT_NEAR(polynomials[k - 1] / exact, 1, 1e-5) << key << k;
    }
  }
}

/// A rod with a mass m at its tip: β tan β = μ L/m; clamped-loaded has its eigenfunctions.
TEST(BeamElongation, clamped_loaded_rod_carries_a_mass) {
  const double EA = 5e4, tip = 0.7;
  Value s = along(EA, 1);
  s.set("family",
        Value::map(
            {{"name", Value(std::string("clamped-loaded"))}, {"tip_mass", Value(tip)}, {"tip_offset", Value(0.0)}}));
  const auto body = elastic_beam({{"extension", s}});
  const double phi = body->station(std::string("tip"))->phi(0, 0);
  const double omega = std::sqrt(body->shape().stiffness(0, 0) / (modal_mass(*body)(0, 0) + tip * phi * phi));
  const double beta = omega * L * std::sqrt(mass / EA);
  EXPECT_NEAR(beta * std::tan(beta), mass * L / tip, 1e-10);
}

/// Frequencies of Timoshenko's cantilever, T. C. Huang, J. Appl. Mech. 28 (1961), 579–584: with b² = μ ω² L⁴/EI,
/// r² = ρI/(μ L²), s² = EI/(kGA L²), 2 (α², β²) = √((r² − s²)² + 4/b²) ∓ (r² + s²),
///   2 + (b² (r² − s²)² + 2) cosh bα cos bβ = b (r² + s²)/√(1 − b² r² s²) sinh bα sin bβ.
double timoshenko(double r2, double s2, double low, double high) {
  const auto f = [&](double b) {
    const double root = std::sqrt(std::pow(r2 - s2, 2) + 4 / (b * b));
    const double alpha = b * std::sqrt((root - r2 - s2) / 2), beta = b * std::sqrt((root + r2 + s2) / 2);
    return 2 + (b * b * std::pow(r2 - s2, 2) + 2) * std::cosh(alpha) * std::cos(beta) -
           b * (r2 + s2) / std::sqrt(1 - b * b * r2 * s2) * std::sinh(alpha) * std::sin(beta);
  };
  std::uintmax_t iterations = 100;
  const auto [a, b] =
      boost::math::tools::toms748_solve(f, low, high, boost::math::tools::eps_tolerance<double>(48), iterations);
  return (a + b) / 2;
}

TEST(BeamElongation, timoshenko_cantilever_has_huangs_frequencies) {
  const double EI = 200, r2 = 0.0016, s2 = 0.005;
  const std::array<std::array<double, 2>, 3> brackets = {{{3, 3.6}, {15, 22.1}, {35, 61}}};
  for (const char* across : {"y", "z"}) {
    const auto body =
        elastic_beam({{std::string("bending_") + across, along(EI, 10, "orthogonal-polynomials", r2 * mass * L * L)},
                      {std::string("shear_") + across, along(EI / (s2 * L * L), 10)}});
    const Eigen::VectorXd found = frequencies(*body);
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = brackets[static_cast<std::size_t>(k)];
      const double exact = timoshenko(r2, s2, low, high) * std::sqrt(EI / mass) / (L * L);
      EXPECT_NEAR(found[k] / exact, 1, 1e-7) << across << k;
    }
  }
  // Bending alone is 1 % off already in the first.
  EXPECT_GT(3.51602 / timoshenko(r2, s2, 3, 3.6), 1.01);
}

/// F L³/3EI + F L/kGA.
TEST(BeamElongation, shear_adds_to_the_static_deflection) {
  const double EI = 200, kGA = 900;
  const auto body = elastic_beam({{"bending_y", along(EI, 3)}, {"shear_y", along(kGA, 3)}});
  const Eigen::VectorXd lift = body->station(std::string("tip"))->phi.row(1);
  EXPECT_NEAR(lift.dot(body->shape().stiffness.ldlt().solve(lift)), L * L * L / (3 * EI) + L / kGA, 1e-12);
}

/// A column with shear buckles at P (1 + P/kGA) = π² EI/4L² where shear forces are across the turned section
/// (J. A. Haringx, Philips Res. Rep. 3, 1948): what Γ's product of rotation and shear is for.
TEST(BeamElongation, column_with_shear_buckles_as_haringx_says) {
  const double EI = 200, kGA = 900;
  const std::shared_ptr<const Body> complete = elastic_beam({{"bending_y", along(EI, 8)}, {"shear_y", along(kGA, 8)}});
  for (const auto& body : {complete, expanded(*complete, "foreshortening")}) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(-body->station(std::string("tip"))->gamma[0],
                                                                          body->shape().stiffness);
    const double P = 1 / eigen.eigenvalues().maxCoeff();
    EXPECT_NEAR(P * (1 + P / kGA) / (pi * pi * EI / (4 * L * L)), 1, 1e-6);
  }
}

/// Nothing twists in a plane: what bends, shears and stretches there has the complete second order.
TEST(BeamElongation, foreshortening_is_the_complete_second_order_in_a_plane) {
  for (const std::string across : {"y", "z"}) {
    const auto body = elastic_beam(
        {{"bending_" + across, along(200, 3)}, {"shear_" + across, along(900, 3)}, {"extension", along(5e4, 2)}});
    const PointExpansion own = *body->station(0.7 * L), anew = *expanded(*body, "foreshortening")->station(0.7 * L);
    // Bending and extension make a coupling across that is no shortening.
    EXPECT_GT(own.gamma[across == "y" ? 1 : 2].norm(), 0.01 * own.gamma[0].norm());
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_LT((own.gamma[c] - anew.gamma[c]).norm(), 1e-13 * own.gamma[0].norm()) << across << c;
      EXPECT_LT((own.theta[c] - anew.theta[c]).norm(), 1e-13) << across << c;
    }
  }
}

/// Γ and Θ against r′ = R (e_x + γ), R′ = R κ̂ integrated by small steps at ε q: what is left is of the third order, so
/// that half the ε leaves an eighth.
TEST(BeamElongation, second_order_is_that_of_the_kinematics) {
  const auto body = elastic_beam({{"bending_y", along(1, 2)},
                                  {"bending_z", along(1, 2)},
                                  {"torsion",
                                   [] {
                                     Value v = along(1, 2);
                                     v.set("inertia", Value(1.0));
                                     return v;
                                   }()},
                                  {"extension", along(1, 2)},
                                  {"shear_y", along(1, 2)},
                                  {"shear_z", along(1, 2)}});
  const Eigen::Index n = body->shape().modes();
  ASSERT_EQ(n, 12);
  Eigen::VectorXd q(n);
  q << 0.3, -0.2, 0.25, 0.1, 0.4, 0.3, -0.2, 0.3, 0.25, -0.3, 0.2, 0.15;
  // Strains from the fields at stations: κ = ψ′ and γ = Φ′ − ψ × e_x, by central differences of 1e-5.
  const auto strains = [&](double x) {
    const double h = 1e-5, a = std::max(0.0, x - h), b = std::min(L, x + h);
    const PointExpansion before = *body->station(a), after = *body->station(b), here = *body->station(x);
    const Matrix3X kappa = (after.psi - before.psi) / (b - a);
    Matrix3X gamma = (after.phi - before.phi) / (b - a);
    for (Eigen::Index i = 0; i < n; ++i) gamma.col(i) -= Vector3(here.psi.col(i)).cross(Vector3::UnitX());
    return std::pair<Vector3, Vector3>(kappa * q, gamma * q);
  };
  constexpr int steps = 1000;
  std::vector<std::pair<Vector3, Vector3>> at;  // at the middles of the steps
  for (int i = 0; i < steps; ++i) at.push_back(strains(L * (i + 0.5) / steps));
  const PointExpansion tip = *body->station(std::string("tip"));
  const auto miss = [&](double eps) {
    Matrix3 R = Matrix3::Identity();
    Vector3 r = Vector3::Zero();
    const double h = L / steps;
    for (const auto& [kappa, gamma] : at) {
      const Vector3 turn = eps * h * kappa;
      const Matrix3 half = Eigen::AngleAxisd(turn.norm() / 2, turn.normalized()).toRotationMatrix();
      r += h * (R * half * (Vector3::UnitX() + eps * gamma));
      R = R * half * half;
    }
    const Vector3 quadratic(q.dot(tip.gamma[0] * q), q.dot(tip.gamma[1] * q), q.dot(tip.gamma[2] * q));
    return (r - tip.X - eps * tip.phi * q - 0.5 * eps * eps * quadratic).norm();
  };
  const double coarse = miss(0.1), fine = miss(0.05);
  EXPECT_LT(coarse, 1e-2);
  EXPECT_NEAR(coarse / fine, 8, 1.5);
}

TEST(BeamElongation, body_conforms) {
  expect_body_conforms(*elastic_beam({{"bending_y", along(200, 2, "clamped-free")},
                                      {"extension", along(5e4, 2, "clamped-free")},
                                      {"shear_y", along(900, 2, "clamped-free")},
                                      {"shear_z", along(700, 1, "clamped-free")}}));
}

/// Reissner's beam under a dead end force F across it and a pull N along it: θ′ = M/EI, r′ = R(θ) (1 + N_s/EA, Q_s/kGA)
/// with N_s, Q_s the end force in the section's axes, M′ = −(r′ × F)_z, θ(0) = 0, M(L) = 0, shot from the root.
struct Reissner {
  double EI, EA, kGA;
  Eigen::Vector2d force;

  [[nodiscard]] std::array<double, 4> to_tip(double moment_at_root) const {
    std::array<double, 4> y{0, moment_at_root, 0, 0};  // θ, M, x, y
    const auto slope = [this](const std::array<double, 4>& at) {
      const double c = std::cos(at[0]), s = std::sin(at[0]);
      const double along = 1 + (c * force[0] + s * force[1]) / EA, across = (c * force[1] - s * force[0]) / kGA;
      const double x = c * along - s * across, w = s * along + c * across;
      return std::array<double, 4>{at[1] / EI, -(x * force[1] - w * force[0]), x, w};
    };
    constexpr int steps = 2000;
    const double h = L / steps;
    for (int k = 0; k < steps; ++k) {
      const auto moved = [&](const std::array<double, 4>& by, double part) {
        std::array<double, 4> at = y;
        for (std::size_t i = 0; i < 4; ++i) at[i] += part * h * by[i];
        return at;
      };
      const auto a = slope(y), b = slope(moved(a, 0.5)), c = slope(moved(b, 0.5)), d = slope(moved(c, 1));
      for (std::size_t i = 0; i < 4; ++i) y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    }
    return y;
  }
  [[nodiscard]] Eigen::Vector2d tip() const {
    std::uintmax_t iterations = 200;
    const auto [a, b] =
        boost::math::tools::toms748_solve([this](double m) { return to_tip(m)[1]; }, 0.0, 2 * L * force.norm(),
                                          boost::math::tools::eps_tolerance<double>(48), iterations);
    const std::array<double, 4> end = to_tip((a + b) / 2);
    return {end[2], end[3]};
  }
};

/// Equilibrium K q = Pᵀ F of a beam of exact kinematics, by Newton's iteration: polynomials have what bends, stretches
/// and shears it. Stretched by 4 %, sheared by 0.1 rad and bent by more than half its length.
TEST(BeamElongation, exact_rod_bends_stretches_and_shears_as_reissner_says) {
  const Reissner truth{40, 900, 300, {-8, 30}};
  const auto body = elastic_beam(
      {{"bending_y", along(truth.EI, 7)}, {"extension", along(truth.EA, 7)}, {"shear_y", along(truth.kGA, 7)}});
  ASSERT_NE(body->rod(), nullptr);
  const RodTable table(*body->rod());
  const Eigen::Index n = body->shape().modes();
  Eigen::VectorXd q = Eigen::VectorXd::Zero(n);
  const auto residual = [&](const Eigen::VectorXd& at, double part) {
    const PointMotionOf<double> tip = RodMotion(table, at, Eigen::VectorXd::Zero(n)).at(L);
    const Vector3 F(part * truth.force[0], part * truth.force[1], 0);
    return Eigen::VectorXd(body->shape().stiffness * at - tip.P.transpose() * F);
  };
  for (const double part : {0.25, 0.5, 0.75, 1.0, 1.0}) {
    for (int iteration = 0; iteration < 6; ++iteration) {
      Eigen::MatrixXd tangent(n, n);
      for (Eigen::Index j = 0; j < n; ++j) {
        const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(n, j);
        tangent.col(j) = (residual(q + step, part) - residual(q - step, part)) / 2e-6;
      }
      q -= tangent.partialPivLu().solve(residual(q, part));
    }
  }
  const Vector3 tip = RodMotion(table, q, Eigen::VectorXd::Zero(n)).at(L).r;
  const Eigen::Vector2d expected = truth.tip();
  EXPECT_GT(expected[1], 0.5 * L);
  EXPECT_NEAR(tip.x(), expected[0], 1e-7);
  EXPECT_NEAR(tip.y(), expected[1], 1e-7);
}

/// Turned back by shear, a root that turns moves no mass.
TEST(BeamElongation, shear_without_rotary_inertia_is_remarked_on) {
  const auto with = [](double rotary) {
    return elastic_beam({{"bending_y", along(200, 2, "orthogonal-polynomials", rotary)}, {"shear_y", along(900, 1)}});
  };
  ASSERT_EQ(with(0)->remarks().size(), 1U);
  EXPECT_THAT(with(0)->remarks()[0], testing::HasSubstr("shear_y without a rotary_inertia in bending_y"));
  EXPECT_TRUE(with(0.01)->remarks().empty());
}

/// A pin says nothing of stretching.
TEST(BeamElongation, families_without_rods_are_refused) {
  Registry registry;
  enroll_static_plugins(registry);
  Diagnostics diagnostics;
  EXPECT_EQ(make_plugin<Body>(
                registry, "beam",
                {{"length", Value(L)}, {"mass_per_length", Value(mass)}, {"shear_y", along(1, 1, "pinned-free")}},
                diagnostics),
            nullptr);
  ASSERT_EQ(diagnostics.errors().size(), 1U);
  EXPECT_THAT(diagnostics.errors()[0].message,
              testing::HasSubstr("'pinned-free' has no functions for extension and shear"));
}

}  // namespace
}  // namespace withy::test
