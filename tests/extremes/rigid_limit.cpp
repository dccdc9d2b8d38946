/// \file
/// Flexible bodies that become rigid, are rigid, and have no stiffness left.
#include <algorithm>
#include <cmath>

#include "campaign.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::extremes {
namespace {

/// Hinge angles of the slewed arm over time, stiffnesses times `factor`; rigid where that is 0.
std::vector<double> angles(const std::string& formulation, double factor, double end) {
  std::vector<std::string> set = {fmt::format("time.end={}", end),
                                  "integrator={name: rosenbrock-w, rtol: 1e-10, atol: 1e-13}"};
  if (factor > 0) {
    set.push_back(fmt::format("bodies.link1.bending_y.stiffness={:.17g}", 112.106 * factor));
    set.push_back(fmt::format("bodies.link2.bending_y.stiffness={:.17g}", 14.0133 * factor));
  } else {
    set.insert(set.end(), {"bodies.link1.bending_y.modes=0", "bodies.link2.bending_y.modes=0"});
  }
  const Made made(scene_text("two-link-slew"), formulation, set);
  RunOptions options;
  options.end = end;
  options.output = end / 50;
  const Layout& layout = made.layout();
  std::vector<double> x;
  const RunSummary s = simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options,
                                [&](const State& state) {
                                  for (const char* hinge : {"shoulder", "elbow"})
                                    x.push_back(state.y[layout.hinge(hinge)->position]);
                                });
  if (s.status != RunStatus::completed) x.clear();
  return x;
}

/// A chain of six beams of no modes, or of rigid bodies with the mass that beams have: m = ρL, I = mL²/12 about the
/// middle.
std::string six_links(bool beams) {
  std::string bodies, hinges, states;
  for (int i = 0; i < 6; ++i) {
    const double m = 1.25 * 0.5;
    bodies += beams ? fmt::format("  b{}: {{type: beam, length: 0.5, mass_per_length: 1.25}}\n", i)
                    : fmt::format(
                          "  b{}: {{type: rigid, mass: {:.17g}, center_of_mass: [0.25, 0, 0], inertia: [0, {:.17g}, "
                          "{:.17g}, 0, 0, 0], frames: {{tip: {{position: [0.5, 0, 0]}}}}}}\n",
                          i, m, m * (0.5 * 0.5) / 12, m * (0.5 * 0.5) / 12);
    hinges += fmt::format("  h{}: {{type: revolute, axis: [0, {}, {}], parent: {}, child: b{}}}\n", i, i % 2, 1 - i % 2,
                          i == 0 ? "world" : fmt::format("b{}.tip", i - 1), i);
    states += fmt::format("h{}: {{position: [{}], rate: [{}]}}, ", i, 0.1 * (i + 1), 0.3 - 0.1 * i);
  }
  return "format: withy/1\ntime: {end: 1}\ngravity: [0, -9.81, 1]\nbodies:\n" + bodies + "hinges:\n" + hinges +
         "initial: {hinges: {" + states + "}}\n";
}

}  // namespace

void rigid_limit(Campaign& campaign) {
  const double end = campaign.quick() ? 0.2 : 3.8;
  const std::vector<double> rigid = angles("quadratic", 0, end);
  for (const std::string& formulation : formulations) {
    if (formulation == "consistent" || formulation == "inconsistent") continue;  // no linearly implicit solver
    if (campaign.quick() && formulation != "quadratic") continue;
    std::string text;
    double least = 10, most = -10, before = 0;
    const std::vector<double> factors =
        campaign.quick() ? std::vector<double>{1e2, 1e3} : std::vector<double>{1e2, 1e3, 1e4, 1e5};
    for (const double factor : factors) {
      const double d = difference(angles(formulation, factor, end), rigid);
      if (before > 0) {
        const double slope = -std::log10(d / before);
        least = std::min(least, slope);
        most = std::max(most, slope);
      }
      before = d;
      text += fmt::format("{:.2e} ", d);
    }
    campaign.row(formulation + ", slewed arm, EI × 1e2, 1e3, …: difference to rigid", "∝ 1/EI",
                 "exponent −1 ± 0.1 a decade", fmt::format("{}, exponents −{:.3f} to −{:.3f}", text, least, most),
                 std::abs(least - 1) <= 0.1 && std::abs(most - 1) <= 0.1);
  }
  const Made beams(six_links(true), "quadratic"), bodies(six_links(false), "quadratic");
  const auto a = beams.accelerations(), b = bodies.accelerations();
  campaign.row("six beams of no modes against six rigid bodies", "the same numbers", "bitwise",
               a == b ? "bitwise" : fmt::format("{:.2g}", difference(a, b)), a == b);
  for (const std::string& formulation : formulations) {
    if (campaign.quick() && formulation == "exact") continue;
    const Made made(scene_text("two-link-slew"), formulation,
                    {"bodies.link1.bending_y.stiffness=1e-9", "bodies.link2.bending_y.stiffness=1e-9"});
    RunOptions options;
    options.end = 3.8;
    options.most_seconds = 30;
    bool finite = true;
    const RunSummary s = simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options,
                                  [&](const State& state) {
                                    for (const double y : state.y) finite = finite && std::isfinite(y);
                                  });
    campaign.row(formulation + ", slewed arm without stiffness (1e-9)", "a string cannot pass on the torque",
                 "ends typed, all finite", fmt::format("{} at {:.3g} s", name(s.status), s.final.time),
                 finite && s.status != RunStatus::completed && s.status != RunStatus::interrupted);
  }
}

}  // namespace withy::extremes
