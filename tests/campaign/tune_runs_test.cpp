// How a fit reads its runs: as the rows of `run` show them, at instants too; and what it says where runs fail.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "withy/campaign/matched_run.hpp"
#include "withy/campaign/tune.hpp"
#include "withy/results/csv.hpp"
#include "withy/results/result_columns.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::campaign {
namespace {

using testing::HasSubstr;

/// A link that turns; rows fall on 0.15, 0.3 and so on, some of them a rounding beside the multiples of 0.15 or 0.1.
constexpr const char* link = R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
time: {end: 2, output: 0.05}
bodies: {link: {type: rigid, mass: 1, center_of_mass: [1, 0, 0], inertia: [0.5, 0.5, 1, 0, 0, 0]}}
hinges: {j: {type: revolute, axis: [0, 0, 1], parent: world, child: link}}
)";
constexpr const char* shown =
    "outputs: {a: {type: hinge, hinge: j}, e: {type: effort, hinge: j}, m: {type: accelerometer, of: link}}\n";
constexpr const char* sampled =
    "loads: {l: {type: pd-controller, sample: 0.15, duration: 1.5, hinges: {j: {to: 1, stiffness: 20, damping: 6}}}}\n";

/// The rows of a run as a table of results has them. \param time how times are written; until [s] rows are kept
std::string rows_of(const SceneValues& values, const std::string& time = "{}", double until = 1e9) {
  const study::Prepared prepared = study::prepare(values, test::plugins());
  ResultColumns results(prepared.model(), *prepared.equations, prepared.scene.outputs);
  std::string text = csv_head(results.columns());
  study::RunSettings settings;
  settings.look_beyond = false;
  settings.output = [&](const State& state, std::size_t) {
    const std::string line = csv_line(results.row(state));
    if (state.time <= until + 1e-9) text += fmt::format(fmt::runtime(time), state.time) + line.substr(line.find(','));
  };
  study::run(prepared, test::plugins(), settings);
  return text;
}

/// Compares the run of a fit with what a table has of it.
void expect_the_same(const SceneValues& values, const std::string& text, double apart) {
  const study::Prepared prepared = study::prepare(values, test::plugins());
  const ResultColumns results(prepared.model(), *prepared.equations, prepared.scene.outputs);
  std::vector<std::string> problems;
  const Measured data = read_measured(
      {"rows.csv", {}, {}, prepared.scene.initial.time, prepared.scene.end.value(), text}, results.columns(), problems);
  ASSERT_THAT(problems, testing::IsEmpty());
  const MatchedRun run = matched_run(values, test::plugins(), data, {});
  ASSERT_TRUE(run.ok()) << run.failure;
  for (std::size_t c = 0; c < data.columns.size(); ++c) {
    ASSERT_EQ(run.columns[c].size(), data.times.size());
    for (std::size_t i = 0; i < data.times.size(); ++i)
      EXPECT_NEAR(run.columns[c][i], data.columns[c].values[i], apart * (1 + std::abs(data.columns[c].values[i])))
          << data.columns[c].name << " at " << fmt::format("{}", data.times[i]);
  }
}

const std::vector<std::string> scenes_with_instants = {
    std::string(sampled) + shown,
    // The run ends at a sample.
    std::string("loads: {l: {type: pd-controller, sample: 0.1, duration: 1.5, hinges: {j: {to: 1, stiffness: 20, "
                "damping: 6}}}}\n") +
        shown,
    std::string("loads: {l: {type: hinge-effort, hinge: j, value: 2}}\nevents: {x: {at: 0.3, do: {lock: j}}, y: {at: "
                "0.7, do: {unlock: j}}, z: {at: 1.2, do: {set: loads.l.value=-3}}}\n") +
        shown,
    std::string("loads: {l: {type: hinge-effort, hinge: j, law: steps, table: [[0.15, 1], [0.3, -2], [0.6, 3], [0.7, "
                "0.5], [1.4, 2]]}}\n") +
        shown,
    std::string("initial: {hinges: {j: {position: [0.3]}}}\nloads: {l: {type: hinge-relay, hinge: j, effort: 2, on: "
                "0.1, off: 0.02, rate_time: 0.5}}\n") +
        shown,
    "loads: {n: {type: noise, deviation: 0.02, seed: 5, sample: 0.15, of: j}, l: {type: pid, of: n, to: nothing, "
    "proportional: 20, sample: 0.15, reference: 1}, a: {type: actuator, of: l, hinge: j, frequency: 10}}\n"
    "outputs: {c: {type: control, of: l}, n2: {type: control, of: n}}\n",
    // The run ends at an event, which changes the state: its last row is the state from then on.
    std::string("loads: {l: {type: hinge-effort, hinge: j, value: 2}}\nevents: {x: {hinge: j, value: 0.4, stop: true, "
                "do: {lock: j}}}\n") +
        shown};

/// With an integrator that chooses its steps, or divides what it is given into equal ones.
std::vector<SceneValues> with_both_kinds_of_steps(const std::string& scene) {
  std::string equal = link + scene;
  const std::string chosen = "{name: dopri5, rtol: 1e-9, atol: 1e-11}";
  equal.replace(equal.find(chosen), chosen.size(), "{name: rk4, step: 0.007}");
  return {SceneValues::parse(link + scene, "link.yaml"), SceneValues::parse(equal, "link.yaml")};
}

TEST(TuneRuns, AreThoseOfRunToTheLastBitAtInstantsToo) {
  for (const std::string& scene : scenes_with_instants)
    for (const SceneValues& values : with_both_kinds_of_steps(scene)) {
      SCOPED_TRACE(scene);
      expect_the_same(values, rows_of(values), 0);
    }
}

// Data that end before the scene does, and times as people write them.
TEST(TuneRuns, AreThoseOfRunInPartsAndAtTimesOfFewDigits) {
  for (const std::string& scene : scenes_with_instants)
    for (const SceneValues& values : with_both_kinds_of_steps(scene)) {
      SCOPED_TRACE(scene);
      for (const double until : {0.3, 0.6}) expect_the_same(values, rows_of(values, "{}", until), 0);
      if (scene.find("stop") == std::string::npos) expect_the_same(values, rows_of(values, "{:g}"), 1e-9);
    }
}

TEST(TuneRuns, AreThoseOfRunWhereABoomLatches) {
  SceneValues values = SceneValues::read(WITHY_SOURCES "/scenes/boom-latch.yaml");
  for (const char* change : {"time.end=3", "time.output=0.1"}) values.set_text(change);
  expect_the_same(values, rows_of(values), 0);
}

TuneResult fit(const std::string& scene, const std::string& data, const std::vector<std::string>& parameters,
               const std::vector<std::string>& outputs) {
  TuneQuestion question;
  question.data = "rows.csv";
  question.text = data;
  question.parameters = parameters;
  question.outputs = outputs;
  return tune(study::prepare(SceneValues::parse(scene, "scene.yaml"), test::plugins()), test::plugins(), question);
}

TEST(TuneRuns, GainsOfASampledControllerAreFoundInItsRows) {
  const std::string scene = std::string(link) + sampled + shown;
  const SceneValues truth = SceneValues::parse(scene, "link.yaml");
  SceneValues other = truth;
  for (const char* change : {"loads.l.hinges.j.stiffness=18", "loads.l.hinges.j.damping=5"}) other.set_text(change);
  TuneQuestion question;
  question.data = "rows.csv";
  question.text = rows_of(truth, "{:g}");
  question.parameters = {"loads.l.hinges.j.stiffness", "loads.l.hinges.j.damping"};
  const TuneResult result = tune(study::prepare(other, test::plugins()), test::plugins(), question);
  ASSERT_TRUE(result.converged()) << result.trouble;
  EXPECT_NEAR(result.parameters[0].value, 20, 1e-5);
  EXPECT_NEAR(result.parameters[1].value, 6, 1e-5);
  // Also where nothing is left of the residuals.
  EXPECT_GT(std::abs(result.correlation[1][0]), 1e-3) << result.after;
}

constexpr const char* pendulum = R"(format: withy/1
gravity: [0, -9.81, 0]
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-10}
time: {end: 0.46, output: 0.02}
bodies: {rod: {type: rigid, mass: 1.2, center_of_mass: [0, -0.4, 0], inertia: [0.1, 0, 0.1, 0, 0, 0]}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}}
initial: {hinges: {pivot: {position: ["60 deg"]}}}
)";

// The residual falls towards the values that made the data, but on the way there an event begins to end the runs.
TEST(TuneRuns, ASearchThatFailuresHoldUpHasNotConverged) {
  const std::string data = rows_of(SceneValues::parse(pendulum, "pendulum.yaml"));
  std::string scene = pendulum;
  scene.replace(scene.find("-0.4, 0]"), 4, "-0.8");
  const std::vector<std::string> parameters = {"bodies.rod.center_of_mass.1"}, outputs = {"pivot"};
  const TuneResult free = fit(scene, data, parameters, outputs);
  ASSERT_TRUE(free.converged()) << free.trouble;
  EXPECT_NEAR(free.parameters[0].value, -0.4, 1e-6);
  EXPECT_TRUE(free.parameters[0].deviation);
  const TuneResult held =
      fit(scene + "events: {z: {hinge: pivot, value: 0, direction: down, stop: true}}\n", data, parameters, outputs);
  EXPECT_EQ(held.trouble, "");
  EXPECT_FALSE(held.converged());
  EXPECT_THAT(held.starts.front().reason, HasSubstr("runs that fail"));
  EXPECT_FALSE(held.parameters[0].deviation);
}

TEST(TuneRuns, ATimeThatIsNoNumberIsRefused) {
  try {
    fit(pendulum, "t[s],pivot[deg]\n0,58\nnan,20\n0.2,-40\n,3\n", {"bodies.rod.mass"}, {});
    ADD_FAILURE() << "nothing was refused";
  } catch (const study::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("rows.csv:3:1: the time is missing"));
    EXPECT_THAT(e.what(), HasSubstr("rows.csv:5:1: the time is missing"));
  }
}

}  // namespace
}  // namespace withy::campaign
