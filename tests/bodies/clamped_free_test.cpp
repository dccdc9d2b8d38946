#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/tests/conformance/mode_family_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

/// cosh and sinh of β = 627 lose 273 digits to cancellation; 330 leave more than fifty.
using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<330>>;

/// The textbook form cosh βξ − cos βξ − σ(sinh βξ − sin βξ), σ = (cosh β + cos β)/(sinh β + sin β) (Blevins 1979, table
/// 8-1), with enough digits to be right; β by Newton's iteration on cosh β cos β + 1.
Exact textbook(int k, const Exact& xi) {
  Exact beta = (Exact(k) - Exact(0.5)) * boost::math::constants::pi<Exact>();
  for (int i = 0; i < 12; ++i) {
    const Exact f = cos(beta) + 1 / cosh(beta);
    beta -= f / (-sin(beta) - sinh(beta) / (cosh(beta) * cosh(beta)));
  }
  const Exact sigma = (cosh(beta) + cos(beta)) / (sinh(beta) + sin(beta));
  return cosh(beta * xi) - cos(beta * xi) - sigma * (sinh(beta * xi) - sin(beta * xi));
}

std::unique_ptr<ModeFamily> clamped_free() {
  Registry registry;
  enroll_static_plugins(registry);
  return make_plugin<ModeFamily>(registry, "clamped-free");
}

TEST(ClampedFree, conforms_in_bending_and_torsion) {
  const auto family = clamped_free();
  expect_family_conforms(*family, {BeamData::Strain::bending, 1.7, 1, 1});
  expect_family_conforms(*family, {BeamData::Strain::torsion, 1.7, 1, 1});
}

TEST(ClampedFree, agrees_with_multiprecision_to_1e12_for_200_modes) {
  const auto f = clamped_free()->functions({BeamData::Strain::bending, 1.0, 1, 1}, 200);
  for (const double xi : {0.0, 0.0078125, 0.3125, 0.5, 0.8125, 1.0}) {
    const FunctionValues v(*f, xi);
    for (const int k : {1, 2, 3, 5, 10, 12, 13, 20, 50, 100, 150, 199, 200}) {
      const double exact = static_cast<double>(textbook(k, Exact(xi)));
      EXPECT_NEAR(v.phi[static_cast<std::size_t>(k - 1)], exact, 1e-12) << "mode " << k << " at " << xi;
    }
  }
}

TEST(ClampedFree, is_clamped_and_free_and_ends_at_plus_or_minus_two) {
  const double length = 0.9;
  const auto f = clamped_free()->functions({BeamData::Strain::bending, length, 1, 1}, 200);
  const FunctionValues root(*f, 0), tip(*f, length);
  for (std::size_t i = 0; i < 200; ++i) {
    const double beta = (static_cast<double>(i) + 0.5) * 3.141592653589793 / length;
    EXPECT_NEAR(root.phi[i], 0, 1e-12);
    EXPECT_NEAR(root.slope[i], 0, 1e-12 * beta);
    EXPECT_NEAR(tip.curvature[i], 0, 1e-12 * beta * beta);
    EXPECT_NEAR(tip.phi[i], i % 2 == 0 ? 2 : -2, 1e-12);
  }
}

TEST(ClampedFree, is_orthonormal_to_1e12_for_200_modes) {
  const auto f = clamped_free()->functions({BeamData::Strain::bending, 1.0, 1, 1}, 200);
  const Eigen::MatrixXd G = gram(*f, 1.0);
  EXPECT_LT((G - Eigen::MatrixXd::Identity(200, 200)).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace withy::test
