// The promise of `withy advise`: what it picks holds the accuracy, and nothing among its candidates that does is much
// cheaper. Random scenes, a truth of their own, and an exhaustive search over the same candidates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>

#include "withy/study/advice.hpp"
#include "withy/tests/cli/campaign.hpp"
#include "withy/tests/cli/random_machine.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::test {
namespace {

using namespace withy::study;

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

double least_seconds(Evaluator& evaluator, const Point& point) {
  const auto integrator = make_integrator(plugins(), point.integrator, point.tolerance);
  double least = 1e300;
  for (int i = 0; i < 5; ++i)
    least = std::min(
        least,
        walk(*evaluator.model(point).prepared, *integrator, {[](const State&) { return true; }, {}, {}}).seconds);
  return least;
}

/// Two modes and two digits more than the advice's own reference.
Yardstick truth_of(Evaluator& evaluator, const Yardstick& known) {
  Yardstick truth = known;
  Reference& r = truth.reference;
  r.point.modes += 2;
  r.point.tolerance *= 1e-2;
  r.own.clear();
  const std::size_t outputs = r.readings.values.size();
  r.readings = {};
  const ModelAt& model = evaluator.model(r.point);
  EXPECT_FALSE(model.refused()) << model.refusal;
  OutputReader reader(evaluator.outputs(), model.prepared->model(), *model.prepared->equations);
  const auto keep = [&](const State& s) {
    r.readings.times.push_back(s.time);
    r.readings.values.push_back(reader.read(s));
    return true;
  };
  const Walk w =
      walk(*model.prepared, *make_integrator(plugins(), r.point.integrator, r.point.tolerance), {keep, {}, {}});
  EXPECT_EQ(w.end, Walk::End::reached) << w.reason;
  EXPECT_EQ(r.readings.values.size(), outputs);
  return truth;
}

/// What each run costs: evaluations times the least time of one that was seen in its model and integrator.
class Costs {
 public:
  double unit(const Probe& p) {
    const std::string key = p.point.formulation + p.point.family + std::to_string(p.point.modes) + p.point.integrator;
    const double seen = p.walk.seconds / static_cast<double>(p.walk.evaluations);
    double& least = units_.try_emplace(key, seen).first->second;
    return least = std::min(least, seen);
  }
  double of(const Probe& p) { return unit(p) * static_cast<double>(p.walk.evaluations); }

 private:
  std::map<std::string, double> units_;
};

/// Every candidate that holds the accuracy, cut where it fails or costs more than the cheapest so far; the choice
/// first.
std::vector<Probe> search_all(Evaluator& evaluator, const Candidates& all, const Point& choice, const Yardstick& truth,
                              Costs& costs, double& best) {
  std::vector<Probe> passed{evaluator.run(choice, truth)};
  best = passed.front().walk.seconds;
  for (const Point& point : points_of(all)) {
    const Probe p = evaluator.run(point, truth, {1, 1.5 * best});
    if (p.walk.evaluations > 0) static_cast<void>(costs.unit(p));
    if (!p.passed()) continue;
    best = std::min(best, p.walk.seconds);
    passed.push_back(p);
  }
  return passed;
}

Verdict judge(const std::string& scene, const std::string& accuracy_text) {
  const Prepared prepared = prepare(SceneValues::read(scene), plugins());
  const Outputs outputs(prepared.model());
  const Accuracy accuracy = Accuracy::parse(accuracy_text);
  Candidates all = candidates_for(prepared, plugins(), usual_axes());
  Evaluator evaluator(prepared, plugins(), outputs, {});
  const Advice advice = advise(evaluator, all, accuracy);
  Verdict v;
  if (!advice.choice) {
    v.trouble = advice.trouble.empty() ? "no candidate holds the accuracy" : advice.trouble;
    return v;
  }
  v.advised = true;
  const Probe& choice = *advice.choice;
  EXPECT_NE(choice.point.formulation, "inconsistent");
  v.choice = choice.point.text() + " for " + accuracy_text;
  v.own_use = advice.yardstick->own_use();
  v.probing = advice.cpu_seconds / choice.cost;
  if (choice.point.modes > all.modes.back()) all.modes = all.more_modes;  // none of fewer would do
  const Yardstick truth = truth_of(evaluator, *advice.yardstick);
  Costs costs;
  double best = 0;
  const std::vector<Probe> passed = search_all(evaluator, all, choice.point, truth, costs, best);
  v.use = passed.front().use;
  // Unit costs of what is near, once more: other work on the machine only adds.
  for (const Probe& p : passed)
    if (costs.of(p) < 2 * best) static_cast<void>(costs.unit(evaluator.run(p.point, truth)));
  const Probe* cheapest = &passed.front();
  for (const Probe& p : passed)
    if (costs.of(p) < costs.of(*cheapest)) cheapest = &p;
  v.cost_ratio = costs.of(passed.front()) / costs.of(*cheapest);
  v.cheapest = cheapest->point.text();
  v.cpu_ratio = least_seconds(evaluator, choice.point) / least_seconds(evaluator, cheapest->point);
  return v;
}

Verdict judge_random(unsigned seed, const std::string& scene) {
  RandomMachine machine(seed);
  std::ofstream(scene) << machine.text();
  return judge(scene, machine.accuracy());
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
    return judge(std::string(WITHY_SOURCES) + "/scenes/" + scenes[number - 1] + ".yaml", "1%");
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
