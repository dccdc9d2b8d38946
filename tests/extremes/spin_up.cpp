/// \file
/// A blade spun up from rest in 15 s, and the rates up to which cruder formulations are right to 1 %.
#include <cmath>

#include "campaign.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/analysis/blade.hpp"

namespace withy::extremes {
namespace {

struct Peak {
  const char* formulation;
  double deflection;  ///< of the tip [m], greatest; 0: it passes 10 m
};

/// First frequency of a group at rate Ω.
double first_frequency(const std::string& formulation, const std::string& group, double rate) {
  test::AnalysedScene c(test::blade(4, 4), formulation);
  c.spin("axle", rate);
  return std::sqrt(test::of_group(c, test::steady_modes(c, {"axle"}), group).front().squared_frequency());
}

}  // namespace

void spin_up(Campaign& campaign) {
  // In plane: ω₁² + 0.193 Ω² truly, against ω₁² (ruthless) and ω₁² − Ω² (inconsistent); flap ω₁² + 1.193 Ω².
  struct Limit {
    const char* formulation;
    const char* group;
    double ratio;
  };
  const double omega1 = std::pow(1.8751040687119611664, 2);
  for (const Limit& limit : {Limit{"ruthless", "bending_y", 0.325},
                             {"inconsistent", "bending_y", 0.129},
                             {"ruthless", "bending_z", 0.130}}) {
    double low = 0.02, high = 0.9;
    for (int i = 0; i < 20; ++i) {
      const double middle = 0.5 * (low + high), rate = middle * omega1;
      const double error =
          first_frequency(limit.formulation, limit.group, rate) / first_frequency("quadratic", limit.group, rate) - 1;
      (std::abs(error) < 0.01 ? low : high) = middle;
    }
    campaign.row(fmt::format("{}, {} frequency 1 % off, at Ω/ω₁", limit.formulation,
                             limit.group == std::string("bending_y") ? "lag" : "flap"),
                 fmt::format("{:.3f}", limit.ratio), "within 1 %", fmt::format("{:.4f}", low),
                 std::abs(low / limit.ratio - 1) < 0.01);
  }
  struct Case {
    std::string length, stiffness, mass, rate;
    std::vector<Peak> peaks;
  };
  std::vector<Case> cases = {{"10",
                              "1.4e4",
                              "1.2",
                              "6",
                              {{"consistent", 0.57437},
                               {"ruthless", 0.62916},
                               {"quadratic", 0.57584},
                               {"exact", 0.57375},
                               {"inconsistent", 0}}}};
  if (!campaign.quick()) {
    cases.push_back({"8",
                     "566.66",
                     "0.20188",
                     "2",
                     {{"consistent", 0.28027},
                      {"inconsistent", 0.34320},
                      {"ruthless", 0.28570},
                      {"quadratic", 0.28049},
                      {"exact", 0.28014}}});
    cases.push_back({"8",
                     "566.66",
                     "0.20188",
                     "4",
                     {{"consistent", 0.53445}, {"ruthless", 0.57140}, {"quadratic", 0.53626}, {"exact", 0.53363}}});
  }
  for (const Case& c : cases) {
    for (const Peak& p : c.peaks) {
      const Made made(scene_text("spin-up"), p.formulation,
                      {"bodies.blade.length=" + c.length, "bodies.blade.bending_y.stiffness=" + c.stiffness,
                       "bodies.blade.mass_per_length=" + c.mass, "motions.spin.rate=" + c.rate});
      RunOptions options;
      options.end = 20;
      options.output = 0.02;
      const RunSummary s =
          simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options, {});
      const std::string title = fmt::format("{} m, {} rad/s in 15 s, {}", c.length, c.rate, p.formulation);
      if (p.deflection > 0) {
        const double peak = s.peak_deflection.at("blade")[1];
        campaign.row(title + ": peak of the tip", fmt::format("{:.5f} m", p.deflection), "within 1e-4",
                     fmt::format("{:.5f} m", peak),
                     s.status == RunStatus::completed && std::abs(peak / p.deflection - 1) <= 1e-4);
      } else {
        campaign.row(title + ": past 10 m", "9.16 s", "diverged, within 0.01 s",
                     fmt::format("{} at {:.3f} s", name(s.status), s.reached),
                     s.status == RunStatus::diverged && std::abs(s.reached - 9.16) <= 0.01);
      }
    }
  }
}

}  // namespace withy::extremes
