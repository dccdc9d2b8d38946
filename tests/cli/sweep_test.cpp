// Sweeps as a user runs them: killed, resumed, in parts; what they print and leave.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* plan = R"(format: withy-sweep/1
scene: scenes/two-link-slew.yaml
set: {integrator.rtol: 1e-5, time.end: 0.4}
vary:
  loads.slew.time_scale: {grid: [0.5, 1.0]}
  formulation: {grid: [ruthless, quadratic]}
  bodies.link1.mass_per_length: {normal: {mean: 1.33937, deviation: 0.02}}
cases: 30
seed: 7
keep: {final: [shoulder, elbow], peak: [link1.tip.deflection_y]}
)";

struct SweepFolder : Folder {
  explicit SweepFolder(const std::string& text = plan) { write("plan.yaml", text); }
  Finished sweep(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "sweep");
    return withy(*this, std::move(arguments));
  }
};

TEST(SweepCommand, MakesATableInTheOrderOfThePlanWithTheColumnsItSays) {
  const SweepFolder folder;
  const Finished ran = folder.sweep({"run", "plan.yaml", "--out", "store"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.err, "");
  EXPECT_THAT(ran.out, HasSubstr("120 cases: 120 done, 0 missing\ntable.csv, statistics.csv in store"));
  const std::vector<std::string> rows = lines(folder.read("store/table.csv"));
  ASSERT_EQ(rows.size(), 121U);
  EXPECT_EQ(rows[0],
            "case,status,loads.slew.time_scale,formulation,bodies.link1.mass_per_length,final.shoulder[rad],"
            "final.elbow[rad],peak.link1.tip.deflection_y[m]");
  EXPECT_THAT(rows[1], StartsWith("0,completed,0.5,ruthless,1."));
  EXPECT_THAT(rows[31], StartsWith("30,completed,0.5,quadratic,1."));
  EXPECT_THAT(rows[120], StartsWith("119,completed,1,quadratic,1."));
  EXPECT_EQ(lines(folder.read("store/statistics.csv")).size(), 1U + 4 * 3);
  const json status = json::parse(folder.sweep({"status", "store", "--json"}).out);
  EXPECT_EQ(status["done"], 120);
  EXPECT_EQ(status["missing"], 0);
}

/// Runs in AVX2 of a processor with AVX-512, as one without has it.
class FourLanes {
 public:
  FourLanes() { ::setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX512F", 1); }
  ~FourLanes() { ::unsetenv("GLIBC_TUNABLES"); }
  FourLanes(const FourLanes&) = delete;
  FourLanes& operator=(const FourLanes&) = delete;
};

/// A store may be filled by processors of both kinds.
TEST(SweepCommand, FourLanesAndEightMakeTheSameTableToTheLastByte) {
  const auto at_once = [](const Folder& folder) {
    const Finished timed = withy(folder, {"bench", "scenes/driven-arm.yaml", "--lanes"});
    return json::parse(timed.out).at("lanes").at("at_once").get<int>();
  };
  const SweepFolder folder;
  const int here = at_once(folder);
  if (here == 4) GTEST_SKIP() << "this processor has four lanes";
  EXPECT_EQ(here, 8);
  {
    const FourLanes without;
    EXPECT_EQ(at_once(folder), 4);
  }
  const std::string cases = "evaluation: in-lanes\ncases: 11\nseed: 3\n",
                    both = "formulation: {grid: [ruthless, quadratic]}";
  const std::vector<std::string> plans = {
      "scene: scenes/driven-arm.yaml\nset: {time.end: 0.5}\nkeep: {final: [shoulder, elbow, link2.tip], peak: "
      "[link2.tip.deflection_y]}\nvary: {" +
          both +
          ", bodies.payload.mass: {uniform: {from: 1, to: 3}}, "
          "bodies.link1.bending_y.modes: {grid: [1, 2, 3, 4]}}\n",
      "scene: scenes/rigid-chain.yaml\nset: {time.end: 0.2}\nkeep: {final: [linear_momentum, angular_momentum]}\n"
      "vary: {gravity.1: {uniform: {from: -10, to: -5}}}\n",
      "scene: scenes/gallery/spinning-beam.yaml\nset: {time.end: 0.2}\nkeep: {final: [linear_momentum, "
      "kinetic_energy]}\n"
      "vary: {" +
          both + ", bodies.beam.mass_per_length: {uniform: {from: 1.1, to: 1.3}}}\n"};
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const std::string file = "lanes" + std::to_string(i) + ".yaml";
    folder.write(file, "format: withy-sweep/1\n" + plans[i] + cases);
    const Finished eight = folder.sweep({"run", file, "--out", "eight"});
    ASSERT_EQ(eight.status, 0) << eight.err;
    EXPECT_THAT(eight.out, testing::Not(HasSubstr("one at a time"))) << plans[i];
    {
      const FourLanes without;
      ASSERT_EQ(folder.sweep({"run", file, "--out", "four"}).status, 0);
    }
    EXPECT_EQ(folder.read("eight/table.csv"), folder.read("four/table.csv")) << plans[i];
    std::filesystem::remove_all(folder.path() / "eight");
    std::filesystem::remove_all(folder.path() / "four");
  }
}

TEST(SweepCommand, ACaseAloneIsTheRunThatItsCommandMakes) {
  const SweepFolder folder;
  const Finished alone = folder.sweep({"case", "plan.yaml", "47", "--json"});
  ASSERT_EQ(alone.status, 0) << alone.err;
  const json one = json::parse(alone.out);
  EXPECT_EQ(one["status"], "completed");
  const std::string command = one["command"];
  ASSERT_THAT(command, StartsWith("withy run scenes/two-link-slew.yaml --set '"));
  std::vector<std::string> arguments = {"run", "scenes/two-link-slew.yaml", "--out", "run"};
  for (std::size_t at = command.find('\''); at != std::string::npos; at = command.find('\'', at + 1)) {
    const std::size_t end = command.find('\'', at + 1);
    arguments.insert(arguments.end(), {"--set", command.substr(at + 1, end - at - 1)});
    at = end;
  }
  const Finished run = withy(folder, arguments);
  ASSERT_EQ(run.status, 0) << run.err;
  const json summary = json::parse(folder.read("run/run.json"));
  EXPECT_EQ(summary["final"]["hinges"]["shoulder"]["position"][0], one["results"]["final.shoulder[rad]"]);
  EXPECT_EQ(summary["peaks"]["tip_deflection"]["link1"]["y"], one["results"]["peak.link1.tip.deflection_y[m]"]);
}

TEST(SweepCommand, CommandsThatRepeatACaseNameTheFoldersOfPlugins) {
  const SweepFolder folder(
      "format: withy-sweep/1\nscene: scenes/two-link-slew.yaml\nset: {formulation: consistent}\n"
      "vary: {loads.slew.time_scale: {grid: [1.2]}}\nkeep: {final: [shoulder]}\n");
  std::filesystem::create_directories(folder.path() / "my plugins");
  std::filesystem::create_directories(folder.path() / "others");
  const std::vector<std::string> plugins = {"--plugins", "my plugins", "--plugins", "others"};
  const auto with_plugins = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), plugins.begin(), plugins.end());
    return folder.sweep(std::move(arguments));
  };
  const json one = json::parse(with_plugins({"case", "plan.yaml", "0", "--json"}).out);
  EXPECT_THAT(one["command"].get<std::string>(),
              StartsWith("withy run scenes/two-link-slew.yaml --plugins 'my plugins' --plugins others --set '"));
  ASSERT_EQ(with_plugins({"run", "plan.yaml", "--out", "store"}).status, 0);
  EXPECT_THAT(folder.read("store/failed.csv"),
              HasSubstr("withy sweep case plan.yaml --plugins 'my plugins' --plugins others 0"));
}

/// WITHY_KILLS sets the number of kills; the target `kills` makes more.
TEST(SweepKills, AtAnyMomentLeaveTheSameTable) {
  const SweepFolder folder;
  const auto command = [&](const std::string& out) {
    return std::vector<std::string>{WITHY_PROGRAM, "sweep", "run", "plan.yaml", "--out", out, "--jobs", "2"};
  };
  const auto began = std::chrono::steady_clock::now();
  ASSERT_EQ(Process(folder, command("whole")).wait().status, 0);
  const std::chrono::duration<double> length = std::chrono::steady_clock::now() - began;
  const char* asked = std::getenv("WITHY_KILLS");
  int left = asked != nullptr ? std::atoi(asked) : 6;
  std::mt19937 random(static_cast<unsigned>(length.count() * 1e9));
  std::uniform_real_distribution<double> moment(0, length.count());
  for (int k = 0; left > 0; ++k) {
    const std::string out = "out" + std::to_string(k);
    for (int i = 0; i < 3 && left > 0; ++i, --left) {
      Process process(folder, command(out));
      std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
      ::kill(process.id(), SIGKILL);
      const Finished ended = process.wait();
      ASSERT_TRUE(ended.status == -SIGKILL || ended.status == 0) << ended.err;
    }
    const Finished resumed = Process(folder, command(out)).wait();
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    for (const char* file : {"/table.csv", "/statistics.csv", "/failed.csv"})
      ASSERT_EQ(folder.read(out + file), folder.read(std::string("whole") + file)) << file;
  }
}

TEST(SweepCommand, AnInterruptedSweepKeepsWhatItHasAndSaysHowToGoOn) {
  std::string many = plan;
  many.replace(many.find("cases: 30"), 9, "cases: 9000");
  const SweepFolder folder(many);
  Process process(folder, {WITHY_PROGRAM, "sweep", "run", "plan.yaml", "--out", "store", "--jobs", "1"});
  const auto done = [&] {
    const Finished f = folder.sweep({"status", "store", "--json"});
    return f.status == 0 ? json::parse(f.out)["done"].get<int>() : 0;
  };
  comes_true([&] { return done() >= 5; });
  const Finished second = folder.sweep({"run", "plan.yaml", "--out", "store"});
  EXPECT_EQ(second.status, 3) << "the store has a writer";
  EXPECT_THAT(second.err, HasSubstr("is being written by another process"));
  ::kill(process.id(), SIGTERM);
  const Finished ended = process.wait();
  EXPECT_EQ(ended.status, 130);
  EXPECT_THAT(ended.err, HasSubstr("the same command goes on from there"));
  const json status = json::parse(folder.sweep({"status", "store", "--json"}).out);
  EXPECT_EQ(status["writers"], 0);
  EXPECT_EQ(status["lost_bytes"], 0);
  EXPECT_EQ(status["done"].get<int>() + status["missing"].get<int>(), 36000);
  EXPECT_THAT(folder.sweep({"collect", "store"}).out, HasSubstr("36000 cases: "));
  EXPECT_THAT(folder.read("store/table.csv"), HasSubstr("\n35999,missing,,,,,,\n"));
}

TEST(SweepCommand, FailuresAreResultsWithTheirReasonAndTheCommandThatRepeatsThem) {
  const std::string text = plan;
  const SweepFolder folder(text.substr(0, text.find("vary:")) +
                           "vary: {loads.slew.time_scale: {grid: [1, 1.2]}, formulation: {grid: [consistent]}}\n");
  folder.write("plan.yaml", folder.read("plan.yaml").replace(folder.read("plan.yaml").find(", time.end: 0.4"), 15, ""));
  const Finished ran = folder.sweep({"run", "plan.yaml", "--out", "store"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(folder.read("store/table.csv"), HasSubstr("\n1,singular,1.2,consistent\n"));
  EXPECT_THAT(folder.read("store/failed.csv"), HasSubstr("withy sweep case plan.yaml 1\n"));
  EXPECT_EQ(folder.sweep({"case", "plan.yaml", "1"}).status, 1);
  EXPECT_EQ(folder.sweep({"case", "plan.yaml", "2"}).status, 2) << "there is none";
  EXPECT_THAT(folder.sweep({"case", "store", "1"}).err,
              HasSubstr("store is the store of a sweep; need its plan, plan.yaml"));
}

TEST(SweepCommand, BadInputIsSaidInOneLineEach) {
  const SweepFolder folder;
  EXPECT_THAT(folder.sweep({"run", "plan.yaml", "--out", "s", "--shard", "0/2"}).err, HasSubstr("counted from 1"));
  EXPECT_THAT(folder.sweep({"status", "nowhere"}).err, HasSubstr("nowhere is no store of a sweep"));
  EXPECT_EQ(folder.sweep({"run", "none.yaml", "--out", "s"}).status, 2);
  EXPECT_EQ(folder.sweep({"collect", "scenes"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "s"));
  ASSERT_EQ(withy(folder, {"run", "scenes/pendulum.yaml", "--set", "time.end=0.1", "--out", "run"}).status, 0);
  const Finished mixed = folder.sweep({"run", "plan.yaml", "--out", "run"});
  EXPECT_EQ(mixed.status, 2);
  EXPECT_THAT(mixed.err, HasSubstr("run holds the result of another command"));
}

}  // namespace
}  // namespace withy::test
