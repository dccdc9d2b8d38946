// The promise of the certificate: the error that it claims against the next model up is within a factor of three of the
// true one. The random scenes of the campaign of `withy advise`, the truth by two runs of their own at 1e-10.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "withy/study/error_estimate.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/run.hpp"
#include "withy/tests/cli/campaign.hpp"
#include "withy/tests/cli/random_machine.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::test {
namespace {

using namespace withy::study;

struct Claim {
  std::string formulation;
  double hinge = 0, tip = 0;                  ///< [rad or m, m]
  double claimed_hinge = 0, claimed_tip = 0;  ///< the same
  bool hinge_at_most = false, tip_at_most = false;
  double until = 0, end = 0;  ///< what the claim is about, and how far the run came [s]
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Claim, formulation, hinge, tip, claimed_hinge, claimed_tip, hinge_at_most,
                                   tip_at_most, until, end)

struct Claims {
  std::vector<Claim> list;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Claims, list)

/// Outputs up to a time, at a tolerance at which a run is the truth of its equations.
std::vector<State> exact_outputs(const Prepared& scene, const EquationsOfMotion& equations, double end) {
  const auto integrator = make_integrator(plugins(), "dop853", 1e-10);
  RunOptions options;
  options.end = end;
  options.output = scene.scene.output;
  options.deflection_limit = 1e3;
  std::vector<State> outputs;
  const RunSummary summary = withy::simulate(scene.model(), equations, *integrator, scene.scene.initial, options,
                                             [&](const State& s) { outputs.push_back(s); });
  return summary.status == RunStatus::completed ? outputs : std::vector<State>();
}

/// Whether the greatest of these is no more than a bound.
bool said_at_most(const ErrorEstimate& e, const std::map<std::string, double>& distances) {
  const auto greatest = std::max_element(distances.begin(), distances.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
  return greatest != distances.end() && e.at_most.count(greatest->first) > 0;
}

/// A run that looks beyond itself, as the estimate asks of it, and makes none.
RunSummary run_of(const Prepared& prepared) {
  RunSettings settings;
  settings.estimate = Estimate::never;
  return run(prepared, plugins(), settings).summary;
}

Claims claims_of(unsigned seed, const std::string& scene) {
  Claims claims;
  std::ofstream(scene) << RandomMachine(seed).text();
  for (const char* formulation : {"ruthless", "linear", "consistent", "quadratic"}) {
    const Prepared prepared =
        prepare(SceneValues::read(scene).choose_formulation(formulation, "the campaign"), plugins());
    const std::optional<Beyond> beyond = next_model_up(prepared, plugins());
    if (!beyond) continue;
    const RunSummary summary = run_of(prepared);
    // What every run has, where a tenth of its cost pays for it; what is to be had at any price else.
    EstimateOutcome outcome =
        estimate_error(prepared.scene, *prepared.equations, *beyond, summary, plugins(), Price::tenth, {});
    if (!outcome.estimate)
      outcome = estimate_error(prepared.scene, *prepared.equations, *beyond, summary, plugins(), Price::any, {});
    if (!outcome.estimate) continue;
    const ErrorEstimate& e = *outcome.estimate;
    if (!(e.distances.until > prepared.scene.initial.time)) continue;
    const std::vector<State> used = exact_outputs(prepared, *prepared.equations, e.distances.until);
    const std::vector<State> up = exact_outputs(prepared, *beyond->equations, e.distances.until);
    if (used.empty() || used.size() != up.size()) continue;  // singular or diverged: no truth
    const Outputs outputs = Outputs::all(prepared.model());
    OutputReader ours(outputs, prepared.model(), *prepared.equations);
    OutputReader theirs(outputs, *beyond->model, *beyond->equations);
    Distances greatest = outputs.none();
    for (std::size_t i = 0; i < used.size(); ++i) outputs.raise(ours.read(used[i]), theirs.read(up[i]), greatest);
    const NamedDistances truth = named(outputs, greatest, e.distances.until);
    claims.list.push_back({formulation, truth.greatest_hinge(), truth.greatest_tip(), e.distances.greatest_hinge(),
                           e.distances.greatest_tip(), said_at_most(e, e.distances.hinges),
                           said_at_most(e, e.distances.tips), e.distances.until, e.end});
  }
  return claims;
}

/// By how much a claim is wrong; 1 where both are too small to be told. What is said to be no more than a number is
/// wrong only where it is more.
double factor(double claimed, double truth, bool at_most) {
  constexpr double resolved = 1e-7;  // rad or m, a thousand tolerances of the truth
  if (claimed < resolved && truth < resolved) return 1;
  return std::max(at_most ? 1 : claimed / truth, truth / claimed);
}
double factor(const Claim& c) {
  return std::max(factor(c.claimed_hinge, c.hinge, c.hinge_at_most), factor(c.claimed_tip, c.tip, c.tip_at_most));
}

TEST(EstimateCampaign, errors_claimed_are_within_a_factor_of_three_of_the_true_ones) {
  const Campaign campaign("estimate", 6);
  const std::vector<Claims> all = campaign.run<Claims>(claims_of);
  unsigned scenes = 0, good_scenes = 0;
  for (const char* formulation : {"ruthless", "linear", "consistent", "quadratic"}) {
    unsigned count = 0, good = 0, whole = 0, bounds = 0;
    double worst = 1;
    for (const Claims& claims : all) {
      for (const Claim& c : claims.list) {
        if (c.formulation != formulation) continue;
        const double wrong = factor(c);
        bounds += c.hinge_at_most || c.tip_at_most ? 1 : 0;
        ++count;
        good += wrong <= 3 ? 1 : 0;
        whole += c.until >= c.end ? 1 : 0;
        worst = std::max(worst, wrong);
      }
    }
    std::printf(
        "%s: within a factor of three in %u of %u, worst factor %.3g; an upper bound in %u; to the end of the run in "
        "%u\n",
        formulation, good, count, worst, bounds, whole);
  }
  for (const Claims& claims : all) {
    scenes += claims.list.empty() ? 0 : 1;
    good_scenes += !claims.list.empty() && std::all_of(claims.list.begin(), claims.list.end(),
                                                       [](const Claim& c) { return factor(c) <= 3; })
                       ? 1
                       : 0;
  }
  std::printf("every claim of a scene within a factor of three: %u of %u scenes\n", good_scenes, scenes);
  EXPECT_GE(scenes, 0.9 * campaign.seeds());
  EXPECT_GE(good_scenes, (campaign.seeds() >= 50 ? 0.95 : 0.8) * scenes) << "of few scenes, one in twenty may be one";
}

}  // namespace
}  // namespace withy::test
