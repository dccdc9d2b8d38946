#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "withy/tests/cli/json_result.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::string blade = "scenes/rotating-blade.yaml";

/// Flap 3.68165, lag √(3.68165² − 1) at η = 1 (docs/modes.md); four modes.
TEST(AnalysisCli, AStateThatAKickBendsFarIsSaidToBe) {
  const Folder folder;
  folder.write("kick.yaml",
               "format: withy/1\ntime: {end: 1}\n"
               "bodies: {boom: {type: beam, length: 10, mass_per_length: 0.5, bending_y: {stiffness: 800, modes: 2}}}\n"
               "hinges: {root: {type: weld, parent: world, child: boom}}\n"
               "loads: {kick: {type: force, frame: boom.tip, law: steps, table: [[0, 0, 100, 0], [0.01, 0, 0, 0]]}}\n");
  for (const char* command : {"modes", "equilibrium"}) {
    const Finished f = withy(folder, {command, "kick.yaml"});
    EXPECT_THAT(f.out, testing::AllOf(testing::HasSubstr("boom.tip is deflected by "),
                                      testing::HasSubstr("the loads (kick) as they are at t = 0 s")))
        << f.err;
    EXPECT_THAT(withy(folder, {command, "kick.yaml", "--set", "loads={}"}).out,
                testing::Not(testing::HasSubstr("is deflected by")));
  }
  EXPECT_THAT(withy(folder, {"modes", "kick.yaml", "--as-is"}).out, testing::Not(testing::HasSubstr("is deflected")));
  EXPECT_THAT(result(folder, {"equilibrium", "kick.yaml", "--json"}).at("bent").get<std::string>(),
              testing::HasSubstr("Beyond 0.1"));
}

TEST(Modes, OfASpinningBladeAreThePublishedOnes) {
  const Folder folder;
  const json j = result(folder, {"modes", blade, "--spin", "axle=1", "--json"});
  const json& modes = j.at("runs").at(0).at("points").at(0).at("modes");
  ASSERT_EQ(modes.size(), 8U) << "the axle is held";
  EXPECT_NEAR(modes[0].at("frequency"), std::sqrt(3.68165 * 3.68165 - 1), 1e-4);
  EXPECT_NEAR(modes[1].at("frequency"), 3.68165, 1e-4);
  EXPECT_EQ(modes[0].at("dominated_by"), "blade.bending_y[1]");
  EXPECT_EQ(modes[1].at("dominated_by"), "blade.bending_z[1]");
  EXPECT_EQ(modes[1].at("state"), "stable");
  const Finished text = withy(folder, {"modes", blade, "--spin", "axle=1"});
  EXPECT_THAT(text.out, HasSubstr("3.68165"));
  EXPECT_THAT(text.out, HasSubstr("blade.bending_z[1]"));
}

TEST(Modes, ASweepKeepsBranchesInTableAndPicture) {
  const Folder folder;
  const Finished f = withy(folder, {"modes", blade, "--formulations", "inconsistent,consistent", "--sweep",
                                    "spin.axle=0:5:6", "--out", "campbell"});
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("unstable"));
  const std::string csv = folder.read("campbell/modes.csv");
  const auto rows = lines(csv);
  EXPECT_EQ(rows.size(), 1U + 2 * 6 * 8);
  EXPECT_THAT(rows[0], HasSubstr("formulation,spin.axle[rad/s],branch"));
  EXPECT_THAT(folder.read("campbell/modes.svg"), HasSubstr("</svg>"));
  const json j = json::parse(folder.read("campbell/modes.json"));
  // Inconsistent lag at 5: grows with √(25 − ω₁²), and it is the branch that began as lag.
  const json& last = j.at("runs").at(0).at("points").at(5).at("modes");
  std::size_t branch = 99;
  const json& first = j.at("runs").at(0).at("points").at(0).at("modes");
  for (std::size_t i = first.size(); i-- > 0;)
    if (first[i].at("dominated_by") == "blade.bending_y[1]") branch = i;
  EXPECT_NEAR(last.at(branch).at("growth"), std::sqrt(25 - 3.5160152685 * 3.5160152685), 1e-6);
  EXPECT_EQ(last.at(branch).at("state"), "diverges");
}

TEST(Modes, AnyNumberOfTheSceneIsSwept) {
  const Folder folder;
  const json j = result(folder, {"modes", "scenes/two-link-slew.yaml", "--lock", "shoulder,elbow", "--sweep",
                                 "bodies.payload.mass=1:3:3", "--json"});
  double before = 1e9;
  for (const json& p : j.at("runs").at(0).at("points")) {
    const double w = p.at("modes").at(0).at("frequency");
    EXPECT_LT(w, before) << "a heavier payload swings slower";
    before = w;
  }
}

TEST(Modes, BadSweepsSpinsAndLocksAreNamed) {
  const Folder folder;
  const std::vector<std::pair<std::vector<std::string>, std::string>> bad = {
      {{"--sweep", "spin.axle=0:5"}, "FROM:TO:COUNT"},
      {{"--sweep", "spin.axle=0:5:1"}, "from 2"},
      {{"--sweep", "spin.wheel=0:5:3"}, "known: axle"},
      {{"--spin", "axle"}, "HINGE=RATE"},
      {{"--spin", "axle=5 kg"}, "axle"},
      {{"--lock", "axel"}, "known: axle"},
      {{"--spin", "axle=fast"}, "--spin: rate of 'axle': got 'fast'; need a number in rad/s, or one with its unit, as"},
      {{"--sweep", "bodies.blade.lenth=1:2:2"}, "length"}};
  for (const auto& [options, named] : bad) {
    std::vector<std::string> arguments = {"modes", blade};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Finished f = withy(folder, arguments);
    EXPECT_EQ(f.status, 2) << options[1];
    EXPECT_EQ(f.out, "");
    EXPECT_THAT(f.err, HasSubstr(named));
  }
}

TEST(Equilibrium, GivesAStateThatLinearizeFindsSteady) {
  const Folder folder;
  const Finished f = withy(folder, {"equilibrium", "scenes/two-link-slew.yaml", "--lock", "shoulder,elbow", "--set",
                                    "gravity.1=-9.81", "--out", "bent.json"});
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("link1.tip"));
  const json j = result(folder, {"linearize", "scenes/two-link-slew.yaml", "--at", "bent.json", "--lock",
                                 "shoulder,elbow", "--set", "gravity.1=-9.81"});
  EXPECT_EQ(j.at("equilibrium"), true);
  EXPECT_EQ(j.at("states").size(), 8U);
  EXPECT_EQ(j.at("inputs").size(), 0U) << "held hinges take no effort";
  const json away = result(
      folder, {"linearize", "scenes/two-link-slew.yaml", "--lock", "shoulder,elbow", "--set", "gravity.1=-9.81"});
  EXPECT_EQ(away.at("equilibrium"), false);
}

/// The effort that holds a pendulum out level is its weight's moment.
TEST(Equilibrium, GivesTheEffortsOfHeldHinges) {
  const Folder folder;
  folder.write("level.yaml", R"(format: withy/1
gravity: [0, -9.81, 0]
time: {end: 1}
bodies: {bob: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: bob}}
)");
  const json held = result(folder, {"equilibrium", "level.yaml", "--lock", "pivot", "--json"});
  EXPECT_NEAR(held.at("efforts").at("pivot.0"), 2 * 9.81 * 0.5, 1e-12);
  folder.write("state.json", R"({"hinges": {"pivot": {"position": [-1.2]}}})");
  const json free = result(folder, {"equilibrium", "level.yaml", "--at", "state.json", "--json"});
  EXPECT_NEAR(free.at("state").at("hinges").at("pivot").at("position").at(0), -std::acos(0.0), 1e-9);
}

/// Of rotations there is a coordinate more than rates: each has its own row, with its own name.
TEST(Equilibrium, ShowsRatesOfRotationsByTheirNames) {
  const Folder folder;
  folder.write("bus.yaml", R"(format: withy/1
bodies: {bus: {type: rigid, mass: 10, inertia: [1, 1.7, 1.5, 0, 0, 0]}}
hinges: {f: {type: free, parent: world, child: bus}}
initial: {hinges: {f: {position: {orientation: [1, 0, 0, 0], position: [7, 8, 9]}, rate: [0, 0, 0.8, 4, 5, 6]}}}
)");
  const Finished f = withy(folder, {"equilibrium", "bus.yaml", "--lock", "f.5"});
  EXPECT_EQ(f.status, 0) << f.err;
  for (const char* row :
       {"f\\.qz +0 +1 +- +- +-", "f\\.wz +- +0\\.8 +no +-", "f\\.x +7 +m +4 +no +-", "f\\.z +9 +m +6 +yes +0"})
    EXPECT_THAT(f.out, testing::ContainsRegex(row)) << f.out;
}

TEST(Equilibrium, SaysWhetherItIsStable) {
  const Folder folder;
  folder.write("standing.yaml", R"(format: withy/1
gravity: [0, -9.81, 0]
bodies: {bob: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: bob}}
initial: {hinges: {pivot: {position: [1.5]}}}
)");
  const Finished f = withy(folder, {"equilibrium", "standing.yaml"});
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, testing::AllOf(HasSubstr("steady but unstable after"), HasSubstr("grows by 4.04/s")));
  const json stability = result(folder, {"equilibrium", "standing.yaml", "--json"}).at("stability");
  EXPECT_EQ(stability.at("stable"), false);
  EXPECT_EQ(stability.at("growing"), 1);
  EXPECT_EQ(stability.at("dominated_by"), "pivot.0");
  EXPECT_NEAR(stability.at("growth"), std::sqrt(9.81 / 0.6), 1e-9);
}

TEST(Equilibrium, SaysWhatNothingHolds) {
  const Folder folder;
  folder.write("falling.yaml", R"(format: withy/1
gravity: [0, -9.81, 0]
time: {end: 1}
bodies: {stone: {type: rigid, mass: 2, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {drop: {type: prismatic, axis: [0, 1, 0], parent: world, child: stone}}
)");
  const Finished f = withy(folder, {"equilibrium", "falling.yaml"});
  EXPECT_EQ(f.status, 1);
  EXPECT_THAT(f.err, HasSubstr("nothing holds drop.0"));
}

/// A rigid pendulum about its lower rest: δ̈ = −(m g l/J) δ + τ/J, read off the matrices.
TEST(Linearize, GivesTheMatricesOfAPendulum) {
  const Folder folder;
  folder.write("pendulum.yaml", R"(format: withy/1
gravity: [9.81, 0, 0]
time: {end: 1}
bodies: {bob: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0], frames: {tip: {position: [1, 0, 0]}}}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: bob}}
)");
  const json j = result(folder, {"linearize", "pendulum.yaml"});
  const double J = 0.1 + 2 * 0.25;
  EXPECT_EQ(j.at("states"), json({"pivot.0", "pivot.0.rate"}));
  EXPECT_EQ(j.at("inputs"), json({"pivot.0"}));
  EXPECT_NEAR(j.at("A").at(1).at(0), -2 * 9.81 * 0.5 / J, 1e-12);
  EXPECT_EQ(j.at("A").at(0).at(1), 1.0);
  EXPECT_NEAR(j.at("B").at(1).at(0), 1 / J, 1e-12);
  EXPECT_EQ(j.at("outputs"), json({"pivot.0", "pivot.0.rate", "bob.tip.x", "bob.tip.y", "bob.tip.z"}));
  EXPECT_NEAR(j.at("C").at(3).at(0), 1, 1e-12) << "the tip, 1 m away, moves along y";
  EXPECT_EQ(j.at("D").at(0).at(0), 0.0);
  EXPECT_EQ(j.at("equilibrium"), true);
  EXPECT_EQ(j.at("derivatives"), "exact");
}

TEST(Linearize, SaysAsOtherAnalysesDoWhatClosedTheLoopsOfAState) {
  const Folder folder;
  folder.write("open.yaml", "hinges: {motor: {position: 1.2, rate: 0}}\n");
  const std::string remark = "Loops were closed at the start: positions changed, most";
  const std::string scene = "scenes/gallery/four-bar.yaml";
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"linearize", scene},
        {"response", scene, "--input", "motor", "--output", "pivot", "--json"},
        {"equilibrium", scene, "--lock", "motor", "--json"},
        {"modes", scene, "--as-is", "--json"}}) {
    std::vector<std::string> at = command;
    at.insert(at.end(), {"--at", "open.yaml", "--set", "initial.hinges.motor.rate=[0]"});
    const Finished f = withy(folder, at);
    EXPECT_EQ(f.status, 0) << f.err;
    EXPECT_THAT(f.err, HasSubstr(remark)) << command[0];
    EXPECT_THAT(f.out, HasSubstr("\"closing\": \"" + remark)) << command[0];
  }
  EXPECT_FALSE(result(folder, {"linearize", scene, "--set", "initial.hinges.motor.rate=[0]"}).contains("closing"));
}

TEST(Linearize, KeepsSensorsAndInputsForOtherPrograms) {
  const Folder folder;
  const json j = result(folder, {"linearize", "scenes/loads-of-the-slew.yaml", "--input", "shoulder", "--output",
                                 "shoulder_torque,box.y", "--out", "arm"});
  EXPECT_EQ(j.at("outputs"), json({"shoulder_torque", "box.y"}));
  EXPECT_EQ(j.at("output_units"), json({"N m", "m/s^2"}));
  EXPECT_NEAR(j.at("D").at(0).at(0), 1, 1e-12) << "an effort is felt at once";
  EXPECT_NE(j.at("D").at(1).at(0), 0.0);
  EXPECT_EQ(json::parse(folder.read("arm/linear.json")), j);
  EXPECT_THAT(folder.read("arm/linear.mat"), testing::StartsWith("MATLAB 5.0"));
  EXPECT_THAT(folder.read("arm/linear.npz"), testing::StartsWith("PK"));
}

TEST(Response, OfASampledLoopSaysItsMarginsFirstAndDrawsThem) {
  const Folder folder;
  folder.write("servo.yaml", R"(format: withy/1
time: {end: 1}
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
loads: {control: {type: pd-controller, law: constant, sample: 0.05, hinges: {axle: {stiffness: 0, damping: 4}}}}
)");
  const Finished f = withy(folder, {"response", "servo.yaml", "--input", "control", "--out", "loop"});
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(lines(f.out)[0], HasSubstr("control opened: stable: the gain may rise to 20 times"));
  EXPECT_THAT(f.out, HasSubstr("sampled every 0.05 s"));
  for (const char* picture : {"loop/bode.svg", "loop/nichols.svg"})
    EXPECT_THAT(folder.read(picture), HasSubstr("</svg>"));
  const json j = json::parse(folder.read("loop/response.json"));
  EXPECT_EQ(j.at("period"), 0.05);
  EXPECT_EQ(j.at("margins").at("stable"), true);
  EXPECT_EQ(lines(folder.read("loop/response.csv")).size(), 1 + j.at("values").size());
  // Of a load on two hinges one is to be named.
  const Finished both = withy(folder, {"response", "scenes/pd-arm.yaml", "--input", "control"});
  EXPECT_EQ(both.status, 2);
  EXPECT_THAT(both.err, HasSubstr("control.HINGE"));
}

TEST(Linearize, NamesOfInputsAndOutputsAreChecked) {
  const Folder folder;
  const std::vector<std::array<std::string, 3>> bad = {{"--inputs", "sholder", "known: "},
                                                       {"--outputs", "link3.tip", "did you mean 'link1.tip.x'?"},
                                                       {"--outputs", "nowhere.near", "known: "}};
  for (const auto& [option, name, said] : bad) {
    const Finished f = withy(folder, {"linearize", "scenes/two-link-slew.yaml", option, name});
    EXPECT_EQ(f.status, 2);
    EXPECT_THAT(f.err, HasSubstr(option));
    EXPECT_THAT(f.err, HasSubstr(said));
  }
}

// NREL/TP-500-38060: mass 17740 kg, centre of mass 20.475 m from the root, which is 1.5 m from the axis; with all three
// blades on the tower, FAST has the first and second flap at 0.6993 and 2.0205 Hz and the first edge at 1.0793
// to 1.0898 Hz. Half of the stations and no twist: 4 %.
TEST(Gallery, TheBladeIsThatOfTheReferenceTurbine) {
  const Folder folder;
  const std::string scene = "scenes/gallery/wind-turbine-blade.yaml";
  const json spinning = result(folder, {"eval", scene, "--set", "motions.turn.rate=1", "--set", "loads={}"});
  const std::vector<double> p = spinning.at("linear_momentum");
  EXPECT_NEAR(std::hypot(p[0], p[1], p[2]) / (17740 * (1.5 + 20.475)), 1, 0.01);
  const json j =
      result(folder, {"modes", scene, "--set", "motions.turn.rate=0", "--set", "gravity=[0, 0, 0]", "--set", "loads={}",
                      "--set", "bodies.blade.bending_y.modes=6", "--set", "bodies.blade.bending_z.modes=6", "--json"});
  const json& modes = j.at("runs").at(0).at("points").at(0).at("modes");
  std::map<std::string, std::vector<double>> hertz;
  for (const json& m : modes)
    hertz[m.at("dominated_by").get<std::string>().substr(0, 15)].push_back(m.at("frequency").get<double>() /
                                                                           (2 * std::numbers::pi));
  EXPECT_NEAR(hertz.at("blade.bending_z").at(0) / 0.6993, 1, 0.04);
  EXPECT_NEAR(hertz.at("blade.bending_z").at(1) / 2.0205, 1, 0.04);
  EXPECT_NEAR(hertz.at("blade.bending_y").at(0) / 1.0836, 1, 0.04);
}

}  // namespace
}  // namespace withy::test
