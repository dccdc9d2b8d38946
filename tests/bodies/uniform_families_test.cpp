/// \file
/// Eigenfunctions of the uniform beam against their textbook forms in multiple precision.
#include <algorithm>
#include <cmath>

#include "family_fixture.hpp"
#include "textbook_waves.hpp"

namespace withy::test {
namespace {

class UniformFamilies : public testing::TestWithParam<Uniform> {};

TEST_P(UniformFamilies, conform) {
  const auto f = family(GetParam().id);
  expect_family_conforms(*f, bending_beam(1.7));
  if (GetParam().torsion) {
    expect_family_conforms(*f, torsion_rod(1.7));
  } else {
    EXPECT_EQ(f->functions(torsion_rod(), 2), nullptr);
  }
}

TEST_P(UniformFamilies, wave_numbers_are_those_of_the_textbook) {
  const auto f = family(GetParam().id);
  for (std::size_t k = 1; k <= 3; ++k) {
    EXPECT_NEAR(f->functions(bending_beam(0.8), k)->wave_number() * 0.8, GetParam().blevins[k - 1], 6e-8);
  }
}

/// The rounding of β ξ ≈ 629 alone is 6e-14 of the phase; slopes and curvatures in units of β and β².
TEST_P(UniformFamilies, agree_with_multiprecision_to_1e12_for_200_modes) {
  const Uniform& u = GetParam();
  const auto f = family(u.id)->functions(bending_beam(), 200);
  for (const int k : sampled_modes) {
    const Exact beta = textbook_root(u, k);
    const Textbook c = u.form(beta);
    const double b = static_cast<double>(beta);
    for (const double xi : sampled_places) {
      const FunctionValues v(*f, xi);
      const auto i = static_cast<std::size_t>(k - 1);
      const auto [phi, slope, curvature] = textbook_values(c, beta * xi);
      EXPECT_NEAR(v.phi[i], phi, 1e-12) << "mode " << k << " at " << xi;
      EXPECT_NEAR(v.slope[i] / b, slope, 1e-12) << "mode " << k << " at " << xi;
      EXPECT_NEAR(v.curvature[i] / (b * b), curvature, 1e-12) << "mode " << k << " at " << xi;
    }
  }
}

/// Exactly, at both ends: a root that moves by rounding would be taken for one that moves.
TEST_P(UniformFamilies, ends_hold_exactly_what_their_name_says) {
  const double length = 0.9;
  const auto f = family(GetParam().id)->functions(bending_beam(length), 200);
  for (const auto& [x, held] : {std::pair(0.0, GetParam().root), std::pair(length, GetParam().tip)}) {
    const FunctionValues v(*f, x);
    for (std::size_t i = 0; i < 200; ++i) {
      EXPECT_EQ(v.phi[i] == 0, held[0]) << "mode " << i + 1 << " at " << x;
      EXPECT_EQ(v.slope[i] == 0, held[1]) << "mode " << i + 1 << " at " << x;
      EXPECT_EQ(v.curvature[i] == 0, held[2]) << "mode " << i + 1 << " at " << x;
    }
  }
}

/// The conditions set exactly at the ends are the limits of the functions: none jumps there.
TEST_P(UniformFamilies, are_continuous_at_their_ends) {
  const auto f = family(GetParam().id)->functions(bending_beam(), 200);
  for (const double end : {0.0, 1.0}) {
    const double h = end == 0 ? 1e-15 : -1e-15;
    const FunctionValues at(*f, end), beside(*f, end + h);
    for (std::size_t i = 0; i < 200; ++i) {
      const double b = (static_cast<double>(i) + 1.5) * 3.141592653589793;
      EXPECT_NEAR(at.phi[i], beside.phi[i], 4e-15 * b);
      EXPECT_NEAR(at.slope[i], beside.slope[i], 4e-15 * b * b);
      EXPECT_NEAR(at.curvature[i], beside.curvature[i], 4e-15 * b * b * b);
    }
  }
}

TEST_P(UniformFamilies, are_orthonormal_to_1e12_for_200_modes) {
  const auto f = family(GetParam().id)->functions(bending_beam(), 200);
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(200, 200);
  EXPECT_LT((gram(*f, 1.0) - I).cwiseAbs().maxCoeff(), 1e-12);
  if (!GetParam().torsion) return;
  const auto t = family(GetParam().id)->functions(torsion_rod(), 200);
  EXPECT_LT((gram(*t, 1.0) - 0.5 * I).cwiseAbs().maxCoeff(), 1e-12);  // ∫ sin² = ½
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, UniformFamilies, testing::ValuesIn(uniform_families), [](const auto& i) {
  std::string name = i.param.id;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(ClampedFree, ends_at_plus_or_minus_two) {
  const FunctionValues tip(*family("clamped-free")->functions(bending_beam(), 200), 1.0);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_NEAR(tip.phi[i], i % 2 == 0 ? 2 : -2, 1e-12);
}

/// What makes the body frame of elastic modes that of the mean axes: no net momentum or moment of momentum about it.
TEST(ElasticModes, are_orthogonal_to_the_rigid_motions_that_the_hinge_has) {
  const auto moments = [](const ShapeFunctions& f) {
    Eigen::Vector2d worst = Eigen::Vector2d::Zero();
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(f.count()), 2);
    const int panels = 400;
    for (int p = 0; p < panels; ++p) {
      for (std::size_t k = 0; k < 10; ++k) {
        for (const double sign : {-1.0, 1.0}) {
          using Gauss = boost::math::quadrature::gauss<double, 20>;
          const double x = (p + 0.5 * (1 + sign * Gauss::abscissa()[k])) / panels;
          const double w = 0.5 * Gauss::weights()[k] / panels;
          const FunctionValues v(f, x);
          for (std::size_t i = 0; i < f.count(); ++i) {
            m.row(static_cast<Eigen::Index>(i)) += w * v.phi[i] * Eigen::RowVector2d(1, x);
          }
        }
      }
    }
    for (Eigen::Index c = 0; c < 2; ++c) worst[c] = m.col(c).cwiseAbs().maxCoeff();
    return worst;
  };
  const Eigen::Vector2d free = moments(*family("free-free")->functions(bending_beam(), 200));
  EXPECT_LT(free[0], 1e-13);
  EXPECT_LT(free[1], 1e-13);
  EXPECT_LT(moments(*family("pinned-free")->functions(bending_beam(), 200))[1], 1e-13);
  EXPECT_LT(moments(*family("free-free")->functions(torsion_rod(), 200))[0], 1e-13);
}

}  // namespace
}  // namespace withy::test
