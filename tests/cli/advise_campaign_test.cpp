// The promise of `withy advise`: what it picks holds the accuracy, and nothing among its candidates that does is much
// cheaper. Random scenes, a truth of their own, and an exhaustive search over the same candidates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>

#include "withy/apps/withy/advice.hpp"
#include "withy/tests/cli/campaign.hpp"
#include "withy/tests/cli/random_machine.hpp"

namespace withy::test {
namespace {

using namespace withy::app;

struct Verdict {
  bool advised = false;
  std::string trouble;
  double use = 0;         ///< of the accuracy, against the truth
  double cost_ratio = 0;  ///< to the cheapest that passes, by evaluations and their unit costs
  double cpu_ratio = 0;   ///< the same by CPU time, the least of five runs each
  double own_use = 0;     ///< what the advisor knew its reference to
  double probing = 0;     ///< CPU time of the advisor over that of the run advised
  std::string choice, cheapest;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Verdict, advised, trouble, use, cost_ratio, cpu_ratio, own_use, probing, choice,
                                   cheapest)

double least_seconds(const Engine& engine, const ProbedModel& model, const TradePoint& point) {
  double least = 1e300;
  for (int i = 0; i < 5; ++i)
    least = std::min(least,
                     walk(model, *integrator_at(engine.registry(), point), [](const State&) { return true; }).seconds);
  return least;
}

/// Two modes and two digits more than the advisor's own reference.
Reference truth_of(const Engine& engine, Advisor& advisor) {
  Reference truth = *advisor.reference();
  truth.point.modes += 2;
  truth.point.tolerance *= 1e-2;
  truth.own = {};
  const std::size_t outputs = truth.values.size();
  truth.values.clear();
  const ProbedModel& model = advisor.model_of(truth.point);
  EXPECT_FALSE(model.refused()) << model.refusal;
  const Walk w = walk(model, *integrator_at(engine.registry(), truth.point), [&](const State& s) {
    truth.values.emplace_back();
    advisor.outputs().read(*model.scene.model, *model.equations, s.y, truth.values.back());
    return true;
  });
  EXPECT_EQ(w.end, Walk::End::reached) << w.reason;
  EXPECT_EQ(truth.values.size(), outputs);
  return truth;
}

Verdict judge(const AdviseArguments& arguments) {
  const Engine engine(arguments);
  Advisor advisor(engine, arguments);
  Verdict v;
  if (!advisor.search()) {
    v.trouble = advisor.trouble().empty() ? "no candidate holds the accuracy" : advisor.trouble();
    return v;
  }
  v.advised = true;
  const Probe choice = *advisor.choice();
  EXPECT_NE(choice.point.formulation, "inconsistent");
  v.choice = choice.point.text() + " for " + arguments.accuracy;
  v.own_use = advisor.reference()->own_use();
  v.probing = advisor.spent() / advisor.cost(choice);
  const Reference truth = truth_of(engine, advisor);
  const auto run = [&](const TradePoint& point, double most_use, double most_seconds) {
    return probe(engine, advisor.model_of(point), point, advisor.outputs(), truth, most_use, most_seconds);
  };
  v.use = run(choice.point, 1e300, 1e300).use;

  // Every candidate, cut where it fails or costs more than the cheapest so far. Unit costs are the least seen.
  std::map<std::string, double> units;
  const auto unit = [&](const Probe& p) {
    const std::string key = p.point.formulation + p.point.family + std::to_string(p.point.modes) + p.point.integrator;
    const double seen = p.walk.seconds / static_cast<double>(p.walk.evaluations);
    double& least = units.try_emplace(key, seen).first->second;
    least = std::min(least, seen);
    return least;
  };
  const Candidates& all = advisor.candidates();
  std::vector<Probe> passed{run(choice.point, 1e300, 1e300)};
  double best = passed.front().walk.seconds;
  for (const auto& formulation : all.formulations) {
    for (const auto& family : all.families) {
      for (const int modes : all.modes) {
        for (const auto& integrator : all.integrators) {
          for (const double tolerance : all.tolerances) {
            const Probe p = run({formulation, family, modes, integrator, tolerance, {}}, 1, 1.5 * best);
            if (p.walk.evaluations > 0) static_cast<void>(unit(p));
            if (!p.passed()) continue;
            best = std::min(best, p.walk.seconds);
            passed.push_back(p);
          }
        }
      }
    }
  }
  const auto cost = [&](const Probe& p) { return unit(p) * static_cast<double>(p.walk.evaluations); };
  const Probe* cheapest = &passed.front();
  // Unit costs of what is near, once more: other work on the machine only adds.
  for (const Probe& p : passed)
    if (cost(p) < 2 * best) static_cast<void>(unit(run(p.point, 1e300, 1e300)));
  for (const Probe& p : passed)
    if (cost(p) < cost(*cheapest)) cheapest = &p;
  v.cost_ratio = cost(passed.front()) / cost(*cheapest);
  v.cheapest = cheapest->point.text();
  v.cpu_ratio = least_seconds(engine, advisor.model_of(choice.point), choice.point) /
                least_seconds(engine, advisor.model_of(cheapest->point), cheapest->point);
  return v;
}

Verdict judge_random(unsigned seed, const std::string& scene) {
  RandomMachine machine(seed);
  AdviseArguments arguments;
  arguments.scene = scene;
  std::ofstream(arguments.scene) << machine.text();
  arguments.accuracy = machine.accuracy();
  return judge(arguments);
}

TEST(AdviseCampaign, what_is_advised_holds_the_accuracy_at_nearly_the_least_cost) {
  const Campaign campaign("advice", 6);
  const std::vector<Verdict> verdicts = campaign.run<Verdict>(judge_random);
  unsigned advised = 0, met = 0, cheap = 0, cheap_cpu = 0;
  double worst_use = 0, worst_ratio = 0;
  std::vector<double> probing;
  for (const Verdict& v : verdicts) {
    if (!v.advised) continue;
    ++advised;
    met += v.use <= 1 ? 1 : 0;
    cheap += v.cost_ratio <= 1.5 ? 1 : 0;
    cheap_cpu += v.cpu_ratio <= 1.5 ? 1 : 0;
    worst_use = std::max(worst_use, v.use);
    worst_ratio = std::max(worst_ratio, v.cost_ratio);
    probing.push_back(v.probing);
  }
  ASSERT_GT(advised, 0U);
  std::sort(probing.begin(), probing.end());
  std::printf(
      "advised %u of %u; accuracy met in %u, worst use %.3f; cost at most 1.5 of the cheapest in %u (by CPU time %u), "
      "worst %.2f; probing costs %.0f runs in the median\n",
      advised, campaign.seeds(), met, worst_use, cheap, cheap_cpu, worst_ratio, probing[probing.size() / 2]);
  EXPECT_GE(advised, 0.9 * campaign.seeds());
  EXPECT_GE(met, 0.99 * advised);
  EXPECT_GE(cheap, (campaign.seeds() >= 50 ? 0.9 : 0.5) * advised) << "of few scenes, one in ten may be two";
}

TEST(AdviseCampaign, what_is_advised_for_a_shipped_scene_holds_the_accuracy) {
  const std::vector<std::string> scenes = {"screw",
                                           "two-link-slew",
                                           "extended-slew",
                                           "driven-arm",
                                           "spin-up",
                                           "gallery/flexible-pendulum",
                                           "gallery/manipulator",
                                           "least-time-slew",
                                           "gallery/spinning-beam",
                                           "gallery/spinning-plate",
                                           "solar-panel",
                                           "spacecraft",
                                           "gallery/long-chain",
                                           "gallery/wind-turbine-blade"};
  const Campaign campaign("shipped", 1, static_cast<unsigned>(scenes.size()));
  const auto verdicts = campaign.run<Verdict>([&](unsigned number, const std::string&) {
    AdviseArguments arguments;
    arguments.scene = std::string(WITHY_SOURCES) + "/scenes/" + scenes[number - 1] + ".yaml";
    return judge(arguments);
  });
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const Verdict& v = verdicts[i];
    std::printf("%s: %s; use %.3f, cost ratio %.2f (by CPU time %.2f)\n", scenes[i].c_str(),
                v.advised ? v.choice.c_str() : v.trouble.c_str(), v.use, v.cost_ratio, v.cpu_ratio);
    EXPECT_LE(v.use, 1) << scenes[i];
  }
}

}  // namespace
}  // namespace withy::test
