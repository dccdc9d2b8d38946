// Cases: random numbers have the distribution, the spread and the correlation that the plan asks for.
#include "withy/campaign/cases.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "withy/campaign/case_lanes.hpp"
#include "withy/campaign/case_text.hpp"
#include "withy/tests/campaign/plan_fixture.hpp"

namespace withy::campaign {
namespace {

using test::PlanFolder;
using test::plugins;

/// Greatest distance of a sample from the uniform distribution (Kolmogorov and Smirnov).
double distance_from_uniform(std::vector<double> sample) {
  std::sort(sample.begin(), sample.end());
  const auto n = static_cast<double>(sample.size());
  double most = 0;
  for (std::size_t i = 0; i < sample.size(); ++i)
    most = std::max(
        {most, std::abs(sample[i] - static_cast<double>(i) / n), std::abs(sample[i] - static_cast<double>(i + 1) / n)});
  return most;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  double ma = 0, mb = 0, ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ma += a[i] / n;
    mb += b[i] / n;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - ma) * (b[i] - mb);
    aa += (a[i] - ma) * (a[i] - ma);
    bb += (b[i] - mb) * (b[i] - mb);
  }
  return ab / std::sqrt(aa * bb);
}

std::vector<double> column(const Plan& plan, std::size_t axis) {
  const Cases cases(plan);
  std::vector<double> all;
  for (std::uint64_t i = 0; i < cases.size(); ++i) all.push_back(cases.values(i)[axis]->number());
  return all;
}

constexpr std::size_t many = 20000;
// Of a sample of n the distance passes 1.95/√n once in a thousand times, a correlation 3.3/√n.
const double far_from_uniform = 1.95 / std::sqrt(many), correlated = 3.3 / std::sqrt(many);

TEST(Keys, NumbersAreUniformAndIndependentAlongEveryBranch) {
  const Key root(7);
  const std::vector<std::function<double(std::uint64_t)>> branches = {
      [&](std::uint64_t i) { return root[i].uniform(); },
      [&](std::uint64_t i) { return root["bodies.hub.mass"][i].uniform(); },
      [&](std::uint64_t i) { return root["bodies.hub.mas"][i].uniform(); },
      [&](std::uint64_t i) { return root[i]["bodies.hub.mass"].uniform(); },
      [&](std::uint64_t i) { return Key(i)["a"][0].uniform(); },
      [&](std::uint64_t i) { return root[i + 1].uniform(); }};
  std::vector<std::vector<double>> samples;
  for (const auto& branch : branches) {
    samples.emplace_back();
    for (std::uint64_t i = 0; i < many; ++i) samples.back().push_back(branch(i));
    EXPECT_LT(distance_from_uniform(samples.back()), far_from_uniform) << samples.size();
  }
  for (std::size_t a = 0; a < samples.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) EXPECT_LT(std::abs(correlation(samples[a], samples[b])), correlated) << a << b;
}

TEST(Keys, PermutationsHitEachPlaceOnceAndDiffer) {
  for (const std::uint64_t n : {1U, 2U, 3U, 16U, 17U, 1000U}) {
    std::set<std::uint64_t> images;
    for (std::uint64_t i = 0; i < n; ++i) images.insert(permuted(Key(3), i, n));
    EXPECT_EQ(images.size(), n);
    EXPECT_LT(*images.rbegin(), n);
  }
  // Where 0 of 5 goes is uniform over keys.
  std::vector<int> counts(5);
  for (std::uint64_t k = 0; k < 5000; ++k) ++counts[permuted(Key(k), 0, 5)];
  for (const int c : counts) EXPECT_NEAR(c, 1000, 120);
}

TEST(Sobol, EveryElementaryIntervalHoldsOnePointWhateverTheShift) {
  for (const std::uint64_t seed : {1U, 99U})
    for (const unsigned bits : {0U, 2U, 5U, 8U}) {  // of the first dimension; the second has the rest of eight
      std::set<std::pair<int, int>> boxes;
      for (std::uint64_t i = 0; i < 256; ++i) {
        const std::vector<double> p = sobol_point(Key(seed), i, 2);
        boxes.emplace(static_cast<int>(std::ldexp(p[0], static_cast<int>(bits))),
                      static_cast<int>(std::ldexp(p[1], static_cast<int>(8 - bits))));
      }
      EXPECT_EQ(boxes.size(), 256U);
    }
}

TEST(Distributions, AreWhatTheirMeanAndDeviationSay) {
  for (const auto kind : {Distribution::Kind::normal, Distribution::Kind::lognormal}) {
    const Distribution d{kind, 2.0, 0.5, {}, {}};
    double mean = 0, square = 0;
    for (std::size_t i = 0; i < many; ++i) {
      const double x = d.quantile((static_cast<double>(i) + 0.5) / many);
      mean += x / many;
      square += x * x / many;
    }
    EXPECT_NEAR(mean, 2.0, 1e-3);
    EXPECT_NEAR(std::sqrt(square - mean * mean), 0.5, 1e-3);
  }
  // A lognormal value with these is exp of a normal one with variance ln(1 + 1/16).
  EXPECT_NEAR((Distribution{Distribution::Kind::lognormal, 2.0, 0.5, {}, {}}).quantile(0.5),
              2 / std::sqrt(1 + 1.0 / 16), 1e-14);
}

TEST(Distributions, CutOffAreTheSameBetweenTheEndsAndReachThem) {
  for (const auto& [from, to] : {std::pair{1.0, 3.5}, {2.5, 4.0}, {4.5, 5.0}, {-0.5, 1.0}}) {
    const Distribution d{Distribution::Kind::normal, 2.0, 0.5, from, to};
    ASSERT_EQ(d.problem(), "");
    EXPECT_NEAR(d.quantile(1e-15), from, 1e-9);
    EXPECT_NEAR(d.quantile(1 - 1e-16), to, 1e-9);
    const auto share = [](double x) { return normal_share((x - 2.0) / 0.5); };
    const auto above = [](double x) { return normal_share((2.0 - x) / 0.5); };
    for (const double u : {0.1, 0.5, 0.9}) {
      const double x = d.quantile(u);
      const double expected = from > 2 ? (above(from) - above(x)) / (above(from) - above(to))
                                       : (share(x) - share(from)) / (share(to) - share(from));
      EXPECT_NEAR(expected, u, 1e-9) << from;
    }
  }
}

TEST(Cases, GridsVaryInTheOrderOfThePlanAndDrawsFastest) {
  const PlanFolder folder;
  folder.write("pairs.csv", "bodies.rod.mass,gravity.1\n1,-9\n2,-8\n");
  const Plan plan = folder.plan(R"(vary:
  integrator.atol: {grid: {from: 1e-9, to: 3e-9, count: 3}}
  bodies.rod.mass: {list: pairs.csv}
  gravity.1: {list: pairs.csv}
  time.output: {uniform: {from: 0.01, to: 0.02}}
cases: 2
)");
  const Cases cases(plan);
  ASSERT_EQ(cases.size(), 12U) << "lists of one file go together";
  std::set<double> drawn;
  for (std::uint64_t i = 0; i < 12; ++i) {
    const CaseValues v = cases.values(i);
    EXPECT_DOUBLE_EQ(v[0]->number(), 1e-9 * (1 + static_cast<double>(i / 4)));
    EXPECT_EQ(v[1]->number(), i / 2 % 2 == 0 ? 1 : 2);
    EXPECT_EQ(v[2]->number(), i / 2 % 2 == 0 ? -9 : -8);
    EXPECT_GT(v[3]->number(), 0.01);
    EXPECT_LT(v[3]->number(), 0.02);
    drawn.insert(v[3]->number());
  }
  EXPECT_EQ(drawn.size(), 12U) << "drawn anew for each case";
}

/// A head of any words is none of the values; a number or a quantity is one.
TEST(Cases, AListOfOneColumnMayHaveNoHead) {
  const PlanFolder folder;
  const std::string vary = "vary: {bodies.rod.mass: {list: list.csv}}\n";
  for (const char* text : {"1\n2\n", "mass\n1\n2\n", "bodies.rod.mass\n1\n2\n"}) {
    folder.write("list.csv", text);
    EXPECT_EQ(column(folder.plan(vary), 0), (std::vector<double>{1, 2})) << text;
  }
  folder.write("list.csv", "1 kg\n2\n");
  EXPECT_EQ(Cases(folder.plan(vary)).size(), 2U);
}

TEST(Cases, ListsAreReadAsSpreadsheetsWriteThem) {
  const PlanFolder folder;
  folder.write("pairs.csv", "\xEF\xBB\xBFgravity.1,bodies.rod.mass\r\n-9,1\r\n\r\n-8,2\r\n");
  const std::string vary = "vary: {gravity.1: {list: pairs.csv}}\n";
  EXPECT_EQ(column(folder.plan(vary), 0), (std::vector<double>{-9, -8}));
  const auto problem = [&](const std::string& text) -> std::string {
    folder.write("pairs.csv", text);
    try {
      static_cast<void>(folder.plan(vary));
    } catch (const std::exception& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(problem("gravity.1;mass\n-9;1\n"), testing::HasSubstr("pairs.csv:1:1: got semicolons between the cells"));
  EXPECT_THAT(problem("gravity.1,mass\n-9,5,1\n"), testing::HasSubstr("pairs.csv:2:1: got 3 cells; the head has 2"));
  EXPECT_THAT(problem("mass,gravity.1\n1,\n"), testing::HasSubstr("pairs.csv:2:3: got an empty cell"));
}

TEST(Cases, LatinValuesFillEveryStratumAndAreNotInOrder) {
  const PlanFolder folder;
  const std::vector<double> x =
      column(folder.plan("vary: {bodies.rod.mass: {latin: {from: 0.5, to: 1.5}}}\ncases: 500\n"), 0);
  std::set<int> strata;
  for (const double v : x) strata.insert(static_cast<int>(500 * (v - 0.5)));
  EXPECT_EQ(strata.size(), 500U);
  EXPECT_FALSE(std::is_sorted(x.begin(), x.end()));
  std::vector<double> within;
  for (const double v : x) within.push_back(500 * (v - 0.5) - std::floor(500 * (v - 0.5)));
  EXPECT_LT(distance_from_uniform(within), 1.95 / std::sqrt(500));
}

TEST(Cases, CorrelatedValuesKeepTheirOwnDistributions) {
  const PlanFolder folder;
  const Plan plan = folder.plan(R"(vary:
  bodies.rod.mass: {normal: {mean: 2, deviation: 0.1}}
  gravity.1: {uniform: {from: -10, to: -9}}
  gravity.0: {normal: {mean: 0, deviation: 1}}
correlation: {of: [bodies.rod.mass, gravity.0, gravity.1], matrix: [[1, 0.8, 0], [0.8, 1, 0.3], [0, 0.3, 1]]}
cases: 20000
)");
  const std::vector<double> mass = column(plan, 0), down = column(plan, 1), across = column(plan, 2);
  EXPECT_NEAR(correlation(mass, across), 0.8, correlated);
  EXPECT_NEAR(correlation(mass, down), 0, correlated);
  // Of a normal and a uniform value the copula's 0.3 leaves 0.3 √(3/π).
  EXPECT_NEAR(correlation(across, down), 0.3 * std::sqrt(3 / 3.14159265358979), correlated);
  std::vector<double> shares;
  for (const double x : down) shares.push_back(x + 10);
  EXPECT_LT(distance_from_uniform(shares), far_from_uniform);
  shares.clear();
  for (const double x : mass) shares.push_back(normal_share((x - 2) / 0.1));
  EXPECT_LT(distance_from_uniform(shares), far_from_uniform);
}

TEST(Cases, DesignsChangeOneValueAtATime) {
  const PlanFolder folder;
  const std::string vary =
      "vary: {bodies.rod.mass: {uniform: {from: 1, to: 2}}, gravity.1: {normal: {mean: -9, deviation: "
      "1}}, gravity.0: {uniform: {from: 0, to: 1}}}\n";
  const auto changed = [](const CaseValues& a, const CaseValues& b) {
    std::set<std::size_t> axes;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (a[i]->number() != b[i]->number()) axes.insert(i);
    return axes;
  };
  const Plan morris = folder.plan(vary + "design: {type: morris, levels: 6}\ncases: 50\n");
  const Cases walk(morris);
  ASSERT_EQ(walk.size(), 200U);
  for (std::uint64_t t = 0; t < 50; ++t) {
    std::set<std::size_t> all;
    for (std::uint64_t k = 0; k < 3; ++k) {
      const auto one = changed(walk.values(4 * t + k), walk.values(4 * t + k + 1));
      ASSERT_EQ(one.size(), 1U);
      all.insert(one.begin(), one.end());
    }
    EXPECT_EQ(all.size(), 3U) << "each once";
  }
  const Plan saltelli = folder.plan(vary + "design: saltelli\ncases: 20\n");
  const Cases samples(saltelli);
  ASSERT_EQ(samples.size(), 100U);
  for (std::uint64_t s = 0; s < 20; ++s)
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_EQ(changed(samples.values(5 * s), samples.values(5 * s + a + 1)), std::set<std::size_t>{a});
      EXPECT_EQ(samples.values(5 * s + a + 1)[a]->number(), samples.values(5 * s + 4)[a]->number());
    }
  const Plan alone = folder.plan(
      "vary: {bodies.rod.mass: {grid: [1, 2, 3]}, gravity.1: {normal: {mean: -9, deviation: 1}}}\n"
      "design: one-at-a-time\n");
  const Cases each(alone);
  ASSERT_EQ(each.size(), 6U);
  EXPECT_FALSE(each.values(0)[0]) << "the scene itself";
  EXPECT_EQ(each.values(3)[0]->number(), 3);
  EXPECT_NEAR(each.values(5)[1]->number(), -8, 1e-12) << "one deviation up";
}

// Elementary effects are differences over half of the distribution: a level above the middle steps down, or its point
// would lie beyond the end and be taken back to it.
TEST(Cases, StepsOfMorrisGoOverHalfAndStayWithin) {
  const PlanFolder folder;
  const Plan plan = folder.plan(
      "vary: {bodies.rod.mass: {uniform: {from: 1, to: 2}}, gravity.0: {uniform: {from: 0, to: 1}}}\n"
      "design: {type: morris, levels: 4}\ncases: 60\n");
  std::set<double> begun;
  for (std::uint64_t number = 0; number < 60; ++number) {
    const MorrisTrajectory trajectory = morris_trajectory(plan, number);
    begun.insert(trajectory.begin.begin(), trajectory.begin.end());
    for (const auto& [axis, step] : trajectory.steps) {
      EXPECT_EQ(std::abs(step), 0.5);
      EXPECT_GT(trajectory.begin[axis] + step, 0);
      EXPECT_LT(trajectory.begin[axis] + step, 1);
    }
  }
  EXPECT_EQ(begun, (std::set<double>{0.125, 0.375, 0.625, 0.875}));
}

/// All of a value, with the places it stands at.
std::string told(const Value& value) {
  const auto of_place = [](const Place& p) { return fmt::format("{}:{}:{} ", p.line, p.column, p.path); };
  std::string text = of_place(value.place()) + fmt::format("{} {} ", static_cast<int>(value.kind()), value.text());
  if (value.kind() == Value::Kind::number) text += fmt::format("{} ", value.number());
  for (const Value& item : value.items()) text += told(item);
  for (const auto& [key, member] : value.members()) text += key + '=' + told(member);
  return text + '\n';
}
std::string told(const SceneValues& scene) {
  std::map<std::string, int> keys;
  for (const auto& [path, place] : scene.document().keys) keys[path] = place.line;
  return told(scene.root()) + fmt::format("{} {} {}", keys, scene.origins(), scene.settings());
}

TEST(Cases, MakeOfASceneThatIsDoneWithWhatACopyOfThePlansBecomes) {
  const PlanFolder folder;
  const Plan plan = folder.plan(R"(vary:
  bodies.rod.mass: {normal: {mean: 1.2, deviation: 0.1}}
  gravity.1: {uniform: {from: -10, to: -9}}
  limits.deflection: {uniform: {from: 1, to: 2}}
derived: {bodies.rod.center_of_mass.1: -0.4 * bodies.rod.mass}
cases: 3
)");
  const Cases cases(plan);
  std::vector<SceneValues> spare;
  for (std::uint64_t i = 0; i < 3; ++i) {
    const CaseValues values = cases.values(i);
    const std::string origin = fmt::format("case {}", i);
    ASSERT_TRUE(cases.spares(values));
    SceneValues scene = cases.scene(values, origin, spare);
    EXPECT_TRUE(spare.empty()) << "taken";
    EXPECT_EQ(told(scene), told(cases.scene(values, origin)));
    EXPECT_TRUE(scene.problems().ok());
    spare.push_back(std::move(scene));
  }
  const auto sparing = [&](const std::string& vary) {
    const Plan other = folder.plan("vary: " + vary + "\n");
    return Cases(other).spares(Cases(other).values(0));
  };
  EXPECT_FALSE(sparing("{integrator.name: {grid: [dopri5]}}")) << "which may bring other members";
  EXPECT_FALSE(sparing("{limits.deflection: {grid: [null, 1]}}")) << "which takes a member away";
}

/// A pendulum of length l that starts at rest from 60 degrees, with a damper: without it, it has the energy it began
/// with all along.
Plan damped_plan(const PlanFolder& folder, const std::string& more) {
  folder.write("damped.yaml", R"(format: withy/1
gravity: [0, -9.81, 0]
integrator: {name: rk4, step: 0.002}
time: {end: 1, output: 0.05}
bodies: {rod: {type: rigid, mass: 1.2, center_of_mass: [0, -0.5, 0], inertia: [0.2, 0.2, 0.1, 0, 0, 0]}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}}
loads: {drag: {type: hinge-spring, hinge: pivot, damping: 0.5}}
initial: {hinges: {pivot: {position: ["60 deg"]}}}
)");
  folder.write("damped-plan.yaml",
               "format: withy-sweep/1\nscene: damped.yaml\nkeep: {final: [kinetic_energy, pivot]}\n" + more);
  return read_plan((folder / "damped-plan.yaml").string(), plugins());
}

/// What is set to nothing is not there, alone too: m g l (cos q − cos 60°) is the kinetic energy of a pendulum without
/// a damper, and more than that of one with it.
TEST(Cases, ANullLevelTakesAwayWhatTheSceneSays) {
  const PlanFolder folder;
  const std::string vary = "vary: {loads.drag: {grid: [null, {type: hinge-spring, hinge: pivot, damping: 0.5}]}}\n";
  for (const std::string design : {"", "design: one-at-a-time\n"}) {
    const Plan plan = damped_plan(folder, vary + design);
    const Cases cases(plan);
    const std::uint64_t bare = design.empty() ? 0 : 1;
    const CaseResult without = run_case(plan, cases, bare, plugins(), {});
    const CaseResult with = run_case(plan, cases, bare + 1, plugins(), {});
    ASSERT_TRUE(without.completed() && with.completed()) << without.message << with.message;
    const auto given = [](const CaseResult& r) { return 1.2 * 9.81 * 0.5 * (std::cos(r.numbers[1]) - 0.5); };
    EXPECT_NEAR(without.numbers[0], given(without), 1e-8);
    EXPECT_LT(with.numbers[0], given(with) - 0.1);
    EXPECT_THAT(case_json(plan, without).at("command").get<std::string>(), testing::HasSubstr("loads.drag=null"));
    EXPECT_TRUE(case_json(plan, without).at("values").at("loads.drag").is_null());
  }
  const Plan alone = damped_plan(folder, vary + "design: one-at-a-time\n");
  EXPECT_FALSE(case_json(alone, run_case(alone, Cases(alone), 0, plugins(), {})).at("values").contains("loads.drag"))
      << "the scene's own stays";
  // What the scene does not have is as little there: with a second damper, and without.
  const Plan more =
      damped_plan(folder, "vary: {loads.more: {grid: [null, {type: hinge-spring, hinge: pivot, damping: 1}]}}\n");
  const CaseResult one = run_case(more, Cases(more), 0, plugins(), {}),
                   two = run_case(more, Cases(more), 1, plugins(), {});
  ASSERT_TRUE(one.completed() && two.completed()) << one.message << two.message;
  EXPECT_LT(two.numbers[0], one.numbers[0]);
  EXPECT_THAT(case_json(more, one).at("command").get<std::string>(), testing::Not(testing::HasSubstr("loads.more")));
}

}  // namespace
}  // namespace withy::campaign
