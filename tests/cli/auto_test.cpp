#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json run_json(const Folder& folder) { return json::parse(folder.read("out/run.json")); }

TEST(Auto, TellsItsFormulationsOverTimeAndTheErrorTheyMake) {
  const Folder folder;
  const Finished f = withy(folder, {"run", "scenes/beam-on-base.yaml", "--formulation", "auto", "--out", "out"});
  ASSERT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("asked 1 % of each output's own range; estimated "));
  EXPECT_THAT(f.out, HasSubstr("error                   against "));
  const json run = run_json(folder);
  EXPECT_EQ(run.at("formulation"), "auto");
  const json& stretches = run.at("certificate").at("stretches");
  double end = 0;
  for (const json& stretch : stretches.at("list")) {
    EXPECT_EQ(stretch.at("start"), end) << "they adjoin";
    end = stretch.at("end");
    EXPECT_LE(stretch.at("accuracy_used"), 1);
    const std::string name = stretch.at("formulation");
    EXPECT_GT(stretches.at("evaluations").at(name).at("run"), 0);
    bool listed = false;
    for (const json& plugin : run.at("plugins")) listed = listed || plugin.at("id") == "formulation/" + name;
    EXPECT_TRUE(listed) << name;
  }
  EXPECT_EQ(end, run.at("t_end"));
  EXPECT_FALSE(run.at("certificate").at("estimated_error").is_null());
  // Every output once, whatever the formulation.
  EXPECT_EQ(lines(folder.read("out/results.csv")).size(), 502U);
}

/// A quick slew in half of the time bends more, and needs more than at a hundredth of its speed.
TEST(Auto, AsksMoreOfFormulationsWhereMoreIsAskedOfIt) {
  const Folder folder;
  const auto names = [&](const std::string& accuracy) {
    const Finished f = withy(folder, {"run", "scenes/two-link-slew.yaml", "--formulation", "auto", "--set",
                                      "formulation.accuracy=" + accuracy, "--out", "out", "--force"});
    EXPECT_EQ(f.status, 0) << f.err;
    std::string all;
    const json run = run_json(folder);
    for (const json& s : run.at("certificate").at("stretches").at("list"))
      all += s.at("formulation").get<std::string>() + ' ';
    return all;
  };
  EXPECT_EQ(names("20%"), "ruthless ");
  EXPECT_THAT(names("0.1%"), HasSubstr("quadratic"));
}

/// Long runs have more windows than short ones: each costs a landing of every coarse run.
TEST(Auto, HasAsManyWindowsAsStepsPayFor) {
  const Folder folder;
  const auto windows = [&](const std::string& end) {
    const Finished f = withy(folder, {"run", "scenes/two-link-slew.yaml", "--formulation", "auto", "--set",
                                      "time.end=" + end, "--out", "out", "--force"});
    EXPECT_EQ(f.status, 0) << f.err;
    return run_json(folder).at("certificate").at("stretches").at("windows").get<int>();
  };
  const int of_short = windows("0.5"), of_long = windows("3");
  EXPECT_GE(of_short, 6);
  EXPECT_LE(2 * of_short, of_long) << "six times as long";
  EXPECT_LE(of_long, 24);
}

/// With a load at a frame that modes move `symmetric` costs more than `quadratic`, which holds more.
TEST(Auto, OffersNoRungThatCostsMoreThanTheNext) {
  const Folder folder;
  const auto symmetric = [&](const std::string& loads) {
    const Finished f = withy(folder, {"run", "scenes/spin-up.yaml", "--formulation", "auto", "--set", "time.end=1",
                                      "--set", "loads=" + loads, "--out", "out", "--force"});
    EXPECT_EQ(f.status, 0) << f.err;
    const json run = run_json(folder);
    return run.at("certificate").at("stretches").at("evaluations").contains("symmetric");
  };
  EXPECT_TRUE(symmetric("{}"));
  EXPECT_FALSE(symmetric("{push: {type: force, frame: blade.tip, law: constant, value: [0, 1, 0]}}"));
}

TEST(Auto, SaysWhereTheAccuracyAskedIsBeyondItsHighestFormulation) {
  const Folder folder;
  // A plate has no exact kinematics; this one bends by a good part of its width.
  const Finished f = withy(folder, {"run", "scenes/gallery/spinning-plate.yaml", "--formulation", "auto", "--set",
                                    "formulation.accuracy=1e-6", "--out", "out"});
  EXPECT_EQ(f.status, 1) << f.out;
  EXPECT_EQ(run_json(folder).at("status"), "inaccurate");
  EXPECT_THAT(f.err, HasSubstr("no kinematics is offered that is better"));
}

/// A boom that swings for long without damping: at an instant `exact` adds (0.0043)² = 0.0019 % of the deflection,
/// below a fiftieth of the accuracy, and over 60 s 0.21 % of its range. What is told without it must not pass for held.
TEST(Auto, SaysWhatItHasNotComparedWith) {
  const Folder folder;
  folder.write("swings.yaml", R"(format: withy/1
time: {end: 6, output: 0.05}
integrator: {name: dop853, rtol: 1e-8, atol: 1e-10}
bodies:
  hub: {type: rigid, mass: 5, inertia: [1, 1, 0.1, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 30, modes: 2, family: orthogonal-polynomials}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
loads:
  kick: {type: hinge-effort, hinge: axle, law: steps, table: [[0, 0.2], [0.2, -0.2], [0.4, 0]]}
)");
  const auto stretches = [&](const char* accuracy) {
    const Finished f = withy(folder, {"run", "swings.yaml", "--formulation", "auto", "--set",
                                      std::string("formulation.accuracy=") + accuracy, "--out", "out", "--force"});
    EXPECT_EQ(
        f.out.find("that is against quadratic: what exact changes counts as it is at an instant") != std::string::npos,
        std::string(accuracy) == "0.1%")
        << f.out;
    return run_json(folder).at("certificate").at("stretches");
  };
  const json coarse = stretches("0.1%").at("not_compared");
  EXPECT_EQ(coarse.at("formulation"), "exact");
  EXPECT_NEAR(coarse.at("share_at_an_instant"), 0.0043 * 0.0043, 0.1 * 0.0043 * 0.0043);
  EXPECT_TRUE(stretches("0.02%").at("not_compared").is_null()) << "`exact` is the reference there";
}

TEST(Auto, SampledControllersAndCheckpointsGoOverAnyChange) {
  const Folder folder;
  folder.write("sampled.yaml",
               "format: withy/1\ntime: {end: 1}\nbodies:\n  beam: {type: beam, length: 1, mass_per_length: 1, "
               "bending_y: {stiffness: 20, modes: 2}}\nhinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: "
               "world, child: beam}\nloads:\n  control: {type: pd-controller, law: constant, sample: 0.002, hinges: "
               "{axle: {to: 0.5, stiffness: 0.5, damping: 0.1}}}\n");
  const Finished f = withy(folder, {"run", "sampled.yaml", "--formulation", "auto", "--set",
                                    "formulation.accuracy=0.3%", "--checkpoint", "0", "--out", "out"});
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_GT(run_json(folder).at("certificate").at("stretches").at("list").size(), 1U) << "it has changed";
}

TEST(Auto, IsForAWholeSceneAndNoModelOfATrade) {
  const Folder folder;
  Finished f = withy(folder, {"run", "scenes/spin-up.yaml", "--set", "bodies.blade.formulation=auto"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("name a formulation"));
  f = withy(folder, {"trade", "scenes/spin-up.yaml", "--formulations", "auto"});
  EXPECT_EQ(f.status, 2);
}

}  // namespace
}  // namespace withy::test
