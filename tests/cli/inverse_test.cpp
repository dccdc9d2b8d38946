#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Columns of a CSV file by their heads.
std::map<std::string, std::vector<double>> columns(const std::string& csv) {
  const auto cells = [](const std::string& line) {
    std::vector<std::string> all;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) all.push_back(cell);
    return all;
  };
  const auto rows = lines(csv);
  const auto heads = cells(rows.at(0));
  std::map<std::string, std::vector<double>> found;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const auto row = cells(rows[r]);
    for (std::size_t k = 0; k < heads.size(); ++k) found[heads[k]].push_back(std::stod(row.at(k)));
  }
  return found;
}

// A rod of 1.2 kg, 0.4 kg m² about its pivot, centre of mass 0.5 m below it: τ = J θ̈ + m g l sin θ. The table's motion
// neither begins nor ends at rest; its spline has the accelerations up to h² x⁗/12 = 3e-4 rad/s², at the ends to some
// times that.
TEST(Inverse, OfAPendulumIsTheClosedForm) {
  const Folder folder;
  const auto angle = [](double t) { return 0.5 * std::sin(2 * t) + 0.1 * t; };
  std::string table = "t[s],unused,pivot[deg]\n";
  for (int k = 0; k <= 150; ++k)
    table += std::to_string(0.02 * k) + ",x," + std::to_string(angle(0.02 * k) * 180 / std::numbers::pi) + '\n';
  folder.write("path.csv", table);
  const Finished f =
      withy(folder, {"inverse", "scenes/pendulum.yaml", "--motion", "path.csv", "--out", "out", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const auto found = columns(folder.read("out/results.csv"));
  const auto& t = found.at("t[s]");
  const auto& effort = found.at("pivot.motion_effort[N m]");
  ASSERT_EQ(t.size(), 151U);
  double peak = 0, power = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double truth = -0.4 * 2 * std::sin(2 * t[i]) + 1.2 * 9.81 * 0.5 * std::sin(angle(t[i]));
    EXPECT_NEAR(effort[i], truth, 2e-3) << t[i];
    peak = std::max(peak, std::abs(truth));
    power = std::max(power, std::abs(truth * (std::cos(2 * t[i]) + 0.1)));
  }
  const json drive = json::parse(f.out).at("drives").at("pivot.0");
  EXPECT_NEAR(std::abs(drive.at("peak_effort").get<double>()), peak, 2e-3);
  EXPECT_NEAR(std::abs(drive.at("peak_power").get<double>()), power, 4e-3);
}

/// Of the driven arm, one mode a link: time and resolution of what follows.
std::vector<std::string> command_of(const std::string& command, const std::string& step,
                                    std::vector<std::string> more) {
  more.insert(more.begin(), {command, "scenes/driven-arm.yaml", "--set", "time.end=1", "--set", "time.output=" + step,
                             "--set", "bodies.link1.bending_y.modes=1", "--set", "bodies.link2.bending_y.modes=1"});
  return more;
}

/// How far the torques come out from 20 sin(2πt/5) and −4 sin(2πt/2.5) N m, which made the motion, and the tip from
/// where it was.
struct RoundTrip {
  double shoulder = 0, elbow = 0, tip = 0;
};
RoundTrip round_trip(const std::string& step) {
  const Folder folder;
  RoundTrip worst;
  const Finished there = withy(folder, command_of("run", step, {"--out", "forward", "--estimate", "never"}));
  EXPECT_EQ(there.status, 0) << there.err;
  const Finished f = withy(
      folder, command_of("inverse", step, {"--motion", "forward/results.csv", "--set", "loads={}", "--out", "back"}));
  EXPECT_EQ(f.status, 0) << f.err;
  if (f.status != 0) return worst;
  EXPECT_THAT(f.out, HasSubstr("elbow.0"));
  EXPECT_THAT(folder.read("back/inverse.svg"), HasSubstr("</svg>"));
  const auto forward = columns(folder.read("forward/results.csv")), back = columns(folder.read("back/results.csv"));
  const auto& t = back.at("t[s]");
  EXPECT_EQ(t.size(), forward.at("t[s]").size());
  const auto raise = [](double& most, double error) { most = std::max(most, std::abs(error)); };
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double turn = 2 * std::numbers::pi * t[i];
    raise(worst.shoulder, back.at("shoulder.motion_effort[N m]")[i] - 20 * std::sin(turn / 5));
    raise(worst.elbow, back.at("elbow.motion_effort[N m]")[i] + 4 * std::sin(turn / 2.5));
    for (const char* tip : {"payload.tip.x[m]", "payload.tip.y[m]"})
      raise(worst.tip, back.at(tip)[i] - forward.at(tip)[i]);
  }
  return worst;
}

// Forward dynamics and back: led along the hinge angles that its torques gave, the arm needs these torques for it,
// while its links bend as they did. Splines miss the second order in the step of what vibrates: measured 0.024 and
// 0.0079 N m of 20 and 4, half the step makes a quarter of it.
TEST(Inverse, GivesBackTheTorquesThatMadeTheMotion) {
  const RoundTrip coarse = round_trip("0.004"), fine = round_trip("0.002");
  EXPECT_LT(coarse.shoulder, 0.04);
  EXPECT_LT(coarse.elbow, 0.012);
  EXPECT_LT(coarse.tip, 2e-4);
  EXPECT_GT(coarse.shoulder / fine.shoulder, 3);
  EXPECT_GT(coarse.elbow / fine.elbow, 3);
  EXPECT_GT(coarse.tip / fine.tip, 3);
}

TEST(Inverse, NeedsNothingBesideLoadsThatGiveTheMotionAlready) {
  const Folder folder;
  const Finished there = withy(folder, command_of("run", "0.004", {"--out", "forward", "--estimate", "never"}));
  ASSERT_EQ(there.status, 0) << there.err;
  const Finished f = withy(folder, command_of("inverse", "0.004", {"--motion", "forward/results.csv", "--json"}));
  ASSERT_EQ(f.status, 0) << f.err;
  const json drives = json::parse(f.out).at("drives");
  ASSERT_EQ(drives.size(), 2U);
  for (const auto& [name, drive] : drives.items())
    EXPECT_LT(std::abs(drive.at("peak_effort").get<double>()), 0.04) << name;
}

// Nothing is damped and nothing else acts: the work of the drive is the energy at the end.
TEST(Inverse, WorkIsTheEnergyThatTheMotionGives) {
  const Folder folder;
  const Finished f =
      withy(folder, {"inverse", "scenes/spin-up.yaml", "--set", "time.end=15", "--out", "out", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const auto found = columns(folder.read("out/results.csv"));
  const double energy = found.at("kinetic_energy[J]").back() + found.at("potential_energy[J]").back();
  const json drive = json::parse(f.out).at("drives").at("axle.0");
  EXPECT_NEAR(drive.at("work"), energy, 1e-4 * energy);  // the trapezoidal rule over outputs every 20 ms
  EXPECT_EQ(drive.at("unit"), "N m");
}

TEST(Inverse, SaysWhichColumnsItLeavesOut) {
  const Folder folder;
  const auto led = [&](const std::string& head, std::vector<std::string> more) {
    const std::string rest = std::count(head.begin(), head.end(), ',') > 1 ? ",1,2,3\n" : "\n";
    folder.write("path.csv", head + "\n0,0" + rest + "1,0.1" + rest);
    more.insert(more.begin(),
                {"inverse", "scenes/two-link-slew.yaml", "--motion", "path.csv", "--set", "loads={}", "--out"});
    const Finished f = withy(folder, more);
    EXPECT_EQ(f.status, 0) << f.err;
    return f.out;
  };
  const std::string head = "t[s],shoulder[rad],motor[A],note[1],elbow.motion_effort[N m]";
  EXPECT_THAT(led(head, {"words"}),
              HasSubstr("Columns left out, for no hinge of one coordinate has their names: motor[A], note[1], "
                        "elbow.motion_effort[N m].\n"));
  EXPECT_EQ(json::parse(led(head, {"json", "--json"})).at("ignored"),
            (json{"motor[A]", "note[1]", "elbow.motion_effort[N m]"}));
  EXPECT_THAT(led("t[s],shoulder[rad]", {"all"}), testing::Not(HasSubstr("left out")));
}

// As spreadsheets write them: a byte-order mark first, other ends of lines, blank ones at the end.
TEST(Inverse, ReadsWhatSpreadsheetsWrite) {
  const Folder folder;
  const auto led = [&](const std::string& table) {
    folder.write("path.csv", table);
    const Finished f =
        withy(folder, {"inverse", "scenes/two-link-slew.yaml", "--motion", "path.csv", "--set", "loads={}", "--json"});
    EXPECT_EQ(f.status, 0) << f.err;
    return f.out;
  };
  const std::string plain = led("t[s],shoulder[rad]\n0,0\n1,0.1\n");
  EXPECT_EQ(led("\xEF\xBB\xBFt[s],shoulder[rad]\n0,0\n1,0.1\n"), plain);
  EXPECT_EQ(led("\xEF\xBB\xBF\"t[s]\",\"shoulder[rad]\"\r\n0,0\r\n1,0.1\r\n\r\n"), plain);
  EXPECT_EQ(led("t[s],shoulder[rad]\r0,0\r1,0.1\r"), plain);
}

TEST(Inverse, WhatIsNoMotionIsBadInput) {
  const Folder folder;
  const auto refused = [&](const std::string& table, const char* message) {
    folder.write("path.csv", table);
    const Finished f = withy(folder, {"inverse", "scenes/two-link-slew.yaml", "--motion", "path.csv"});
    EXPECT_EQ(f.status, 2) << table;
    EXPECT_EQ(f.out, "");
    EXPECT_THAT(f.err, HasSubstr(message));
  };
  refused("", "need a head");
  refused("shoulder[rad]\n0\n1\n", "need a column t[s]");
  refused("t[s],sholder[rad]\n0,0\n1,1\n", "path.csv:1:6: no hinge is named 'sholder'; did you mean 'shoulder'?");
  refused("t[s],waist[rad]\n0,0\n1,1\n", "there are shoulder, elbow");
  refused("t[s],shoulder[m]\n0,0\n1,1\n", "path.csv:1:6: column 'shoulder'");
  refused("t[s],shoulder[rad],elbw[rad]\n0,0,0\n1,1,1\n", "no hinge is named 'elbw'; did you mean 'elbow'?");
  refused("t[s],shoulder,shoulder\n0,0,0\n1,1,1\n", "there twice");
  refused("t[s],shoulder[rad]\n0,0\n1,one\n", "path.csv:3:3: got \"one\" in column 2; need a number");
  refused("t[s],shoulder[rad]\n0,0\n1\n", "path.csv:3:1: got 1 cells; the head has 2");
  refused("t[s],t[s],shoulder\n0,0,0\n1,1,1\n", "path.csv:1:6: column 't' is there twice");
  refused("t[s],shoulder[rad]\n0,0\n0,5,1\n", "path.csv:3:1: got 3 cells; the head has 2");
  refused("t[s];shoulder[rad]\n0;0\n0,5;1\n", "path.csv:1:1: got semicolons between the cells; need commas");
  refused("t[s],shoulder[rad]\n0,0\n1,1\n1,2\n", "path.csv:4:1: got the time 1 s after 1 s; need times that increase");
  refused("t[s],shoulder[rad]\n1,0\n2,1\n", "begins at 1 s");
  refused("t[s],shoulder[rad]\n0,0\n", "two rows");
  const Finished f = withy(folder, {"inverse", "scenes/two-link-slew.yaml"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("--motion"));
}

}  // namespace
}  // namespace withy::test
