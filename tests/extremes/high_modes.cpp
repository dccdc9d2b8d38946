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
    Eigen::MatrixXd gram = test::gram(*f, 1.0);
    const test::FunctionValues tip(*f, 1.0);
    const Eigen::Map<const Eigen::VectorXd> at_tip(tip.phi.data(), 200);
    // The mass may be a thousand million times the beam's: what is summed is compared with what it is the sum of.
    const Eigen::MatrixXd load = mass * at_tip * at_tip.transpose();
    double worst = 0;
    for (Eigen::Index i = 0; i < 200; ++i)
      for (Eigen::Index j = 0; j < i; ++j)
        worst = std::max(worst, std::abs(gram(i, j) + load(i, j)) / (1 + std::abs(load(i, j))));
    campaign.at_most(fmt::format("clamped-loaded, tip mass {:g} × beam, Gram off-diagonal", mass),
                     "∫φᵢφⱼ + μφᵢ(L)φⱼ(L) = 0", worst, 1e-12);
  }
}

}  // namespace

void high_modes(Campaign& campaign) {
  const double b12 = static_cast<double>(test::textbook_root(test::uniform_families[0], 12));
  const test::Exact e12 = test::textbook_root(test::uniform_families[0], 12);
  const auto exact = test::textbook_values(test::uniform_families[0].form(e12), e12)[0];
  const double lost = std::abs(textbook_in_double(b12, 1) - exact);
  campaign.row("the textbook form in doubles, mode 12 at the tip", "330 digits", "> 1e-3, so that the oracle can tell",
               fmt::format("{:.2g}", lost), lost > 1e-3);
  families(campaign);
  loaded(campaign);
}

}  // namespace withy::extremes
