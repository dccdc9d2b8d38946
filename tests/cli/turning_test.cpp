/// \file
/// `withy modes` where the equations of small motions turn with the hinges.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "withy/tests/analysis/rotor.hpp"
#include "withy/tests/cli/json_result.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

TEST(Turning, FrozenModesSayThatTheyAreAndNeverFlutter) {
  const Folder folder;
  folder.write("two.yaml", rotor(2));
  const Finished f = withy(folder, {"modes", "two.yaml", "--spin", "shaft=12 rpm"});
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("frozen angle"));
  EXPECT_THAT(f.out, HasSubstr("--floquet"));
  EXPECT_THAT(f.out, Not(HasSubstr("flutters")));
  const Finished constant = withy(folder, {"modes", "scenes/rotating-blade.yaml", "--spin", "axle=6"});
  EXPECT_THAT(constant.out, HasSubstr("stay the same"));
}

TEST(Turning, FloquetGivesExponentsMostUnstableFirst) {
  const Folder folder;
  folder.write("two.yaml", rotor(2));
  const json turn = result(folder, {"modes", "two.yaml", "--spin", "shaft=12 rpm", "--floquet", "--json"})
                        .at("runs")
                        .at(0)
                        .at("points")
                        .at(0)
                        .at("turn");
  EXPECT_NEAR(turn.at("period"), 5, 1e-9);
  EXPECT_TRUE(turn.at("periodic"));
  const json& exponents = turn.at("floquet").at("exponents");
  EXPECT_EQ(exponents.size(), 12U);
  EXPECT_TRUE(turn.at("floquet").at("stable"));
  for (std::size_t i = 1; i < exponents.size(); ++i)
    EXPECT_LE(exponents[i].at("exponent")[0], exponents[i - 1].at("exponent")[0]);
  EXPECT_EQ(withy(folder, {"modes", "two.yaml", "--spin", "shaft=12 rpm", "--blades", "auto"}).status, 1);
  EXPECT_EQ(withy(folder, {"modes", "two.yaml", "--floquet"}).status, 1) << "nothing turns";
}

TEST(Turning, EqualBladesAreSeenFromTheTower) {
  const Folder folder;
  folder.write("three.yaml", rotor(3));
  const Finished f = withy(folder, {"modes", "three.yaml", "--spin", "shaft=12 rpm", "--blades", "auto"});
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("constant over the turn"));
  EXPECT_THAT(f.out, HasSubstr("blade1.bending_z[1] backward"));
  const Finished named =
      withy(folder, {"modes", "three.yaml", "--spin", "shaft=12 rpm", "--blades", "blade1,blade2,tower"});
  EXPECT_EQ(named.status, 2);
  EXPECT_THAT(named.err, HasSubstr("not like"));
}

/// A gust that grows over the turn is none of a periodic motion: exponents that took it for one were wrong.
TEST(Turning, ALoadThatDoesNotRepeatIsNamedWhereAWholeTurnIsAskedFor) {
  const Folder folder;
  const auto asked = [&](const std::string& force, const std::string& option) {
    folder.write("gust.yaml", rotor(3, "loads: {gust: {type: force, frame: hub, " + force + "}}\n"));
    return withy(folder,
                 {"modes", "gust.yaml", "--spin", "shaft=12 rpm", option, option == "--blades" ? "auto" : "--json"});
  };
  for (const char* option : {"--blades", "--floquet"}) {
    const Finished gust = asked("law: table, table: [[0, 0, 0, 0], [9, 3e5, 0, 0], [20, 0, 0, 0]]", option);
    EXPECT_EQ(gust.status, 1);
    EXPECT_THAT(gust.err, HasSubstr("load 'gust' acts otherwise 5 s later"));
    EXPECT_EQ(asked("value: [3e4, 0, 0]", option).status, 0);
    EXPECT_EQ(asked("law: sine, amplitude: [3e4, 0, 0], period: 1.6666666666666667", option).status, 0)
        << "three times a turn";
  }
}

/// The diagram of a turbine begins where its rotor stands, and its files have what is seen from the tower.
TEST(Turning, ASweepOfARotorsRateFromRestLeavesWhatTheTowerSees) {
  const Folder folder;
  folder.write("three.yaml", rotor(3));
  const Finished f = withy(folder, {"modes", "three.yaml", "--sweep", "spin.shaft=0:12 rpm:3", "--blades", "auto",
                                    "--count", "8", "--out", "campbell"});
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("At spin.shaft = 0 rpm nothing turns"));
  const std::string csv = folder.read("campbell/blades.csv"), picture = folder.read("campbell/blades.svg");
  EXPECT_THAT(csv, HasSubstr("formulation,spin.shaft[rpm],mode,dominated_by,frequency[rad/s],frequency[Hz]"));
  EXPECT_THAT(csv, Not(HasSubstr("\nquadratic,0,")));
  for (const char* name : {"blade1.bending_z[1] backward", "blade1.bending_z[1] forward"}) {
    EXPECT_THAT(csv, HasSubstr(name));
    EXPECT_THAT(picture, HasSubstr(name));
  }
  for (const char* line : {"once a turn", "3 times a turn", "6 times a turn"}) EXPECT_THAT(picture, HasSubstr(line));
  // The numbers are those that are printed for one rate.
  const json at = result(folder, {"modes", "three.yaml", "--spin", "shaft=12 rpm", "--blades", "auto", "--json"})
                      .at("runs")
                      .at(0)
                      .at("points")
                      .at(0)
                      .at("turn")
                      .at("multiblade")
                      .at("modes");
  std::map<std::string, double> seen;
  std::stringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::stringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells.size() == 9 && cells[1] == "12") seen[cells[2]] = std::stod(cells[4]);
  }
  ASSERT_EQ(seen.size(), at.size());
  for (std::size_t i = 0; i < at.size(); ++i)
    EXPECT_NEAR(seen.at(std::to_string(i + 1)), at[i].at("exponent")[1].get<double>(), 1e-6);
  // The page has them too, at each value but that of rest.
  if (const std::string page = folder.read("campbell/report.html"); !page.empty()) {
    EXPECT_THAT(page, HasSubstr("\"dominated_by\":\"blade1.bending_z[1] forward\""));
    EXPECT_THAT(page, HasSubstr("\"blades\":{\"count\":3,\"branches\":[{\"number\":1,\"at\":[null,{"));
  }
  // A turn that is no sweep's beginning is asked for in vain, and a value is named.
  EXPECT_EQ(withy(folder, {"modes", "three.yaml", "--floquet"}).status, 1);
  const Finished idle = withy(folder, {"modes", "three.yaml", "--sweep", "gravity.2=-9:0:2", "--blades", "auto"});
  EXPECT_EQ(idle.status, 1);
  EXPECT_THAT(idle.err, HasSubstr("gravity.2 = -9: a whole turn: nothing turns"));
}

/// The reference of a servo moves at the start, and the hinge with it: nothing turns, and nothing stays.
TEST(Turning, AStateThatAFreeHingePassesThroughIsNamed) {
  const Folder folder;
  folder.write("servo.yaml", R"(format: withy/1
gravity: [0, -9.81, 0]
time: {end: 1}
bodies: {arm: {type: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}}
loads: {servo: {type: pd-controller, law: sine, period: 4 s, hinges: {pivot: {amplitude: 20 deg, stiffness: 40, damping: 4}}}}
)");
  for (const char* command : {"modes", "equilibrium"}) {
    const Finished f = withy(folder, {command, "servo.yaml"});
    EXPECT_EQ(f.status, 0) << f.err;
    EXPECT_THAT(f.out, HasSubstr("The hinge 'pivot' moves and nothing holds it at its rate"));
    EXPECT_THAT(f.out, Not(HasSubstr("turn")));
    EXPECT_THAT(f.out, Not(HasSubstr("steady after")));
  }
  const json turn = result(folder, {"modes", "servo.yaml", "--json"}).at("runs").at(0).at("points").at(0).at("turn");
  EXPECT_EQ(turn.at("passing"), json({"pivot"}));
  EXPECT_EQ(turn.at("timed"), json({"servo"})) << "its reference moves";
  EXPECT_EQ(turn.at("shaking"), json::array());
  EXPECT_TRUE(turn.at("narrow").is_null());
  const Finished locked = withy(folder, {"equilibrium", "servo.yaml", "--spin", "pivot=0"});
  EXPECT_THAT(locked.out, HasSubstr("steady after"));
}

TEST(Modes, LockOfADrivenHingeIsRefused) {
  const Folder folder;
  const Finished f = withy(folder, {"modes", "scenes/spin-up.yaml", "--lock", "axle"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("drives 'axle'"));
}

TEST(Modes, EndsOfASweepTakeUnits) {
  const Folder folder;
  const auto flap = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"modes", "scenes/rotating-blade.yaml", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return result(folder, arguments).at("runs").at(0).at("points").back().at("modes").at(1).at("frequency");
  };
  EXPECT_NEAR(flap({"--sweep", "spin.axle=0:30 rpm:3"}), flap({"--spin", "axle=3.141592653589793"}), 1e-9);
  EXPECT_EQ(withy(folder, {"modes", "scenes/rotating-blade.yaml", "--sweep", "spin.axle=1 rad/s:30 rpm:3"}).status, 2);
}

/// The two real poles of an overdamped disk stand by themselves.
TEST(Modes, PolesAreListedByModulus) {
  const Folder folder;
  folder.write("disk.yaml", R"(format: withy/1
time: {end: 1}
bodies: {disk: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: disk}}
loads: {spring: {type: hinge-spring, hinge: axle, stiffness: 8, damping: 20}}
)");
  const Finished f = withy(folder, {"modes", "disk.yaml", "--poles"});
  EXPECT_EQ(f.status, 0) << f.err;
  const std::size_t slow = f.out.find("-0.417424"), fast = f.out.find("-9.58258");
  EXPECT_NE(slow, std::string::npos) << f.out;
  EXPECT_NE(fast, std::string::npos) << f.out;
}

}  // namespace
}  // namespace withy::test
