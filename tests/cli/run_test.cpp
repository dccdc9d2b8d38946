#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "withy/tests/cli/process.hpp"
#include "withy/tests/results/cells.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Diverges at about 0.05 s (theory: the inconsistent formulation at time scale 1).
const std::vector<std::string> diverging = {
    "run", "scenes/two-link-slew.yaml", "--formulation", "inconsistent", "--out", "out"};

/// The cells below the head of a table.
std::vector<std::string> all_cells(const std::string& table) {
  std::vector<std::string> all;
  const auto rows = lines(table);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto row = cells(rows[i]);
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

/// CVODE keeps the Jacobian of its first steps, which from rest are nearly nothing: what was rounding in them held the
/// arm where it was, and the run was *completed*.
TEST(Run, EveryMethodMovesAnArmThatIsAtRestBeforeItIsPulled) {
  const Folder folder;
  std::vector<std::string> integrators = {"dopri5", "radau", "imex"};
  if (WITHY_HAS_CVODE) {
    integrators.emplace_back("{name: cvode, rtol: 1e-6, atol: 1e-9}");
    integrators.emplace_back("{name: cvode, rtol: 1e-6, atol: 1e-9, method: adams}");
    integrators.emplace_back("{name: cvode, rtol: 1e-6, atol: 1e-9, jacobian: exact}");
  }
  for (const std::string& integrator : integrators) {
    const Finished f = withy(folder, {"run", "scenes/commanded-arm.yaml", "--set", "integrator=" + integrator,
                                      "--estimate", "never", "--out", "out", "--force"});
    ASSERT_EQ(f.status, 0) << f.err;
    const auto last = cells(lines(folder.read("out/results.csv")).back());
    EXPECT_NEAR(std::stod(last.at(1)), 0.58143, 2e-4) << integrator;  // the shoulder, by dopri5 at 1e-9
  }
}

/// Which hinges are locked is a number in the state. Between the ends of steps it was interpolated, with some methods
/// to a rounding below 1, which is another lock: rows at random told reactions of an unlocked arm.
TEST(Run, TellsTheSameReactionsOfLockedHingesWithEveryMethod) {
  const Folder folder;
  const auto elbow = [&](const std::string& integrator) {
    const Finished f = withy(folder, {"run", "scenes/boom-latch.yaml", "--set", "time.end=1.5", "--set",
                                      "integrator=" + integrator, "--estimate", "never", "--out", "out", "--force"});
    EXPECT_EQ(f.status, 0) << f.err;
    const auto rows = lines(folder.read("out/results.csv"));
    const auto head = cells(rows.front());
    const auto column =
        static_cast<std::size_t>(std::find(head.begin(), head.end(), "elbow_load.fy[N]") - head.begin());
    std::vector<double> values;
    for (std::size_t i = 1; i < rows.size(); ++i) values.push_back(std::stod(cells(rows[i]).at(column)));
    return values;
  };
  std::vector<std::string> integrators = {"radau",
                                          "imex",
                                          "rosenbrock-w",
                                          "rk4-adaptive",
                                          "{name: rk4, step: 2 ms}",
                                          "{name: gauss, step: 5 ms}",
                                          "{name: generalized-alpha, step: 1 ms}"};
  if (WITHY_HAS_CVODE) integrators.emplace_back("{name: cvode, rtol: 1e-6, atol: 1e-9}");
  const std::vector<double> right = elbow("{name: dopri5, rtol: 1e-9, atol: 1e-12}");
  ASSERT_EQ(right.size(), 31U);
  for (const std::string& integrator : integrators) {
    const std::vector<double> found = elbow(integrator);
    ASSERT_EQ(found.size(), right.size());
    // The arm pulls with up to 0.04 N; unlocked it would with 7 N.
    for (std::size_t i = 0; i < right.size(); ++i) EXPECT_NEAR(found[i], right[i], 1e-3) << integrator << ", row " << i;
  }
}

/// The arm is unlocked at 2 s, where a row stands: until then its elbow bears next to nothing, from then on its spring.
TEST(Run, ARowAtAnEventShowsWhatWasUntilThen) {
  const Folder folder;
  const Finished f =
      withy(folder, {"run", "scenes/boom-latch.yaml", "--set", "time.end=2.1", "--estimate", "never", "--out", "out"});
  ASSERT_EQ(f.status, 0) << f.err;
  const auto rows = lines(folder.read("out/results.csv"));
  const auto head = cells(rows.front());
  const auto column =
      static_cast<std::size_t>(std::find(head.begin(), head.end(), "elbow_load.mz[N m]") - head.begin());
  const auto moment = [&](std::size_t row) { return std::abs(std::stod(cells(rows.at(row + 1)).at(column))); };
  EXPECT_EQ(cells(rows.at(41)).front(), "2");
  EXPECT_LT(moment(40), 0.2) << "N m";
  EXPECT_GT(moment(41), 2) << "N m, 0.05 s later";
}

/// The same names in every command; their numbers are those of sensors that a scene defines.
TEST(Run, AddsOutputsByNamesThatSayWhatTheyAre) {
  const Folder folder;
  const std::vector<std::string> scene = {"scenes/loads-of-the-slew.yaml", "--set", "time.end=0.1"};
  const auto run = [&](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), scene.begin(), scene.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return withy(folder, arguments);
  };
  Finished f = run({"run"}, {"--output", "link1.section@0.mz,shoulder.effort,shoulder,elbow", "--out", "one"});
  ASSERT_EQ(f.status, 0) << f.err;
  const auto rows = lines(folder.read("one/results.csv"));
  const auto head = cells(rows.front()), last = cells(rows.back());
  const auto cell = [&](const std::string& name) {
    const auto at = static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin());
    return at < last.size() ? last[at] : "no " + name;
  };
  EXPECT_EQ(cell("link1.section@0.mz[N m]"), cell("root.mz[N m]"));
  EXPECT_EQ(cell("shoulder.effort[N m]"), cell("shoulder_torque[N m]"));
  EXPECT_EQ(json::parse(folder.read("one/run.json")).at("set"),
            json({"time.end=0.1", "outputs=link1.section@0.mz", "outputs=shoulder.effort"}));
  f = run({"run"}, {"--output", "shoulder.efort"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("--output: no 'shoulder.efort'; did you mean 'shoulder.effort'?"));
  // Every name that is wrong is told, by each command in its words.
  const std::string wrong = "shoulder.efort,elbow.rat";
  f = run({"run"}, {"--output", wrong + ",nowhere"});
  EXPECT_THAT(f.err, HasSubstr("--output: no 'shoulder.efort' (did you mean 'shoulder.effort'?), no 'elbow.rat' (did "
                               "you mean 'elbow.rate'?), no 'nowhere'; known: "));
  f = run({"linearize"}, {"--outputs", "link2.tp.x,elbow.0.rat"});
  EXPECT_THAT(f.err, HasSubstr("--outputs: no 'link2.tp.x' (did you mean 'link2.tip.x'?), no 'elbow.0.rat' (did you "
                               "mean 'elbow.0.rate'?)"));
  f = run({"compare"}, {"--formulations", "quadratic,linear", "--output", "link2.tp,elbw"});
  EXPECT_THAT(f.err, HasSubstr("got 'link2.tp' (did you mean 'link2.tip'?), 'elbw' (did you mean 'elbow'?)"));
  f = run({"compare"}, {"--formulations", "quadratic,linear", "--output", "root.mz,link1.section@0.mz", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json errors = json::parse(f.out).at("runs")[1].at("outputs");
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[1].at("output"), "link1.section@0.mz");
  EXPECT_EQ(errors[0].at("distance"), errors[1].at("distance"));
  f = run({"linearize"}, {"--input", "shoulder", "--output", "root.mz,link1.section@0.mz"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json linear = json::parse(f.out);
  EXPECT_EQ(linear.at("C")[0], linear.at("C")[1]);
  f = run({"response"}, {"--input", "shoulder", "--output", "link1.section@0.mz", "--json"});
  EXPECT_EQ(f.status, 0) << f.err;
}

TEST(Run, OfClosedLoopsAndOfActingEventsLeavesWhatTheyDid) {
  const Folder folder;
  Finished f = withy(folder, {"run", "scenes/gallery/four-bar.yaml", "--set", "time.end=0.1", "--out", "loop"});
  ASSERT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(folder.read("loop/run.json"),
              testing::ContainsRegex("Loops were closed at the start: positions changed, most 'pivot' by [0-9.]+ rad; "
                                     "speeds too, most 'elbow' by [0-9.]+ rad/s"));
  EXPECT_THAT(lines(folder.read("loop/results.csv")).front(), HasSubstr("pin.fx[N]"));
  f = withy(folder, {"run", "scenes/boom-latch.yaml", "--set", "time.end=6", "--out", "latch"});
  ASSERT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("energy lost in elbow_latch"));
  EXPECT_EQ(json::parse(folder.read("latch/run.json")).at("events").size(), 4U) << "three at times, the elbow's latch";
  // The cover hangs on its weld until it is released, whatever else is locked at first.
  const auto rows = lines(folder.read("latch/results.csv"));
  const auto head = cells(rows.front());
  const auto y = static_cast<std::size_t>(std::find(head.begin(), head.end(), "clasp.y[m]") - head.begin());
  ASSERT_LT(y, head.size());
  EXPECT_EQ(cells(rows.at(11)).at(y), "0") << "at 0.5 s";
  EXPECT_LT(std::stod(cells(rows.at(41)).at(y)), -0.1) << "at 2 s";
}

/// Sensors look at accepted states: a run goes the same way with and without them, to the last digit.
// In a table of two columns of one name neither could be told from the other.
TEST(Run, NoHingeHasTheNameOfAColumnThatEveryTableHas) {
  const Folder folder;
  const auto scene = [](const std::string& hinge) {
    return "format: withy/1\ntime: {end: 0.1, output: 0.1}\nbodies: {rod: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, "
           "0, "
           "0]}}\nhinges: {" +
           hinge + ": {type: free, parent: world, child: rod}}\n";
  };
  folder.write("s.yaml", scene("float"));
  ASSERT_EQ(withy(folder, {"run", "s.yaml", "--out", "out"}).status, 0);
  std::set<std::string> common;
  for (const std::string& column : cells(lines(folder.read("out/results.csv")).at(0)))
    if (!column.starts_with("float")) common.insert(column.substr(0, column.find_first_of(".[")));
  EXPECT_EQ(common.size(), 6U);
  for (const std::string& name : common) {
    folder.write("s.yaml", scene(name));
    const Finished f = withy(folder, {"check", "s.yaml"});
    EXPECT_EQ(f.status, 2) << name;
    EXPECT_THAT(f.err, HasSubstr("s.yaml:4:10: /hinges/" + name));
  }
}

TEST(Run, OutputsAreColumnsAndChangeNothingElse) {
  const Folder folder;
  const std::vector<std::string> first_second = {"--set", "time.end=1", "--set", "time.output=0.02", "--out"};
  const auto table_of = [&](const std::string& scene) {
    std::vector<std::string> arguments = {"run", "scenes/" + scene + ".yaml"};
    arguments.insert(arguments.end(), first_second.begin(), first_second.end());
    arguments.push_back(scene);
    const Finished f = withy(folder, arguments);
    EXPECT_EQ(f.status, 0) << f.err;
    return lines(folder.read(scene + "/results.csv"));
  };
  const auto without = table_of("two-link-slew"), with = table_of("loads-of-the-slew");
  ASSERT_EQ(without.size(), with.size());
  for (std::size_t i = 0; i < with.size(); ++i) EXPECT_EQ(with[i].substr(0, without[i].size() + 1), without[i] + ",");
  EXPECT_THAT(with[0], HasSubstr(",shoulder_torque[N m],elbow_torque[N m],elbow_load.fx[N],"));
  EXPECT_THAT(with[0], HasSubstr(",root.stress_z[Pa],middle.fx[N],"));
  EXPECT_THAT(with[0], testing::EndsWith(",tip.wz[rad/s],speed[m/s],box.x[m/s^2],box.y[m/s^2],box.z[m/s^2]"));
  const auto head = cells(with[0]);
  const auto at = [&](const std::string& name, std::size_t row) {
    const auto found = std::find(head.begin(), head.end(), name);
    EXPECT_NE(found, head.end()) << name;
    return std::stod(cells(with[row])[static_cast<std::size_t>(found - head.begin())]);
  };
  for (const std::size_t row : {std::size_t{5}, std::size_t{20}, with.size() - 1}) {
    // Through the elbow goes what its motor does, and the root of link 1 carries what the weld there does.
    EXPECT_NEAR(at("elbow_load.mz[N m]", row), at("elbow_torque[N m]", row), 1e-9);
    EXPECT_NEAR(at("root.mz[N m]", row), at("root_load.mz[N m]", row), 1e-9);
    EXPECT_NEAR(at("root_load.fz[N]", row), 0, 1e-9);
  }
}

TEST(Run, RunJsonHoldsWhatTheContractNames) {
  const Folder folder;
  const Finished f = withy(folder, {"run", "scenes/two-link-slew.yaml", "--set", "time.end=0.1", "--out", "out"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json run = json::parse(folder.read("out/run.json"));
  EXPECT_EQ(run.at("scene"), "scenes/two-link-slew.yaml");
  EXPECT_EQ(run.at("formulation"), "quadratic");
  EXPECT_TRUE(run.at("integrator").is_string());
  EXPECT_EQ(run.at("status"), "completed");
  EXPECT_TRUE(run.at("message").is_string());
  EXPECT_EQ(run.at("t_end"), 0.1);
  for (const char* hinge : {"shoulder", "elbow"}) {
    EXPECT_EQ(run.at("final").at("hinges").at(hinge).at("position").size(), 1U);
    EXPECT_EQ(run.at("peaks").at("effort").at(hinge).size(), 1U);
  }
  for (const char* beam : {"link1", "link2"}) {
    EXPECT_EQ(run.at("final").at("bodies").at(beam).at("modes").size(), 2U);
    EXPECT_GT(run.at("peaks").at("tip_deflection").at(beam).at("y"), 0.0);
    EXPECT_EQ(run.at("peaks").at("tip_deflection").at(beam).at("z"), 0.0) << "the arm moves in its plane";
  }
  for (const char* number : {"energy_drift", "cpu_seconds", "condition"}) EXPECT_TRUE(run.at(number).is_number());
  for (const char* count : {"steps", "rejected_steps", "evaluations"}) EXPECT_TRUE(run.at(count).is_number_unsigned());
  EXPECT_GT(run.at("evaluations"), run.at("steps"));
  EXPECT_EQ(run.at("determinant_sign"), 1) << "a Gram matrix";
  const json& certificate = run.at("certificate");
  EXPECT_EQ(certificate.at("formulation").at("name"), "quadratic");
  EXPECT_EQ(certificate.at("integrator").at("name"), run.at("integrator"));
  EXPECT_GT(certificate.at("acceleration_rounding"), 0);
  EXPECT_LT(certificate.at("acceleration_rounding"), 10 * run.at("condition").get<double>() * std::ldexp(1.0, -52));
}

TEST(Run, JsonOnStandardOutputIsRunJson) {
  const Folder folder;
  const Finished f = withy(folder, {"run", "scenes/pendulum.yaml", "--json", "--out", "out"});
  ASSERT_EQ(f.status, 0) << f.err;
  EXPECT_EQ(f.out, folder.read("out/run.json"));
}

TEST(Run, ResultsHaveOneRowAnOutputAndEveryColumnANumber) {
  const Folder folder;
  const Finished f = withy(
      folder, {"run", "scenes/spacecraft.yaml", "--set", "time.end=0.25", "--set", "time.output=0.1", "--out", "out"});
  ASSERT_EQ(f.status, 0) << f.err;
  const auto rows = lines(folder.read("out/results.csv"));
  ASSERT_EQ(rows.size(), 1U + 4U) << "head; 0, 0.1, 0.2 and the end";
  const auto head = cells(rows[0]);
  EXPECT_EQ(head[0], "t[s]");
  for (const std::string column : {"kinetic_energy[J]", "potential_energy[J]", "work[J]", "linear_momentum.x[kg m/s]",
                                   "angular_momentum.z[kg m^2/s]"}) {
    EXPECT_THAT(head, testing::Contains(column));
  }
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto row = cells(rows[i]);
    ASSERT_EQ(row.size(), head.size());
    for (const std::string& cell : row) {
      std::size_t read = 0;
      EXPECT_TRUE(std::isfinite(std::stod(cell, &read)));
      EXPECT_EQ(read, cell.size());
    }
  }
  EXPECT_EQ(cells(rows[4])[0], "0.25");
}

TEST(Run, ResultsNameArmColumnsWithUnits) {
  const Folder folder;
  ASSERT_EQ(withy(folder, {"run", "scenes/two-link-slew.yaml", "--set", "time.end=0.02", "--out", "out"}).status, 0);
  const auto head = cells(lines(folder.read("out/results.csv")).at(0));
  EXPECT_THAT(std::vector<std::string>(head.begin(), head.begin() + 7),
              testing::ElementsAre("t[s]", "shoulder[rad]", "elbow[rad]", "link1.bending_y.1[1]",
                                   "link1.bending_y.2[1]", "link2.bending_y.1[1]", "link2.bending_y.2[1]"));
  for (const std::string column :
       {"shoulder.rate[rad/s]", "link2.bending_y.2.rate[1/s]", "link1.tip.deflection_y[m]", "link2.tip.x[m]"}) {
    EXPECT_THAT(head, testing::Contains(column));
  }
}

TEST(Run, WithoutOutTheFolderIsNamedAfterSceneAndFormulation) {
  const Folder folder;
  const Finished f = withy(folder, {"run", "scenes/pendulum.yaml", "--formulation", "ruthless"});
  ASSERT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("results/pendulum-ruthless"));
  EXPECT_EQ(json::parse(folder.read("results/pendulum-ruthless/run.json")).at("status"), "completed");
}

TEST(Run, SetChangesTheScene) {
  const Folder folder;
  const auto end = [&](const std::string& value) {
    const Finished f = withy(folder, {"run", "scenes/pendulum.yaml", "--json", "--set", "time.end=" + value});
    return json::parse(f.out).at("t_end").get<double>();
  };
  EXPECT_EQ(end("0.5"), 0.5);
  EXPECT_EQ(end("\"25 ms\""), 0.025);
}

TEST(Run, OneThatStopsExplainsItselfAndKeepsItsResults) {
  const Folder folder;
  const Finished f = withy(folder, diverging);
  EXPECT_EQ(f.status, 1);
  const json run = json::parse(folder.read("out/run.json"));
  EXPECT_THAT(run.at("status"), testing::AnyOf("diverged", "singular"));
  EXPECT_GT(run.at("t_end"), 0.0);
  EXPECT_LT(run.at("t_end"), 0.5);
  const std::string message = run.at("message");
  EXPECT_NE(message, "");
  EXPECT_THAT(f.err, HasSubstr(message));
  EXPECT_THAT(f.out, HasSubstr(run.at("status").get<std::string>()));
  EXPECT_GE(lines(folder.read("out/results.csv")).size(), 3U);
  for (const std::string& cell : all_cells(folder.read("out/results.csv"))) {
    EXPECT_TRUE(std::isfinite(std::stod(cell))) << cell;
  }
}

TEST(Run, AnInterruptKeepsTheResultsAndExits130) {
  const Folder folder;
  Process process(folder, {WITHY_PROGRAM, "run", "scenes/pendulum.yaml", "--set", "time.end=1e6", "--out", "out"});
  // The simulation is under way once outputs follow the head.
  comes_true([&] { return lines(folder.read("out/results.csv")).size() >= 3; });
  ::kill(process.id(), SIGINT);
  const Finished f = process.wait();
  EXPECT_EQ(f.status, 130) << f.err;
  const json run = json::parse(folder.read("out/run.json"));
  EXPECT_EQ(run.at("status"), "interrupted");
  EXPECT_GT(run.at("t_end"), 0.0);
}

}  // namespace
}  // namespace withy::test
