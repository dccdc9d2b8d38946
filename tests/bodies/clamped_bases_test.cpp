/// \file
/// Clamped families that are no eigenfunctions of the bare beam: with a tip body, polynomials, Craig–Bampton.
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "family_fixture.hpp"

namespace withy::test {
namespace {

using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<330>>;
using Exact2 = std::array<Exact, 2>;

struct Tip {
  const char* name;
  double mass, inertia, offset;  ///< for a beam of mass 1 and length 1
};
void PrintTo(const Tip& tip, std::ostream* out) { *out << tip.name; }

/// From none to far heavier than the beam, with the centre of mass behind and before the tip.
const Tip tips[] = {{"bare", 0, 0, 0},
                    {"mass", 1, 0, 0},
                    {"light", 0.03, 1e-4, 0},
                    {"inertia_alone", 0, 0.2, 0},
                    {"heavy", 50, 8, 0.3},
                    {"centre_inboard", 0.7, 0.01, -0.4},
                    {"very_heavy", 1e6, 1e5, 0},
                    {"point_far_out", 2, 0, 1.5},
                    {"wall", 1e9, 0, 0},
                    {"wheel", 0, 1e9, 0},
                    {"heavy_point_out", 1e9, 0, 0.01},
                    {"anvil", 1e9, 1e3, -0.2}};

std::unique_ptr<ModeFamily> loaded(const Tip& t) {
  return family("clamped-loaded",
                {{"tip_mass", Value(t.mass)}, {"tip_inertia", Value(t.inertia)}, {"tip_offset", Value(t.offset)}});
}

/// Derivatives 0 to 3 of cosh − cos and of sinh − sin.
struct Krylov {
  std::array<Exact, 4> u, v;
  explicit Krylov(const Exact& x) {
    const Exact ch = cosh(x), sh = sinh(x), c = cos(x), s = sin(x);
    u = {ch - c, sh + s, ch + c, sh - s};
    v = {sh - s, ch - c, sh + s, ch + c};
  }
};

/// Residuals of the tip's force and moment for the two solutions, from the equations of motion of the tip body: shear
/// −φ‴ moves the mass at φ + aφ′, the moment φ″ and the shear's lever turn the inertia.
struct TipResiduals {
  Exact2 force, moment;
};
TipResiduals residuals(const Tip& t, const Exact& beta) {
  const Krylov k(beta);
  const auto both = [&](const std::array<Exact, 4>& d) {
    const Exact b4 = pow(beta, 4);
    const Exact slope = beta * d[1];
    const Exact center = d[0] + t.offset * slope;
    const Exact force = pow(beta, 3) * d[3] + b4 * t.mass * center;
    const Exact moment = beta * beta * d[2] - b4 * (t.inertia * slope + t.offset * t.mass * center);
    return Exact2{force, moment};
  };
  const Exact2 a = both(k.u), b = both(k.v);
  return {{a[0], b[0]}, {a[1], b[1]}};
}
Exact determinant(const Tip& t, const Exact& beta) {
  const TipResiduals r = residuals(t, beta);
  return (r.force[0] * r.moment[1] - r.force[1] * r.moment[0]) / (cosh(beta) * pow(beta, 4));
}

class ClampedLoaded : public testing::TestWithParam<Tip> {};

TEST_P(ClampedLoaded, conforms_in_bending_and_torsion) {
  const auto f = loaded(GetParam());
  expect_family_conforms(*f, bending_beam(1.7));
  expect_family_conforms(*f, torsion_rod(1.7));
}

/// The root nearest to each wave number, by the secant method in 330 digits, and the function that belongs to it with
/// ∫ φ² from its closed form, ¼ (φ² − 2φ′φ‴ + φ″²) + ¾ (φφ‴) − ¼ φ′φ″ at the tip, derivatives by βξ (φ⁗ = φ by parts).
TEST_P(ClampedLoaded, agrees_with_multiprecision_to_1e12_for_200_modes) {
  const Tip& t = GetParam();
  const auto fam = loaded(t);
  const auto f = fam->functions(bending_beam(), 200);
  for (const int k : sampled_modes) {
    const double b = fam->functions(bending_beam(), static_cast<std::size_t>(k))->wave_number();
    Exact beta = b, before = b * (1 + 1e-9);
    Exact f1 = determinant(t, before);
    for (int i = 0; i < 12; ++i) {
      const Exact f0 = determinant(t, beta);
      if (abs(beta - before) < Exact(1e-50)) break;  // what cosh β leaves of 330 digits
      const Exact next = beta - f0 * (beta - before) / (f0 - f1);
      before = beta;
      f1 = f0;
      beta = next;
    }
    // As exact as the double nearest to it allows, but for the roots that the load drives towards each other or zero.
    EXPECT_NEAR(b, static_cast<double>(beta), 4e-16 * b + 1e-15) << "mode " << k;
    const TipResiduals r = residuals(t, beta);
    const Exact sigma = r.force[0] / r.force[1];
    const auto derivative = [&](const Krylov& x, std::size_t d) { return Exact(x.u[d] - sigma * x.v[d]); };
    const Krylov tip(beta);
    const Exact p0 = derivative(tip, 0), p1 = derivative(tip, 1), p2 = derivative(tip, 2), p3 = derivative(tip, 3);
    const Exact norm = (p0 * p0 - 2 * p1 * p3 + p2 * p2 + (3 * p0 * p3 - p1 * p2) / beta) / 4;
    const Exact scale = 1 / sqrt(norm);
    for (const double xi : sampled_places) {
      const FunctionValues v(*f, xi);
      const auto i = static_cast<std::size_t>(k - 1);
      const Krylov x(beta * xi);
      const auto close = [&](double got, std::size_t d) {
        const double power = std::pow(b, static_cast<double>(d));
        const double exact = static_cast<double>(scale * derivative(x, d)) * power;
        // Relative to waves of amplitude √2; a slow wave's curvature is that of the static line, of size one.
        EXPECT_NEAR(got, exact, 1e-12 * std::max(1.0, power)) << "mode " << k << " at " << xi << " derivative " << d;
      };
      close(v.phi[i], 0);
      close(v.slope[i], 1);
      close(v.curvature[i], 2);
      // What a heavy body leaves of the tip's motion is right to its own last digits.
      if (xi == 1 && t.offset == 0) {
        EXPECT_NEAR(v.phi[i] / static_cast<double>(scale * p0), 1, 1e-12) << "mode " << k;
        EXPECT_NEAR(v.slope[i] / (b * static_cast<double>(scale * p1)), 1, 1e-12) << "mode " << k;
      }
    }
  }
}

/// Orthogonal with the tip body's mass, ∫ φ² = L; the modes number all roots: each lies between those of the beam with
/// a held tip two before it and the bare beam's (Rayleigh's theorem on constraints), an interval that has no other.
TEST_P(ClampedLoaded, is_orthogonal_in_the_loaded_mass_and_misses_no_mode) {
  const Tip& t = GetParam();
  const auto fam = loaded(t);
  const auto f = fam->functions(bending_beam(), 200);
  Eigen::MatrixXd G = gram(*f, 1.0);
  EXPECT_LT((G.diagonal() - Eigen::VectorXd::Ones(200)).cwiseAbs().maxCoeff(), 1e-12);
  const FunctionValues tip(*f, 1.0);
  const Eigen::Map<const Eigen::VectorXd> phi(tip.phi.data(), 200), slope(tip.slope.data(), 200);
  const Eigen::VectorXd center = phi + t.offset * slope;
  G += t.mass * center * center.transpose() + t.inertia * slope * slope.transpose();
  const Eigen::VectorXd size = G.diagonal().cwiseSqrt();
  G = size.cwiseInverse().asDiagonal() * G * size.cwiseInverse().asDiagonal();
  // Whatever the load; but that the sum above for a centre of mass that hardly moves loses roundings of its terms.
  const double sum = 4 * 0x1p-52 * std::sqrt(t.mass) * std::abs(t.offset) * slope.cwiseAbs().maxCoeff();
  EXPECT_LT((G - Eigen::MatrixXd::Identity(200, 200)).cwiseAbs().maxCoeff(), 1e-12 + sum);

  const auto bare = family("clamped-free");
  const auto held = family("clamped-clamped");
  const auto beta = [](const ModeFamily& m, std::size_t k) { return m.functions(bending_beam(), k)->wave_number(); };
  double last = 0;
  for (std::size_t k = 1; k <= 60; ++k) {
    const double b = beta(*fam, k);
    EXPECT_GT(b, last);
    EXPECT_LE(b, beta(*bare, k) * (1 + 1e-15));
    if (k > 2) {
      EXPECT_GE(b, beta(*held, k - 2) * (1 - 1e-15));
    }
    last = b;
  }
}

TEST_P(ClampedLoaded, is_clamped_exactly) {
  const FunctionValues root(*loaded(GetParam())->functions(bending_beam(0.7), 200), 0);
  for (std::size_t i = 0; i < 200; ++i) {
    EXPECT_EQ(root.phi[i], 0);
    EXPECT_EQ(root.slope[i], 0);
  }
}

/// β tan β = ρI_p L/J, and orthogonality with the tip's inertia.
TEST_P(ClampedLoaded, turns_with_the_tip_s_inertia_in_torsion) {
  const double J = GetParam().inertia;
  const auto f = loaded(GetParam())->functions(torsion_rod(), 200);
  Eigen::MatrixXd G = gram(*f, 1.0);
  const FunctionValues tip(*f, 1.0);
  const Eigen::Map<const Eigen::VectorXd> phi(tip.phi.data(), 200), slope(tip.slope.data(), 200);
  G += J * phi * phi.transpose();
  const Eigen::VectorXd size = G.diagonal().cwiseSqrt();
  G = size.cwiseInverse().asDiagonal() * G * size.cwiseInverse().asDiagonal();
  EXPECT_LT((G - Eigen::MatrixXd::Identity(200, 200)).cwiseAbs().maxCoeff(), 1e-12);
  for (int k = 1; k <= 200; ++k) {
    const double b = loaded(GetParam())->functions(torsion_rod(), static_cast<std::size_t>(k))->wave_number();
    EXPECT_NEAR(std::cos(b) - J * b * std::sin(b), 0, 1.2e-13 * (1 + J * b));  // one rounding of b ≤ 629
    EXPECT_GT(b, (k - 1) * 3.141592653589793);
    EXPECT_LE(b, (k - 0.5) * 3.141592653589793 * (1 + 1e-15));
  }
}

INSTANTIATE_TEST_SUITE_P(Tips, ClampedLoaded, testing::ValuesIn(tips), [](const auto& i) { return i.param.name; });

/// With a tip mass alone the characteristic equation is 1 + cosh β cos β = μβ (cosh β sin β − sinh β cos β).
TEST(ClampedLoadedTextbook, first_roots_with_a_tip_mass) {
  const Exact one = 1;
  for (const double mass : {1.0, 10.0}) {
    const double b = loaded({"", mass, 0, 0})->functions(bending_beam(), 1)->wave_number();
    const Exact x = b;
    const Exact residual = one + cosh(x) * cos(x) - mass * x * (cosh(x) * sin(x) - sinh(x) * cos(x));
    EXPECT_NEAR(static_cast<double>(residual), 0, 1e-14);
  }
}

TEST(ClampedLoadedOptions, without_a_load_at_the_tip_are_refused) {
  Registry registry;
  enroll_static_plugins(registry);
  Diagnostics diagnostics;
  EXPECT_EQ(make_plugin<ModeFamily>(registry, "clamped-loaded", {}, diagnostics), nullptr);
  ASSERT_EQ(diagnostics.errors().size(), 1U);
  EXPECT_NE(diagnostics.errors()[0].message.find("need tip_mass, tip_inertia or both"), std::string::npos);
}

TEST(CraigBampton, conforms_in_bending_and_torsion) {
  expect_family_conforms(*family("craig-bampton"), bending_beam(1.7));
  expect_family_conforms(*family("craig-bampton"), torsion_rod(1.7));
}

/// The first two coordinates are the tip's deflection and slope times length; the others leave the tip where it is, and
/// no static mode has energy in common with them (they are static: ∫ φ_s″ φ_k″ = 0).
TEST(CraigBampton, coordinates_are_the_tip_s_and_static_modes_are_static) {
  const double length = 1.7;
  const auto f = family("craig-bampton")->functions(bending_beam(length), 200);
  const FunctionValues root(*f, 0), tip(*f, length);
  for (std::size_t i = 0; i < 200; ++i) {
    EXPECT_EQ(root.phi[i], 0);
    EXPECT_EQ(root.slope[i], 0);
    EXPECT_NEAR(tip.phi[i], i == 0 ? 1 : 0, 1e-14);
    EXPECT_NEAR(tip.slope[i] * length, i == 1 ? 1 : 0, 1e-14);
  }
  const Eigen::MatrixXd K = gram(*f, length, &FunctionValues::curvature);
  for (Eigen::Index k = 2; k < 200; ++k) {
    EXPECT_LT(std::abs(K(0, k)), 1e-12 * std::sqrt(K(0, 0) * K(k, k)));
    EXPECT_LT(std::abs(K(1, k)), 1e-12 * std::sqrt(K(1, 1) * K(k, k)));
  }
  const auto t = family("craig-bampton")->functions(torsion_rod(length), 200);
  const FunctionValues twist(*t, length);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_NEAR(twist.phi[i], i == 0 ? 1 : 0, 1e-12);
}

TEST(OrthogonalPolynomials, conform_in_bending_and_torsion) {
  expect_family_conforms(*family("orthogonal-polynomials"), bending_beam(1.7));
  expect_family_conforms(*family("orthogonal-polynomials"), torsion_rod(1.7));
}

/// P_n^(0,b)(t) by its explicit sum about t = 1 in 330 digits (Abramowitz & Stegun 22.3.1, 22.5.42):
/// Σ_k C(n,k) C(n+b+k,k) (−1)^k (1−ξ)^k, with derivatives by ξ.
std::array<Exact, 3> shifted_jacobi(int n, int b, const Exact& xi) {
  std::array<Exact, 3> sum{0, 0, 0};
  const Exact z = 1 - xi;
  Exact c = 1;
  for (int k = 0; k <= n; ++k) {
    const auto power = [&](int p) { return p < 0 ? Exact(0) : Exact(pow(z, p)); };
    sum[0] += c * power(k);
    sum[1] -= c * k * power(k - 1);
    sum[2] += c * k * (k - 1) * power(k - 2);
    c *= -Exact(n - k) * (n + b + k + 1) / (Exact(k + 1) * (k + 1));
  }
  return sum;
}

/// In units of the largest value, which is the tip's (as is that of the slope and of the curvature).
TEST(OrthogonalPolynomials, agree_with_multiprecision_to_1e12_as_many_as_there_are) {
  const auto fam = family("orthogonal-polynomials");
  for (const bool torsion : {false, true}) {
    const int m = torsion ? 1 : 2;
    const auto f = fam->functions(torsion ? torsion_rod() : bending_beam(), fam->most());
    const FunctionValues tip(*f, 1.0);
    for (std::size_t i = 0; i < f->count(); ++i) {
      const int n = static_cast<int>(i);
      const double c = torsion ? 1 : std::sqrt(2.0 * n + 5);
      for (const double xi : sampled_places) {
        const FunctionValues v(*f, xi);
        const auto [p, p1, p2] = shifted_jacobi(n, 2 * m, xi);
        const Exact x = xi;
        const Exact w = torsion ? x : Exact(x * x), w1 = torsion ? Exact(1) : Exact(2 * x), w2 = torsion ? 0 : 2;
        EXPECT_NEAR(v.phi[i], c * static_cast<double>(w * p), 1e-12 * tip.phi[i]) << n << " at " << xi;
        EXPECT_NEAR(v.slope[i], c * static_cast<double>(w1 * p + w * p1), 1e-12 * tip.slope[i]) << n << " at " << xi;
        EXPECT_NEAR(v.curvature[i], c * static_cast<double>(w2 * p + 2 * w1 * p1 + w * p2),
                    1e-12 * std::max(1.0, tip.curvature[i]))
            << n << " at " << xi;
      }
    }
  }
}

TEST(OrthogonalPolynomials, are_clamped_and_orthonormal_as_many_as_there_are) {
  const auto fam = family("orthogonal-polynomials");
  const auto f = fam->functions(bending_beam(), fam->most());
  const auto n = static_cast<Eigen::Index>(fam->most());
  // With the panels that a beam chooses by the wave number.
  const Eigen::MatrixXd G = gram(*f, 1.0, &FunctionValues::phi, 2.5);
  EXPECT_LT((G - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-12);
  const FunctionValues root(*f, 0);
  for (std::size_t i = 0; i < f->count(); ++i) {
    EXPECT_EQ(root.phi[i], 0);
    EXPECT_EQ(root.slope[i], 0);
  }
}

}  // namespace
}  // namespace withy::test
