/// \file
/// A blade spun up to a hundred times its fundamental frequency, and columns that fall.
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>

#include "campaign.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/analysis/column.hpp"
#include "withy/tests/bodies/family_fixture.hpp"

namespace withy::extremes {
namespace {

constexpr int mode_count = 4;
const double omega1 = 1.8751040687119611664 * 1.8751040687119611664;

/// Squared frequencies of the spun cantilever in its own clamped-free modes, from the beam's equation and nothing of
/// the engine's but φ: K + Ω² (S − M) in lag and K + Ω² S in flap, S_ij = ∫ ½(1 − x²) φᵢ′ φⱼ′ dx.
Eigen::VectorXd stiffened(double spin, bool lag, bool stiffening) {
  const auto f = test::family("clamped-free")->functions(test::bending_beam(), mode_count);
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(mode_count, mode_count), K = S;
  using Gauss = boost::math::quadrature::gauss<double, 20>;
  for (int panel = 0; panel < 8; ++panel) {
    for (std::size_t k = 0; k < 10; ++k) {
      for (const double side : {-1.0, 1.0}) {
        const double x = (panel + 0.5 * (1 + side * Gauss::abscissa()[k])) / 8;
        const double w = 0.5 * Gauss::weights()[k] / 8;
        const test::FunctionValues v(*f, x);
        const Eigen::Map<const Eigen::VectorXd> slope(v.slope.data(), mode_count),
            curvature(v.curvature.data(), mode_count);
        S += w * 0.5 * (1 - x * x) * slope * slope.transpose();
        K += w * curvature * curvature.transpose();
      }
    }
  }
  Eigen::MatrixXd total = K;
  if (stiffening) total += spin * spin * S;
  if (lag) total -= spin * spin * Eigen::MatrixXd::Identity(mode_count, mode_count);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(total, Eigen::EigenvaluesOnly).eigenvalues();
}

/// Greatest error of √|λ| over all modes of a group.
double worst_error(const test::AnalysedScene& c, const std::vector<Mode>& modes_found, const std::string& group,
                   const Eigen::VectorXd& expected) {
  const std::vector<Mode> of = test::of_group(c, modes_found, group);
  if (of.size() != static_cast<std::size_t>(expected.size())) return std::numeric_limits<double>::quiet_NaN();
  double worst = 0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    const double square = of[i].squared_frequency(), exact = expected[static_cast<Eigen::Index>(i)];
    if (square * exact < 0) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, std::abs(std::sqrt(square / exact) - 1));
  }
  return worst;
}

}  // namespace

void spin(Campaign& campaign) {
  for (const std::string& formulation : formulations) {
    const bool stiffens = formulation == "consistent" || formulation == "quadratic" || formulation == "exact";
    double lag = 0, flap = 0, growth = 0;
    const std::vector<double> ratios = campaign.quick()
                                           ? std::vector<double>{0, 1, 100}
                                           : std::vector<double>{0, 0.1, 0.5, 0.9, 1, 1.1, 2, 5, 10, 30, 100};
    for (const double ratio : ratios) {
      test::AnalysedScene c(test::blade(mode_count, mode_count), formulation);
      const double omega = ratio * omega1;
      c.spin("axle", omega);
      const std::vector<Mode> found = test::steady_modes(c, {"axle"});
      const bool ruthless = formulation == "ruthless";
      const Eigen::VectorXd in_plane = stiffened(ruthless ? 0 : omega, true, stiffens);
      // Ω = ω₁ without stiffening: λ = 0, of which no relative error can be asked.
      if (std::abs(in_plane[0]) > 1e-6 * omega1 * omega1)
        lag = std::max(lag, worst_error(c, found, "bending_y", in_plane));
      flap = std::max(flap, worst_error(c, found, "bending_z", stiffened(ruthless ? 0 : omega, false, stiffens)));
      if (in_plane[0] < 0 && ratio > 1) {
        const std::vector<Mode> of = test::of_group(c, found, "bending_y");
        growth = std::max(growth, std::abs(of.front().growth() / std::sqrt(-in_plane[0]) - 1));
      }
    }
    const char* oracle = stiffens ? "K + Ω²(S − M), K + Ω²S" : formulation == "ruthless" ? "ω₁" : "ω² − Ω², ω²";
    campaign.at_most(formulation + ", lag frequencies, Ω to 100 ω₁", oracle, lag, 1e-4);
    campaign.at_most(formulation + ", flap frequencies, Ω to 100 ω₁", oracle, flap, 1e-4);
    if (!stiffens && formulation != "ruthless")
      campaign.at_most(formulation + ", growth past ω₁", "√(Ω² − ω₁²)", growth, 1e-3);
  }
  // Figures of the literature: at Ω = ω₁ the first flap and lag frequencies.
  test::AnalysedScene c(test::blade(8, 8), "quadratic");
  c.spin("axle", omega1);
  const std::vector<Mode> found = test::steady_modes(c, {"axle"});
  const double lag = test::of_group(c, found, "bending_y").front().squared_frequency() / (omega1 * omega1);
  const double flap = test::of_group(c, found, "bending_z").front().squared_frequency() / (omega1 * omega1);
  campaign.row("Southwell's coefficient at small Ω and the ratio at Ω = ω₁", "1.1802 in lag; flap 1 more",
               "within 1e-3", fmt::format("lag {:.4f}, flap {:.4f}", lag, flap),
               std::abs(lag - 1.1802) < 1e-3 && std::abs(flap - lag - 1) < 1e-9);
}

void buckling(Campaign& campaign) {
  constexpr double greenhill = 7.837347;
  const double euler = std::numbers::pi * std::numbers::pi / 4;
  for (const std::string formulation : {"consistent", "quadratic", "exact"}) {
    if (campaign.quick() && formulation != "quadratic") continue;
    const double weight =
        test::critical_load([](double x) { return test::column(x, 8, 1, 0); }, formulation, 5, 10) / greenhill - 1;
    campaign.row(formulation + ", own weight, 8 modes", "7.837347 (Greenhill 1881)", "above it by at most 1e-4",
                 fmt::format("{:+.2g}", weight), weight > -1e-7 && weight < 1e-4);
    const double tip =
        test::critical_load([](double x) { return test::column(x, 8, 1e-9, 1); }, formulation, 2, 3) / euler - 1;
    campaign.row(formulation + ", tip load, 8 modes", "π²/4 (Euler)", "above it by at most 2e-4",
                 fmt::format("{:+.2g}", tip), tip > 0 && tip < 2e-4);
  }
  std::string falls;
  for (const std::string formulation : {"ruthless", "inconsistent", "linear"})
    if (test::critical_load([](double x) { return test::column(x, 4, 1, 0); }, formulation, 1, 1000) != 0)
      falls += formulation + " ";
  campaign.holds("linear kinematics", "no term of the second order", "never falls", falls);
  // Past the critical load by 10 % and by 100 times: the run ends, and says how.
  for (const double load : {1.1 * greenhill, 100 * greenhill}) {
    for (const std::string formulation : {"consistent", "quadratic", "exact"}) {
      if (campaign.quick() && (formulation == "exact" || load > 100)) continue;
      const Made made(test::column(load, 4, 1, 0) + "initial: {bodies: {mast: {modes: [1e-3, 0, 0, 0]}}}\n",
                      formulation, {"time.end=20"});
      RunOptions options;
      options.end = 20;
      options.most_seconds = 20;
      const RunSummary s =
          simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options, {});
      const bool finite = std::all_of(s.final.y.begin(), s.final.y.end(), [](double y) { return std::isfinite(y); });
      campaign.row(fmt::format("{} run at {:.3g} × the critical weight", formulation, load / greenhill),
                   "no equilibrium at rest", "ends typed, all finite",
                   fmt::format("{} at {:.3g} s, deflection {:.2g} L", name(s.status), s.final.time,
                               s.peak_deflection_ratio.at("mast")),
                   finite && s.status != RunStatus::interrupted);
    }
  }
}

}  // namespace withy::extremes
