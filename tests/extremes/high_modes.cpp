/// \file
/// Modes up to the two hundredth against their textbook forms in 330 digits.
#include <cmath>

#include "campaign.hpp"
#include "withy/tests/bodies/family_fixture.hpp"
#include "withy/tests/bodies/textbook_waves.hpp"

namespace withy::extremes {
namespace {

/// The textbook form of the clamped-free function in double precision: what loses its digits.
double textbook_in_double(double beta, double x) {
  const double s = (std::cosh(beta) + std::cos(beta)) / (std::sinh(beta) + std::sin(beta));
  return std::cosh(beta * x) - std::cos(beta * x) - s * (std::sinh(beta * x) - std::sin(beta * x));
}

void families(Campaign& campaign) {
  for (const test::Uniform& u : test::uniform_families) {
    const auto f = test::family(u.id)->functions(test::bending_beam(), 200);
    double worst = 0;
    for (const int k : test::sampled_modes) {
      if (campaign.quick() && k != 1 && k != 12 && k != 200) continue;
      const test::Exact beta = test::textbook_root(u, k);
      const test::Textbook c = u.form(beta);
      const double b = static_cast<double>(beta);
      for (const double xi : test::sampled_places) {
        const test::FunctionValues v(*f, xi);
        const auto i = static_cast<std::size_t>(k - 1);
        const auto [phi, slope, curvature] = test::textbook_values(c, beta * xi);
        worst = std::max({worst, std::abs(v.phi[i] - phi), std::abs(v.slope[i] / b - slope),
                          std::abs(v.curvature[i] / (b * b) - curvature)});
      }
    }
    campaign.at_most(fmt::format("{}, φ, φ′/β, φ″/β² to mode 200", u.id), "textbook form, 330 digits", worst, 1e-12);
    const Eigen::MatrixXd gram = test::gram(*f, 1.0);
    campaign.at_most(fmt::format("{}, 200 by 200 Gram matrix less 1", u.id), "∫φᵢφⱼ dx = L δᵢⱼ",
                     (gram - Eigen::MatrixXd::Identity(200, 200)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

/// Orthogonal with the load's mass in the product: ∫φᵢφⱼ + μ φᵢ(1) φⱼ(1) = 0.
void loaded(Campaign& campaign) {
  for (const double mass : {1e-3, 1.0, 1e9}) {
    const auto f = test::family("clamped-loaded", {{"tip_mass", Value(mass)}})->functions(test::bending_beam(), 200);
    const Eigen::MatrixXd gram = test::gram(*f, 1.0);
    const test::FunctionValues tip(*f, 1.0);
    const Eigen::Map<const Eigen::VectorXd> at_tip(tip.phi.data(), 200);
    const Eigen::MatrixXd product = gram + mass * at_tip * at_tip.transpose();
    const Eigen::VectorXd own = product.diagonal().cwiseSqrt();
    const Eigen::MatrixXd cosines = own.cwiseInverse().asDiagonal() * product * own.cwiseInverse().asDiagonal();
    const double worst = (cosines - Eigen::MatrixXd::Identity(200, 200)).cwiseAbs().maxCoeff();
    campaign.at_most(
        fmt::format("clamped-loaded, tip mass {:g} × beam, 200 modes, cosines of the loaded product", mass),
        "∫φᵢφⱼ + μφᵢ(L)φⱼ(L) = 0", worst, 1e-12);
  }
}

}  // namespace

void high_modes(Campaign& campaign) {
  const test::Uniform& clamped = test::uniform_families[0];
  const test::Exact beta = test::textbook_root(clamped, 12);
  double lost = 0;
  for (const double x : {0.3, 0.8, 0.9, 1.0}) {
    const double exact = test::textbook_values(clamped.form(beta), beta * x)[0];
    lost = std::max(lost, std::abs(textbook_in_double(static_cast<double>(beta), x) - exact));
  }
  campaign.row("the textbook form in doubles, mode 12", "330 digits", "> 1e-3: the oracle can tell",
               fmt::format("{:.2g}", lost), lost > 1e-3);
  families(campaign);
  loaded(campaign);
}

}  // namespace withy::extremes
