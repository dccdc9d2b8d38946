// What is kept of cases: extremes between outputs and rows, values over a run, histories and their percentiles.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "withy/campaign/case_lanes.hpp"
#include "withy/campaign/case_text.hpp"
#include "withy/campaign/histories_picture.hpp"
#include "withy/campaign/sweep_page.hpp"
#include "withy/tests/campaign/store_fixture.hpp"

namespace withy::campaign {
namespace {

using test::PlanFolder;
using test::plugins;
using testing::HasSubstr;

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

/// Of a hinge's rate that no output of the scene has: ẋ = −0.3 ω sin ωt over 3 s.
TEST(Sweeps, KeepWhatRatesOfHingesHaveBeenOverARun) {
  const PlanFolder folder;
  folder.write("block.yaml", R"(format: withy/1
time: {end: 3, output: 3}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
initial: {hinges: {slide: {position: [0.3]}}}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 30}}
)");
  const auto planned = [&](const std::string& keep) {
    folder.write("rate.yaml",
                 "format: withy-sweep/1\nscene: block.yaml\nvary: {loads.spring.stiffness: {grid: [18, 50]}}\n"
                 "keep: {" +
                     keep + "}\n");
    return read_plan((folder / "rate.yaml").string(), plugins());
  };
  const Plan plan = planned("final: [slide.rate.max, slide.rate.rms, slide.rate.integral]");
  EXPECT_THAT(kept_columns(plan), testing::ElementsAre("final.slide.rate.max[m/s]", "final.slide.rate.rms[m/s]",
                                                       testing::StartsWith("final.slide.rate.integral[m")));
  const Cases cases(plan);
  for (const std::uint64_t i : {0U, 1U}) {
    const CaseResult result = run_case(plan, cases, i, plugins(), {});
    ASSERT_TRUE(result.completed()) << result.message;
    const double w = i == 0 ? 3 : 5;
    EXPECT_NEAR(result.numbers[0], 0.3 * w, 1e-8);
    EXPECT_NEAR(result.numbers[1], 0.3 * w * std::sqrt(0.5 - std::sin(6 * w) / (12 * w)), 1e-7);
    EXPECT_NEAR(result.numbers[2], 0.3 * (std::cos(3 * w) - 1), 1e-7) << "the way";
  }
  EXPECT_THROW(planned("peak: [slide.rate.max]"), SceneError);
  EXPECT_THROW(planned("final: [slyde.rate.max]"), SceneError);
}

/// x = 0.1 + 0.3 t + t²/2m at 2 s: the root of x − 1 is no number where the block is heavy, and everything else of that
/// case is kept.
TEST(Sweeps, LeaveACellEmptyWhereAResultOfACompletedRunIsNotFinite) {
  const PlanFolder folder;
  folder.write("block.yaml", R"(format: withy/1
time: {end: 2, output: 0.5}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs:
  seen: {type: hinge, hinge: slide}
  root: {type: expression, value: sqrt(seen.position - 1), unit: m}
initial: {hinges: {slide: {position: [0.1], rate: [0.3]}}}
loads: {push: {type: hinge-effort, hinge: slide, law: constant, value: 1}}
)");
  const auto planned = [&](const std::string& design) {
    folder.write("root.yaml", "format: withy-sweep/1\nscene: block.yaml\nvary: {bodies.block.mass: {grid: [2, 20]}}\n" +
                                  design + "keep: {final: [root, slide]}\n");
    return read_plan((folder / "root.yaml").string(), plugins());
  };
  const Plan plan = planned("");
  EXPECT_TRUE(run(folder, plan, "root", {1, 1, 1, {}}).whole());
  EXPECT_EQ(collect(folder / "root").failed, 0U);
  std::istringstream table(table_of(folder, "root"));
  std::string line;
  std::getline(table, line);
  std::getline(table, line);
  ASSERT_THAT(line, testing::StartsWith("0,completed,2,"));
  EXPECT_NEAR(std::stod(line.substr(14)), std::sqrt(0.7), 1e-8);
  std::getline(table, line);
  ASSERT_THAT(line, testing::StartsWith("1,completed,20,,"));
  EXPECT_NEAR(std::stod(line.substr(16)), 0.8, 1e-8);
  const auto alone = case_json(plan, run_case(plan, Cases(plan), 1, plugins(), {}));
  EXPECT_EQ(alone.at("status"), "completed");
  EXPECT_TRUE(alone.at("results").at("final.root[m]").is_null());
  // What differs from nothing known has no row.
  const Plan alone_each = planned("design: one-at-a-time\n");
  run(folder, alone_each, "each", {1, 1, 1, {}});
  EXPECT_TRUE(collect(folder / "each").indices);
  const std::string indices = folder.read("each/indices.csv");
  EXPECT_THAT(indices, HasSubstr("final.root[m],bodies.block.mass,2,"));
  EXPECT_THAT(indices, testing::Not(HasSubstr("final.root[m],bodies.block.mass,20,")));
  EXPECT_THAT(indices, HasSubstr("final.slide[m],bodies.block.mass,20,"));
}

/// A result that no case has a number of has no effect of anything, which is not one of zero.
TEST(Sweeps, HaveNoRowOfAMorrisMeasureThatNothingIsKnownOf) {
  const PlanFolder folder;
  folder.write("block.yaml", R"(format: withy/1
time: {end: 2, output: 1}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs: {none: {type: expression, value: sqrt(-1 - t)}}
loads: {push: {type: hinge-effort, hinge: slide, law: constant, value: 1}}
)");
  folder.write("none.yaml", R"(format: withy-sweep/1
scene: block.yaml
vary: {bodies.block.mass: {uniform: {from: 2, to: 20}}}
cases: 4
design: morris
keep: {final: [none, slide]}
)");
  run(folder, read_plan((folder / "none.yaml").string(), plugins()), "morris", {1, 1, 1, {}});
  EXPECT_TRUE(collect(folder / "morris").indices);
  const std::string indices = folder.read("morris/indices.csv");
  EXPECT_THAT(indices, HasSubstr("final.slide[m],bodies.block.mass,"));
  EXPECT_THAT(indices, testing::Not(HasSubstr("final.none")));
}

/// 31 points of the grid and two results: 62 histories.
TEST(Sweeps, SayHowManyOfTheirHistoriesThePictureAndThePageHave) {
  const PlanFolder folder;
  const Plan plan = folder.plan(R"(vary:
  bodies.rod.mass: {grid: {from: 1, to: 2, count: 31}}
  initial.hinges.pivot.rate.0: {uniform: {from: 0, to: 1}}
cases: 2
keep: {history: {of: [pivot, pivot.rate], every: 0.25}}
)");
  EXPECT_TRUE(run(folder, plan, "many", {1, 1, 1, {}}).whole());
  const Collected collected = collect(folder / "many");
  EXPECT_THAT(folder.read("many/histories.svg"), HasSubstr(": the first 12 of 62, histories.csv has all<"));
  EXPECT_THAT(folder.read("many/histories.svg"), HasSubstr(">pivot[rad] at bodies.rod.mass = 1.03333<"));
  const auto page = sweep_page(folder / "many", collected);
  EXPECT_EQ(page.at("histories").size(), 60U);
  EXPECT_EQ(page.at("histories_in_all"), 62);
}

/// Of 600 × 2 cases the page shows 1000, as many of either level: every second in the order of the plan would be of
/// one.
TEST(Sweeps, ShowCasesOfEveryLevelWhereThePageHasNotAll) {
  const PlanFolder folder;
  const Plan plan = folder.plan(R"(vary:
  bodies.rod.mass: {grid: {from: 1, to: 2, count: 600}}
  gravity.1: {grid: [-9, -8]}
keep: {final: [pivot]}
)");
  const Store store(folder / "store", plan, false);
  const Cases cases(plan);
  {
    SegmentWriter writer(store.segment(1, 1, 0), plan.fingerprint);
    for (std::uint64_t i = 0; i < cases.size(); ++i) writer.append({i, "completed", "", cases.values(i), {0.5}, 0});
  }
  const Collected collected = collect(store.path());
  const auto page = sweep_page(store.path(), collected);
  EXPECT_EQ(page.at("counted"), 1200);
  const auto& rows = page.at("sample").at("rows");
  ASSERT_EQ(rows.size(), 1000U);
  const auto heavy =
      std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.at("values").at(1) == -9; });
  EXPECT_NEAR(static_cast<double>(heavy), 500, 30);  // deviation of a sample without replacement: 6.5
}

/// Titles tell levels as people read them, and a map as JSON without the quotes of CSV.
TEST(HistoriesPictures, TellWhatTheCasesOfAPointShare) {
  const CaseValues values = {Value(0.17453292519943295), std::nullopt, Value(std::string(R"({"damping":1.0})")),
                             Value()};
  EXPECT_EQ(title_of_point({"a", "b", "loads.drag", "c"}, values),
            R"(a = 0.174533, loads.drag = {"damping":1.0}, c = null)");
}

/// A name that stands for many columns, as that of a body for its modes, stands for those of the plan's scene in every
/// case: one with more modes keeps no others, one with fewer says what it lacks, and every number is under its own
/// name.
TEST(Sweeps, KeepTheSameColumnsOfCasesThatHaveOthers) {
  const PlanFolder folder;
  folder.write("boom.yaml", R"(format: withy/1
time: {end: 0.5, output: 0.1}
gravity: [0, -9.81, 0]
bodies: {boom: {type: beam, length: 2, mass_per_length: 1, bending_y: {stiffness: 900, modes: 2}}}
hinges: {pin: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
)");
  folder.write("modes.yaml",
               "format: withy-sweep/1\nscene: boom.yaml\nvary: {bodies.boom.bending_y.modes: {grid: [2, 3, 1]}}\n"
               "keep: {final: [boom, pin.rate], peak: [boom], history: [boom, pin]}\n");
  const Plan plan = read_plan((folder / "modes.yaml").string(), plugins());
  EXPECT_TRUE(run(folder, plan, "modes", {1, 1, 1, {}}).whole());
  std::istringstream table(table_of(folder, "modes"));
  std::string head, rows[3];
  std::getline(table, head);
  for (std::string& row : rows) std::getline(table, row);
  const auto number = [&](const std::string& row, const std::string& column) {
    const auto before = std::count(head.begin(), head.begin() + static_cast<std::ptrdiff_t>(head.find(column)), ',');
    std::size_t at = 0;
    for (std::ptrdiff_t i = 0; i < before; ++i) at = row.find(',', at) + 1;
    return std::stod(row.substr(at));
  };
  ASSERT_THAT(head, HasSubstr("final.boom.bending_y.2"));
  for (const char* column : {"final.pin.rate[", "final.boom.tip.x[", "peak.boom.tip.y["})
    EXPECT_NEAR(number(rows[1], column), number(rows[0], column), 0.02 * std::abs(number(rows[0], column))) << column;
  EXPECT_THAT(folder.read("modes/failed.csv"), HasSubstr("the model of this case has no \"\"boom.bending_y.2\"\""));
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

/// A column stands elsewhere in the table of a case with other modes: its number is that of a plan whose own scene has
/// these.
TEST(KeptNumbers, AreFoundWhereTheColumnsOfACaseAreOthersThanThePlans) {
  const PlanFolder folder;
  const auto kept = [&](const std::string& set, const std::string& modes, std::uint64_t index) {
    folder.write("modes.yaml", "format: withy-sweep/1\nscene: " WITHY_SOURCES
                               "/scenes/driven-arm.yaml\nset: {time.end: 0.2" +
                                   set + "}\nvary: {bodies.link1.bending_y.modes: {grid: " + modes +
                                   "}}\nkeep: {final: [elbow.rate, link2.tip], peak: [link1.tip.deflection_y]}\n");
    const Plan plan = read_plan((folder / "modes.yaml").string(), plugins());
    const CaseResult result = run_case(plan, Cases(plan), index, plugins(), {});
    EXPECT_TRUE(result.completed()) << result.message;
    return result.numbers;
  };
  for (std::uint64_t i = 0; i < 3; ++i) {
    const std::string modes = std::to_string(i + 1);
    EXPECT_EQ(kept("", "[1, 2, 3]", i), kept(", bodies.link1.bending_y.modes: " + modes, "[" + modes + "]", 0));
  }
}

}  // namespace
}  // namespace withy::campaign
