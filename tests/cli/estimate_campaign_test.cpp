// The promise of the certificate: the error that it claims against the next model up is within a factor of three of the
// true one. The random scenes of the campaign of `withy advise`, the truth by two runs of their own at 1e-10.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "withy/study/error_estimate.hpp"
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
  double until = 0, end = 0;                  ///< what the claim is about, and how far the run came [s]
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Claim, formulation, hinge, tip, claimed_hinge, claimed_tip, until, end)

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

Claims claims_of(unsigned seed, const std::string& scene) {
  Claims claims;
  std::ofstream(scene) << RandomMachine(seed).text();
  for (const char* formulation : {"ruthless", "linear", "consistent", "quadratic"}) {
    const Prepared prepared =
        prepare(SceneValues::read(scene).choose_formulation(formulation, "the campaign"), plugins());
    const std::optional<Beyond> beyond = next_model_up(prepared, plugins());
    if (!beyond) continue;
    const RunSummary summary = simulate(prepared, plugins(), {});
    const ErrorEstimate e = estimate_error(prepared.scene, *prepared.equations, *beyond, summary, plugins(), {});
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
                           e.distances.greatest_tip(), e.distances.until, e.end});
  }
  return claims;
}

/// By how much a claim is wrong; 1 where both are too small to be told.
double factor(double claimed, double truth) {
  constexpr double resolved = 1e-7;  // rad or m, a thousand tolerances of the truth
  if (claimed < resolved && truth < resolved) return 1;
  return std::max(claimed / truth, truth / claimed);
}

TEST(EstimateCampaign, errors_claimed_are_within_a_factor_of_three_of_the_true_ones) {
  const Campaign campaign("estimate", 6);
  const std::vector<Claims> all = campaign.run<Claims>(claims_of);
  unsigned scenes = 0, good_scenes = 0;
  for (const char* formulation : {"ruthless", "linear", "consistent", "quadratic"}) {
    unsigned count = 0, good = 0, whole = 0;
    double worst = 1;
    for (const Claims& claims : all) {
      for (const Claim& c : claims.list) {
        if (c.formulation != formulation) continue;
        const double wrong = std::max(factor(c.claimed_hinge, c.hinge), factor(c.claimed_tip, c.tip));
        ++count;
        good += wrong <= 3 ? 1 : 0;
        whole += c.until >= c.end ? 1 : 0;
        worst = std::max(worst, wrong);
      }
    }
    std::printf("%s: within a factor of three in %u of %u, worst factor %.3g; to the end of the run in %u\n",
                formulation, good, count, worst, whole);
  }
  for (const Claims& claims : all) {
    scenes += claims.list.empty() ? 0 : 1;
    good_scenes += !claims.list.empty() && std::all_of(claims.list.begin(), claims.list.end(),
                                                       [](const Claim& c) {
                                                         return std::max(factor(c.claimed_hinge, c.hinge),
                                                                         factor(c.claimed_tip, c.tip)) <= 3;
                                                       })
                       ? 1
                       : 0;
  }
  std::printf("every claim of a scene within a factor of three: %u of %u scenes\n", good_scenes, scenes);
  EXPECT_GE(scenes, 0.9 * campaign.seeds());
  EXPECT_GE(good_scenes, (campaign.seeds() >= 50 ? 0.95 : 0.8) * scenes) << "of few scenes, one in twenty may be one";
}

}  // namespace
}  // namespace withy::test
