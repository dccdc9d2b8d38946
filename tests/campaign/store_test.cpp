// The store: what was kept is found again to the last bit, what is damaged is made again, and nothing else.
#include "withy/campaign/store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "withy/campaign/case_lanes.hpp"
#include "withy/campaign/case_text.hpp"
#include "withy/campaign/collect.hpp"
#include "withy/campaign/sweep_run.hpp"
#include "withy/results/results_error.hpp"
#include "withy/results/results_folder.hpp"
#include "withy/tests/campaign/plan_fixture.hpp"

namespace withy::campaign {
namespace {

using test::PlanFolder;
using test::plugins;
using testing::HasSubstr;

const std::string fingerprint(64, 'a');

CaseResult made(std::uint64_t index) {
  CaseResult r;
  r.index = index;
  r.status = index % 5 == 0 ? "diverged" : "completed";
  r.message = index % 5 == 0 ? std::string("its \"tip\",\nfar") : "";
  r.values = {Value(0.1 * static_cast<double>(index)), Value(std::string("quadratic")), Value()};
  r.numbers = {1.0 / (1.0 + static_cast<double>(index)), -0.0};
  r.seconds = 0.5;
  return r;
}

std::map<std::uint64_t, std::string> records(const std::filesystem::path& path) {
  SegmentReader reader(path, fingerprint);
  std::map<std::uint64_t, std::string> all;
  while (const auto record = reader.next()) all.emplace(decode(*record)->index, *record);
  return all;
}

TEST(Segments, KeepEveryStatusThatARunCanHave) {
  CaseResult r = made(1);
  for (const RunStatus status :
       {RunStatus::completed, RunStatus::inaccurate, RunStatus::diverged, RunStatus::singular,
        RunStatus::step_underflow, RunStatus::interrupted, RunStatus::load_failed, RunStatus::too_stiff}) {
    r.status = name(status);
    EXPECT_EQ(decode(encode(r))->status, name(status));
  }
}

TEST(Segments, AnyDamageCostsTheRecordsItTouchesAndNoOther) {
  const PlanFolder folder;
  const std::filesystem::path path = folder / "a.segment";
  std::vector<std::size_t> ends;
  {
    SegmentWriter writer(path, fingerprint);
    for (std::uint64_t i = 0; i < 60; ++i) {
      writer.append(made(i));
      ends.push_back(std::filesystem::file_size(path));
    }
    writer.close();
  }
  const std::string whole = folder.read("a.segment");
  std::mt19937 random(4);
  const std::size_t head = ends[0] - (ends[1] - ends[0]);
  for (int trial = 0; trial < 400; ++trial) {
    std::string bytes = whole;
    std::size_t from = random() % whole.size(), to = from + 1 + random() % 300;
    to = std::min(to, whole.size());
    std::size_t cut = whole.size();
    if (trial % 3 == 0) {
      for (std::size_t i = from; i < to; ++i) bytes[i] = static_cast<char>(random());
    } else if (trial % 3 == 1) {
      bytes.resize(cut = from);
    } else {
      bytes.erase(from, to - from);
    }
    folder.write("b.segment", bytes);
    const auto found = records(folder / "b.segment");
    for (const auto& [index, record] : found) EXPECT_EQ(record, encode(made(index)));
    for (std::uint64_t i = 0; i < 60; ++i) {
      const std::size_t begin = i == 0 ? head : ends[i - 1];
      const bool touched = ends[i] > cut || (trial % 3 != 1 && begin < to && from < ends[i]);
      if (!touched) {
        EXPECT_TRUE(found.contains(i)) << trial << ' ' << i;
      }
    }
  }
}

TEST(Segments, GoOnBehindATornRecordAndHaveOneWriter) {
  const PlanFolder folder;
  const std::filesystem::path path = folder / "a.segment";
  {
    SegmentWriter writer(path, fingerprint);
    writer.append(made(1));
    writer.append(made(2));
    EXPECT_THROW(SegmentWriter(path, fingerprint), FolderBusy);
  }
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 3);
  {
    SegmentWriter writer(path, fingerprint);
    writer.append(made(3));
  }
  const auto found = records(path);
  EXPECT_EQ(found.size(), 2U);
  EXPECT_TRUE(found.contains(1));
  EXPECT_TRUE(found.contains(3));
  SegmentReader other(path, std::string(64, 'b'));
  EXPECT_FALSE(other.next()) << "records of another plan are none";
}

/// Twelve cases, some of them refused for a tolerance below zero.
constexpr const char* twelve = R"(vary:
  bodies.rod.mass: {grid: [1, 2]}
  integrator.rtol: {normal: {mean: 1e-6, deviation: 3e-6}}
  initial.hinges.pivot.rate.0: {sobol: {from: 0, to: 3}}
cases: 6
seed: 3
keep: {final: [pivot], peak: [pivot.rate, rod.tip]}
)";

std::string table_of(const PlanFolder& folder, const std::string& store) {
  collect(folder / store);
  return folder.read(store + "/table.csv");
}

SweepOutcome run(const PlanFolder& folder, const Plan& plan, const std::string& store, SweepSettings settings) {
  return run_sweep(plan, plugins(), Store(folder / store, plan, false), settings);
}

TEST(Sweeps, AreTheSameToTheLastByteWhateverTheJobsShardsAndOrder) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  EXPECT_TRUE(run(folder, plan, "one", {1, 1, 1, {}}).whole());
  const std::string table = table_of(folder, "one");
  EXPECT_THAT(table, HasSubstr("\n11,"));
  EXPECT_THAT(table, HasSubstr(",refused,")) << "a tolerance below zero";
  EXPECT_TRUE(run(folder, plan, "many", {5, 1, 1, {}}).whole());
  EXPECT_EQ(table_of(folder, "many"), table);
  for (const std::uint64_t shard : {3U, 1U, 2U}) EXPECT_TRUE(run(folder, plan, "parts", {2, shard, 3, {}}).whole());
  EXPECT_EQ(table_of(folder, "parts"), table);
  EXPECT_EQ(folder.read("parts/failed.csv"), folder.read("many/failed.csv"));
  EXPECT_EQ(folder.read("parts/statistics.csv"), folder.read("many/statistics.csv"));
  EXPECT_EQ(run(folder, plan, "parts", {2, 1, 1, {}}).ran, 0U) << "all is there, whatever the shards were";
  // A case alone.
  const Cases cases(plan);
  StoreIndex index(folder / "many", read_description(folder / "many"));
  for (const std::uint64_t i : {4U, 9U}) {
    CaseResult alone = run_case(plan, cases, i, plugins(), {}), kept = *index.read(i);
    alone.seconds = kept.seconds = 0;
    EXPECT_EQ(encode(alone), encode(kept));
  }
}

/// What outputs have been over a run are columns of the table, found between rows: x = 0.3 cos ωt, two rows of each.
TEST(Sweeps, KeepWhatOutputsHaveBeenOverARun) {
  const PlanFolder folder;
  folder.write("block.yaml", R"(format: withy/1
time: {end: 3, output: 3}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs: {seen: {type: hinge, hinge: slide}}
initial: {hinges: {slide: {position: [0.3]}}}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 30}}
)");
  const auto planned = [&](const std::string& keep) {
    folder.write("over.yaml",
                 "format: withy-sweep/1\nscene: block.yaml\nvary: {loads.spring.stiffness: {grid: [18, 50]}}\n"
                 "keep: {" +
                     keep + "}\n");
    return read_plan((folder / "over.yaml").string(), plugins());
  };
  const Plan plan = planned("final: [seen.rate.max, slide, seen.position.rms]");
  EXPECT_TRUE(run(folder, plan, "over", {1, 1, 1, {}}).whole());
  std::istringstream table(table_of(folder, "over"));
  std::string line;
  std::getline(table, line);
  EXPECT_THAT(line, HasSubstr(",final.seen.rate.max[m/s],final.slide[m],final.seen.position.rms[m]"));
  for (const double w : {3.0, 5.0}) {
    std::getline(table, line);
    const std::size_t rms = line.rfind(','), slide = line.rfind(',', rms - 1), rate = line.rfind(',', slide - 1);
    EXPECT_NEAR(std::stod(line.substr(rate + 1)), 0.3 * w, 1e-8) << line;
    EXPECT_NEAR(std::stod(line.substr(slide + 1)), 0.3 * std::cos(3 * w), 1e-7) << line;
    EXPECT_NEAR(std::stod(line.substr(rms + 1)), 0.3 * std::sqrt(0.5 + std::sin(6 * w) / (12 * w)), 1e-8) << line;
  }
  EXPECT_THROW(planned("peak: [seen.rate.max]"), SceneError);
  EXPECT_THROW(planned("final: [seen.rate.most]"), SceneError);
}

/// Percentiles over time are those of the closed form x = x0 cos 3t at every time, whatever the lanes; where an event
/// ends cases they are of those that go on.
TEST(Sweeps, KeepHistoriesAndTheirPercentilesOverTheCases) {
  const PlanFolder folder;
  folder.write("block.yaml", R"(format: withy/1
time: {end: 1, output: 0.05}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
events: {low: {hinge: slide, value: -0.45, direction: down, stop: true}}
initial: {hinges: {slide: {position: [0.3]}}}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 18}}
)");
  for (const char* evaluation : {"one-at-a-time", "in-lanes"}) {
    folder.write("history.yaml", std::string("format: withy-sweep/1\nscene: block.yaml\nevaluation: ") + evaluation +
                                     "\nvary: {initial.hinges.slide.position.0: {grid: [0.1, 0.2, 0.3, 0.4, 0.5]}}\n"
                                     "keep: {history: {of: [slide], every: 0.1}}\n");
    const Plan plan = read_plan((folder / "history.yaml").string(), plugins());
    EXPECT_TRUE(run(folder, plan, evaluation, {1, 1, 1, {}}).whole());
    EXPECT_TRUE(collect(folder / evaluation).histories);
    std::istringstream lines(folder.read(std::string(evaluation) + "/histories.csv"));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "point,initial.hinges.slide.position.0,result,t[s],cases,least,p05,p25,median,p75,p95,greatest");
    for (int i = 0; i <= 10; ++i) {
      std::getline(lines, line);
      std::istringstream cells(line);
      std::vector<std::string> cell(12);
      for (std::string& c : cell) std::getline(cells, c, ',');
      EXPECT_EQ(cell[2], "slide[m]");
      const double t = 0.1 * i, c = std::cos(3 * t);
      // That from 0.5 m is at −0.45 m at 0.897 s.
      std::vector<double> x = {0.1 * c, 0.2 * c, 0.3 * c, 0.4 * c};
      if (i < 9) x.push_back(0.5 * c);
      std::sort(x.begin(), x.end());
      EXPECT_EQ(cell[4], std::to_string(x.size())) << line;
      EXPECT_NEAR(std::stod(cell[3]), t, 1e-12);
      const double n = static_cast<double>(x.size() - 1);
      const double shares[] = {0, 0.05, 0.25, 0.5, 0.75, 0.95, 1};
      for (std::size_t k = 0; k < 7; ++k) {
        const auto below = static_cast<std::size_t>(shares[k] * n);
        const double way = shares[k] * n - static_cast<double>(below), above = x[std::min(below + 1, x.size() - 1)];
        EXPECT_NEAR(std::stod(cell[5 + k]), x[below] + way * (above - x[below]), 1e-8) << line;
      }
    }
    EXPECT_FALSE(std::getline(lines, line));
    EXPECT_THAT(folder.read(std::string(evaluation) + "/histories.svg"), HasSubstr("25 and 75 %"));
    const auto alone = case_json(plan, run_case(plan, Cases(plan), 4, plugins(), {}));
    EXPECT_EQ(alone.at("histories").at("t[s]").size(), 11U);
    EXPECT_NEAR(alone.at("histories").at("slide[m]").at(8).get<double>(), 0.5 * std::cos(2.4), 1e-8);
    EXPECT_TRUE(alone.at("histories").at("slide[m]").at(9).is_null());
    EXPECT_THAT(case_text(alone), HasSubstr("1 columns at 11 times"));
  }
}

/// Cases of the driven arm: of two integrators with steps of their own, some of them too long, of two structures and of
/// a formulation without lanes, so that lanes end early, run empty, are filled anew and wait for each other.
Plan arm_plan(const PlanFolder& folder, const std::string& more) {
  folder.write("arm.yaml", "format: withy-sweep/1\nscene: " WITHY_SOURCES "/scenes/driven-arm.yaml\n" + more + R"(
set: {time.end: 0.3}
vary:
  formulation: {grid: [quadratic, ruthless, exact]}
  bodies.link1.bending_y.modes: {grid: [2, 3]}
  integrator: {grid: [{name: rk4, step: 0.009}, {name: dopri5, rtol: 1e-6, atol: 1e-8}]}
  bodies.payload.mass: {uniform: {from: 1, to: 3}}
cases: 3
keep: {final: [shoulder, elbow], peak: [link2.tip.deflection_y, elbow.rate]}
)");
  return read_plan((folder / "arm.yaml").string(), plugins());
}

TEST(Sweeps, InLanesAreTheSameToTheLastByteWhateverTheCompany) {
  const PlanFolder folder;
  const Plan plan = arm_plan(folder, "evaluation: in-lanes\n");
  const SweepOutcome one = run(folder, plan, "one", {1, 1, 1, {}});
  EXPECT_EQ(one.ran, 36U);
  EXPECT_EQ(one.alone, 12U);
  EXPECT_EQ(one.alone_because, "a beam moves by exact kinematics");
  const std::string table = table_of(folder, "one");
  EXPECT_THAT(table, testing::Not(HasSubstr("refused")));
  run(folder, plan, "many", {3, 1, 1, {}});
  EXPECT_EQ(table_of(folder, "many"), table);
  EXPECT_THAT(folder.read("one/failed.csv"), HasSubstr("diverged"));
  EXPECT_EQ(folder.read("many/failed.csv"), folder.read("one/failed.csv"));
  for (const std::uint64_t shard : {5U, 2U, 4U, 1U, 3U}) run(folder, plan, "parts", {1, shard, 5, {}});
  EXPECT_EQ(table_of(folder, "parts"), table);
  const Cases cases(plan);
  StoreIndex index(folder / "one", read_description(folder / "one"));
  for (const std::uint64_t i : {0U, 4U, 8U, 23U}) {
    CaseResult alone = run_case(plan, cases, i, plugins(), {}), kept = *index.read(i);
    alone.seconds = kept.seconds = 0;
    EXPECT_EQ(encode(alone), encode(kept)) << "case " << i;
  }
}

TEST(Sweeps, InLanesAgreeWithCasesByThemselvesToRounding) {
  const PlanFolder folder;
  const Plan in_lanes = arm_plan(folder, "evaluation: in-lanes\n");
  run(folder, in_lanes, "lanes", {1, 1, 1, {}});
  const Plan alone = arm_plan(folder, "evaluation: one-at-a-time\n");
  EXPECT_THROW(Store(folder / "lanes", alone, false), ResultsError) << "one store has results of one kind";
  EXPECT_EQ(run(folder, alone, "alone", {1, 1, 1, {}}).alone, 36U);
  StoreIndex first(folder / "lanes", read_description(folder / "lanes"));
  StoreIndex second(folder / "alone", read_description(folder / "alone"));
  int completed = 0;
  for (std::uint64_t i = 0; i < 36; ++i) {
    const CaseResult a = *first.read(i), b = *second.read(i);
    EXPECT_EQ(a.status, b.status) << "case " << i;
    if (!a.completed() || !b.completed()) continue;
    ++completed;
    // The last is a peak over steps, whose places rounding moves where they are chosen by error.
    for (std::size_t k = 0; k < a.numbers.size(); ++k)
      EXPECT_NEAR(a.numbers[k], b.numbers[k], (k + 1 < a.numbers.size() ? 1e-9 : 1e-3) * (1 + std::abs(b.numbers[k])))
          << "case " << i;
  }
  EXPECT_GE(completed, 24);
}

TEST(Sweeps, EndLanesThatAreAtWorkWhereTheyAreInterrupted) {
  const PlanFolder folder;
  const Plan plan = arm_plan(folder, "evaluation: in-lanes\n");
  SweepSettings settings{1, 1, 1, {}};
  int asked = 0;
  settings.control.interrupted = [&] { return ++asked > 300; };
  const SweepOutcome outcome = run(folder, plan, "store", settings);
  EXPECT_FALSE(outcome.whole());
  EXPECT_EQ(run(folder, plan, "store", {2, 1, 1, {}}).before, outcome.ran);
  run(folder, plan, "whole", {1, 1, 1, {}});
  EXPECT_EQ(table_of(folder, "store"), table_of(folder, "whole"));
}

TEST(Sweeps, RepeatWhatIsDamagedAndNothingElse) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  run(folder, plan, "store", {1, 1, 1, {}});
  const std::string table = table_of(folder, "store");
  const std::string segment = "store/segments/1-of-1.0.segment";
  std::string bytes = folder.read(segment);
  bytes[bytes.size() / 2] ^= 1;
  bytes.resize(bytes.size() - 5);
  folder.write(segment, bytes);
  const SweepOutcome repeated = run(folder, plan, "store", {1, 1, 1, {}});
  EXPECT_EQ(repeated.ran, 2U);
  EXPECT_GT(repeated.lost, 0U);
  EXPECT_EQ(table_of(folder, "store"), table);
}

TEST(Sweeps, ADamagedDescriptionIsNoticedAndCostsNoCase) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  run(folder, plan, "store", {1, 1, 1, {}});
  const std::string table = table_of(folder, "store"), about = folder.read("store/store.json");
  std::string other = about;
  other.replace(other.find("pivot.rate"), 5, "pivto");
  for (const std::string& damaged : {other, about.substr(0, about.size() / 2), std::string()}) {
    folder.write("store/store.json", damaged);
    EXPECT_THROW(read_description(folder / "store"), ResultsError);
    EXPECT_EQ(run(folder, plan, "store", {1, 1, 1, {}}).ran, 0U);
    EXPECT_EQ(folder.read("store/store.json"), about);
    EXPECT_EQ(table_of(folder, "store"), table);
  }
  std::string with_seed_4 = twelve;
  with_seed_4.replace(with_seed_4.find("seed: 3"), 7, "seed: 4");
  folder.write("store/store.json", other);
  EXPECT_THROW(Store(folder / "store", folder.plan(with_seed_4), false), ResultsError)
      << "its cases are another plan's";
}

TEST(Sweeps, AStoreOfAnotherPlanIsNotMixedWith) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  run(folder, plan, "store", {1, 1, 1, {}});
  std::string with_seed_4 = twelve;
  with_seed_4.replace(with_seed_4.find("seed: 3"), 7, "seed: 4");
  const Plan other = folder.plan(std::string(twelve) + "failures: stop\n"), another = folder.plan(with_seed_4);
  EXPECT_EQ(run(folder, other, "store", {1, 1, 1, {}}).ran, 0U) << "its cases are the same";
  EXPECT_THROW(Store(folder / "store", another, false), ResultsError);
  Store(folder / "store", another, true);
  EXPECT_EQ(run(folder, another, "store", {1, 1, 1, {}}).ran, 12U);
}

TEST(Sweeps, TwoResultsOfOneCaseThatDifferAreAnError) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  const Store store(folder / "store", plan, false);
  CaseResult one = made(3), another = made(3);
  another.numbers[0] = std::nextafter(another.numbers[0], 1.0);
  for (const auto& [worker, result] : {std::pair{0U, one}, {1U, another}}) {
    SegmentWriter writer(store.segment(1, 1, worker), plan.fingerprint);
    writer.append(result);
  }
  EXPECT_THROW(StoreIndex(store.path(), store.about()), ResultsError);
}

TEST(Peaks, AreFoundBetweenOutputs) {
  const PlanFolder folder;
  const Plan plan = folder.plan(R"(vary: {time.output: {grid: [0.01, 1]}, time.end: {grid: [1]}}
keep: {peak: [pivot.rate, pivot]}
)");
  const Cases cases(plan);
  const CaseResult fine = run_case(plan, cases, 0, plugins(), {}), coarse = run_case(plan, cases, 1, plugins(), {});
  ASSERT_TRUE(fine.completed() && coarse.completed());
  // The outputs of the second are its turning points: between them it passes the bottom.
  EXPECT_GT(fine.numbers[0], 3);
  EXPECT_NEAR(coarse.numbers[0], fine.numbers[0], 0.01 * fine.numbers[0]);
  EXPECT_NEAR(coarse.numbers[1], fine.numbers[1], 1e-12) << "it starts at its peak";
}

/// 1500 N m s/rad on 1e-9 kg m²: the case ends after a second of work with its reason, and the plan goes on.
TEST(Cases, ThatAreTooStiffForTheirIntegratorStopEarly) {
  const PlanFolder folder;
  folder.write("stiff.yaml", R"(format: withy/1
time: {end: 1}
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 1.0e-9, 0, 0, 0]}}
hinges: {pin: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
loads: {drag: {type: hinge-spring, hinge: pin, stiffness: 1.0e-6, damping: 1}}
initial: {hinges: {pin: {rate: [1]}}}
)");
  folder.write("plan.yaml",
               "format: withy-sweep/1\nscene: stiff.yaml\nvary: {loads.drag.damping: {grid: [1.0e-9, 1500]}}\n"
               "keep: {final: [pin]}\n");
  const Plan plan = read_plan((folder / "plan.yaml").string(), plugins());
  const Cases cases(plan);
  EXPECT_TRUE(run_case(plan, cases, 0, plugins(), {}).completed());
  const CaseResult stiff = run_case(plan, cases, 1, plugins(), {});
  EXPECT_EQ(stiff.status, "too-stiff");
  EXPECT_THAT(stiff.message, HasSubstr("its fastest motion is -1.5e+12/s: damping of load 'drag' on pin"));
}

}  // namespace
}  // namespace withy::campaign
