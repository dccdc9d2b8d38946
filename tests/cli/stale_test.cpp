/// \file
/// Nothing stale, nothing mixed: a folder never shows the result of anything but what it says, whole.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "withy/scene/sha256.hpp"
#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using Arguments = std::vector<std::string>;

Arguments joined(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// The folder's scene.yaml with a body from cantilever.SID_FEM beside it, whose stiffness can be made four times.
class ImportedBoom {
 public:
  ImportedBoom() : soft_(folder.read("scenes/cantilever.SID_FEM")) {
    folder.write("scene.yaml", folder.read("scenes/imported-boom.yaml"));
    put(soft_);
  }
  void soften() const { put(soft_); }
  void stiffen() const {
    std::string text = soft_;
    for (std::size_t at = text.find("          Ke\n"); (at = text.find("m0(", at)) != std::string::npos; ++at) {
      const std::size_t value = text.find('=', at) + 1, end = text.find('\n', value);
      std::string number = text.substr(value, end - value);
      for (char& c : number)
        if (c == 'D') c = 'E';
      text.replace(value, end - value, " " + std::to_string(4 * std::stod(number)));
    }
    put(text);
  }

  Folder folder;

 private:
  void put(const std::string& text) const { folder.write("cantilever.SID_FEM", text); }
  std::string soft_;
};

/// Waits until a file is there and has some bytes.
bool appears(const std::filesystem::path& file, std::uintmax_t bytes) {
  return comes_true([&] {
    std::error_code none;
    const auto size = std::filesystem::file_size(file, none);
    return !none && size >= bytes;
  });
}

TEST(Stale, ATradeDoesNotReusePointsOfAnotherFile) {
  const ImportedBoom boom;
  const Arguments trade = {"trade",  "scene.yaml",   "--modes", "1",     "--formulations", "linear", "--integrators",
                           "dopri5", "--tolerances", "1e-3",    "--set", "time.end=0.2",   "--json"};
  const auto steps = [&](const Arguments& more) {
    const Finished f = withy(boom.folder, joined(trade, more));
    EXPECT_EQ(f.status, 0) << f.err;
    return json::parse(f.out).at("points").at(0).at("steps");
  };
  const auto soft = steps({"--out", "T"});
  boom.stiffen();
  EXPECT_EQ(withy(boom.folder, joined(trade, {"--out", "T"})).status, 2) << "the folder holds another result";
  const auto fresh = steps({"--out", "F"});
  EXPECT_NE(fresh, soft);
  EXPECT_EQ(steps({"--out", "T", "--force"}), fresh);
}

TEST(Stale, ATradeDoesNotReusePointsOfAChangedFileThatOnlyAValueGoneOverNames) {
  const ImportedBoom boom;
  boom.folder.write("other.SID_FEM", boom.folder.read("cantilever.SID_FEM"));
  const auto steps = [&] {
    const Finished f = withy(boom.folder, {"trade", "scene.yaml", "--modes", "1", "--formulations", "linear",
                                           "--integrators", "dopri5", "--tolerances", "1e-3", "--set", "time.end=0.2",
                                           "--over", "bodies.boom.file=other.SID_FEM", "--out", "T", "--json"});
    EXPECT_EQ(f.status, 0) << f.err;
    return json::parse(f.out).at("points").at(0).at("steps");
  };
  const auto soft = steps();
  EXPECT_EQ(steps(), soft);
  boom.stiffen();
  boom.folder.write("other.SID_FEM", boom.folder.read("cantilever.SID_FEM"));
  boom.soften();
  EXPECT_NE(steps(), soft);
}

TEST(Stale, ARunIsNotResumedWithAnotherFile) {
  const ImportedBoom boom;
  const Arguments run = {"run", "scene.yaml", "--integrator", "dopri5", "--set", "time.end=20", "--out", "out"};
  Process process(boom.folder, joined({WITHY_PROGRAM}, joined(run, {"--checkpoint", "0.01"})));
  ASSERT_TRUE(appears(boom.folder.path() / "out/checkpoint.previous.cbor", 1));
  ::kill(process.id(), SIGKILL);
  process.wait();
  const std::string kept = boom.folder.read("out/results.csv");
  boom.stiffen();
  const Finished other = withy(boom.folder, joined(run, {"--resume"}));
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("the file 'cantilever.SID_FEM' changed since"));
  EXPECT_EQ(boom.folder.read("out/results.csv"), kept);
  boom.soften();
  EXPECT_EQ(withy(boom.folder, joined(run, {"--resume"})).status, 0);
}

TEST(Stale, AChangedByteOfTheTableIsNoticedByResume) {
  const Folder folder;
  const Arguments run = {"run",   "scenes/attitude-jets.yaml", "--set", "time.end=400",
                         "--set", "time.output=0.05",          "--out", "out"};
  Process process(folder, joined({WITHY_PROGRAM}, joined(run, {"--checkpoint", "0.005"})));
  ASSERT_TRUE(appears(folder.path() / "out/checkpoint.previous.cbor", 1));
  ::kill(process.id(), SIGTERM);
  ASSERT_EQ(process.wait().status, 130) << "SIGTERM leaves a checkpoint, as SIGINT does";
  const std::string good = folder.read("out/results.csv");
  std::string bad = good;
  bad[bad.size() / 3] = bad[bad.size() / 3] == '1' ? '2' : '1';
  folder.write("out/results.csv", bad);
  const Finished noticed = withy(folder, joined(run, {"--resume"}));
  EXPECT_EQ(noticed.status, 2);
  EXPECT_THAT(noticed.err, HasSubstr("results.csv is not what it was at its checkpoint"));
  folder.write("out/results.csv", good);
  EXPECT_EQ(withy(folder, joined(run, {"--resume"})).status, 0);
}

TEST(Folders, TwoRunsDoNotWriteOne) {
  const Folder folder;
  const Arguments run = {"run", "scenes/driven-arm.yaml", "--set", "time.end=400", "--set", "time.output=0.002"};
  Process first(folder, joined({WITHY_PROGRAM}, joined(run, {"--out", "out"})));
  ASSERT_TRUE(appears(folder.path() / "out/results.csv", 1));
  const Finished second = withy(folder, joined(run, {"--set", "bodies.payload.mass=4", "--out", "out", "--force"}));
  EXPECT_EQ(second.status, 3);
  EXPECT_THAT(second.err, HasSubstr("out is being written by process " + std::to_string(first.id())));
  const Finished resumed = withy(folder, joined(run, {"--out", "out", "--resume"}));
  EXPECT_EQ(resumed.status, 3) << "it has no checkpoint yet";
  EXPECT_THAT(resumed.err, HasSubstr("out is being written by process " + std::to_string(first.id())));
  ::kill(first.id(), SIGKILL);
  first.wait();
}

TEST(Folders, DefaultsAreOthersForOtherSettings) {
  const Folder folder;
  for (const Arguments& more : {Arguments{}, {"--set", "bodies.rod.mass=2"}, {"--integrator", "rk4-adaptive"}})
    ASSERT_EQ(withy(folder, joined({"run", "scenes/pendulum.yaml", "--set", "time.end=0.1"}, more)).status, 0);
  for (const char* name : {"", ",bodies.rod.mass=2"})
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "results" /
                                        ("pendulum-quadratic-time.end=0.1" + std::string(name)) / "run.json"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "results/pendulum-quadratic-rk4-adaptive-time.end=0.1/run.json"));
}

TEST(Folders, AnotherResultIsReplacedByForceAlone) {
  const Folder folder;
  const Arguments run = {"run", "scenes/pendulum.yaml", "--out", "out", "--set"};
  ASSERT_EQ(withy(folder, joined(run, {"time.end=0.1"})).status, 0);
  const std::string kept = folder.read("out/run.json");
  const Finished refused = withy(folder, joined(run, {"time.end=0.2"}));
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("out holds the result of other values of scenes/pendulum.yaml"));
  EXPECT_THAT(refused.err, HasSubstr("--force"));
  EXPECT_EQ(folder.read("out/run.json"), kept);
  EXPECT_EQ(withy(folder, joined(run, {"time.end=0.1"})).status, 0) << "the same again";
  EXPECT_EQ(withy(folder, joined(run, {"time.end=0.2", "--force"})).status, 0);
  EXPECT_EQ(json::parse(folder.read("out/run.json")).at("t_end"), 0.2);
}

TEST(Folders, AKilledStudyLeavesNoResultOfTheOneBefore) {
  const Folder folder;
  const auto compare = [](const std::string& end) {
    return Arguments{"compare", "scenes/driven-arm.yaml", "--formulations", "ruthless,quadratic",
                     "--set",   "time.end=" + end,        "--out",          "out",
                     "--force"};
  };
  ASSERT_EQ(withy(folder, compare("1")).status, 0);
  ASSERT_TRUE(std::filesystem::exists(folder.path() / "out/compare.json"));
  // The folder's record names the process that writes it, once what was there is removed; the study itself is long.
  Process again(folder, joined({WITHY_PROGRAM}, compare("4000")));
  const auto taken = [&] {
    const json record = json::parse(folder.read("out/result.json"), nullptr, false);
    return record.is_object() && record.value("process", 0) == again.id();
  };
  comes_true(taken);
  ::kill(again.id(), SIGKILL);
  again.wait();
  for (const char* old : {"compare.json", "compare.svg", "quadratic/run.json", "ruthless/run.json"})
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out" / old)) << old;
}

TEST(Origin, OfARunIsInRunJson) {
  const ImportedBoom boom;
  const Finished f =
      withy(boom.folder, {"run", "scene.yaml", "--set", "time.end=0.01", "--set", "integrator.rtol=1e-4", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json run = json::parse(f.out);
  EXPECT_EQ(run.at("scene_sha256"), sha256(boom.folder.read("scene.yaml")));
  EXPECT_EQ(run.at("set"), json({"time.end=0.01", "integrator.rtol=1e-4"}));
  ASSERT_EQ(run.at("files").size(), 1U);
  EXPECT_EQ(run["files"][0].at("path"), "cantilever.SID_FEM");
  EXPECT_EQ(run["files"][0].at("sha256"), sha256(boom.folder.read("cantilever.SID_FEM")));
  std::vector<std::string> ids;
  for (const json& plugin : run.at("plugins")) {
    ids.push_back(plugin.at("id"));
    EXPECT_EQ(plugin.at("version"), WITHY_VERSION);
    EXPECT_TRUE(std::filesystem::exists(plugin.at("file").get<std::string>()));
  }
  EXPECT_THAT(ids, testing::UnorderedElementsAre("body/modal", "body/rigid", "formulation/quadratic", "hinge/revolute",
                                                 "hinge/weld", "integrator/imex", "load/rigid-inverse-dynamics"));
  EXPECT_EQ(run.at("program").at("version"), WITHY_VERSION);
  EXPECT_EQ(run.at("fingerprint").get<std::string>().size(), 64U);
}

}  // namespace
}  // namespace withy::test
