/// \file
/// A folder holds one result, written by one process; a fingerprint changes with all that a result comes from.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "scratch.hpp"
#include "withy/results/kept_results.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/output_name.hpp"
#include "withy/results/report/finished_runs.hpp"
#include "withy/results/results_error.hpp"
#include "withy/results/results_folder.hpp"
#include "withy/study/input_error.hpp"

namespace withy {
namespace {

using test::Scratch;
using testing::HasSubstr;

const std::vector<std::string> content = {"run.json", "results.csv"};

Provenance origin(const std::string& values = "v", const std::string& file = "f") {
  Provenance p;
  p.scene = "arm.yaml";
  p.scene_sha256 = "s";
  p.values = values;
  p.sources.files = {{"boom.SID_FEM", file}};
  p.sources.plugins = {{"body", "beam", "/lib/beam.so"}};
  p.plugin_builds = {"b"};
  p.program = {"0.1.0", "g", "h"};
  return p;
}

std::string refusal(const std::filesystem::path& folder, const std::string& command, const Provenance& p,
                    FolderUse use = FolderUse::begin) {
  try {
    const ResultsFolder taken(folder, command, p, content, use);
  } catch (const ResultsError& e) {
    return e.what();
  }
  return {};
}

TEST(ResultsFolder, IsTakenByOneWriterAtATime) {
  const Scratch scratch;
  {
    const ResultsFolder first(scratch / "out", "run", origin(), content, FolderUse::begin);
    for (const FolderUse use : {FolderUse::begin, FolderUse::replace, FolderUse::go_on}) {
      try {
        const ResultsFolder second(scratch / "out", "run", origin(), content, use);
        ADD_FAILURE() << "taken twice";
      } catch (const FolderBusy& e) {
        EXPECT_THAT(e.what(), HasSubstr("is being written by process " + std::to_string(::getpid())));
      }
    }
  }
  EXPECT_EQ(writer_of(scratch / "out"), "");
  EXPECT_EQ(refusal(scratch / "out", "run", origin()), "");
}

/// Those who look at a folder learn who writes it, and that a run without a report was not killed.
TEST(ResultsFolder, SaysWhoWritesIt) {
  const Scratch scratch;
  EXPECT_EQ(writer_of(scratch / "out"), "");
  const ResultsFolder first(scratch / "out", "run", origin(), content, FolderUse::begin);
  const std::string own = "process " + std::to_string(::getpid());
  EXPECT_EQ(writer_of(scratch / "out"), own);
  try {
    static_cast<void>(runs_at(scratch / "out", scratch / "page.html"));
    ADD_FAILURE() << "there is no report";
  } catch (const ResultsError& e) {
    EXPECT_THAT(e.what(), HasSubstr("its run is still going on, in " + own));
  }
}

TEST(ResultsFolder, RemovesTheSameResultBeforeItIsWrittenAnewAndNoOtherFile) {
  const Scratch scratch;
  EXPECT_EQ(refusal(scratch / "out", "run", origin()), "");
  for (const char* name : {"out/run.json", "out/results.csv", "out/notes.txt"}) scratch.write(name, "old");
  {
    const ResultsFolder again(scratch / "out", "run", origin(), content, FolderUse::begin);
    EXPECT_FALSE(std::filesystem::exists(again / "run.json"));
    EXPECT_FALSE(std::filesystem::exists(again / "results.csv"));
    EXPECT_TRUE(std::filesystem::exists(again / "notes.txt"));
  }
  scratch.write("out/run.json", "new");
  {
    const ResultsFolder on(scratch / "out", "run", origin(), content, FolderUse::go_on);
    EXPECT_EQ(on.changed(), "");
  }
  EXPECT_EQ(scratch.read("out/run.json"), "new");
}

TEST(ResultsFolder, AnotherResultIsLeftAloneUnlessItIsToBeReplaced) {
  const Scratch scratch;
  EXPECT_EQ(refusal(scratch / "out", "run", origin()), "");
  scratch.write("out/run.json", "kept");
  const std::string record = scratch.read("out/result.json");
  Provenance other_scene = origin("w");
  other_scene.scene = "crane.yaml";
  EXPECT_THAT(refusal(scratch / "out", "run", origin("w")), HasSubstr("other values of arm.yaml"));
  EXPECT_THAT(refusal(scratch / "out", "run", origin("v", "g")), HasSubstr("other values of arm.yaml"));
  EXPECT_THAT(refusal(scratch / "out", "run", other_scene), HasSubstr("another scene, arm.yaml"));
  EXPECT_THAT(refusal(scratch / "out", "compare", origin()), HasSubstr("a result of withy run"));
  EXPECT_EQ(scratch.read("out/run.json"), "kept");
  EXPECT_EQ(scratch.read("out/result.json"), record);
  Provenance other_program = origin();
  other_program.program.build = "i";
  EXPECT_EQ(refusal(scratch / "out", "run", other_program), "") << "the same result is meant";
  scratch.write("out/run.json", "kept");
  EXPECT_EQ(refusal(scratch / "out", "compare", origin("w"), FolderUse::replace), "");
  EXPECT_FALSE(std::filesystem::exists(scratch / "out/run.json"));
}

TEST(ResultsFolder, FilesOfUnknownOriginAreLeftAlone) {
  const Scratch scratch;
  scratch.write("out/run.json", "kept");
  EXPECT_THAT(refusal(scratch / "out", "run", origin()), HasSubstr("holds run.json, and nothing says of what result"));
  scratch.write("out/result.json", "{\"format\": \"withy-result/1\", \"content\": [\"../victim\", \"/etc/x\", 7]}");
  scratch.write("victim", "kept");
  EXPECT_EQ(refusal(scratch / "out", "run", origin(), FolderUse::replace), "");
  EXPECT_EQ(scratch.read("victim"), "kept") << "a record is no order to remove files elsewhere";
}

TEST(ResultsFolder, ARecordOfAnotherProgramIsLeftAlone) {
  const Scratch scratch;
  scratch.write("out/result.json", "{\"mine\": \"measurements\"}");
  EXPECT_THAT(refusal(scratch / "out", "run", origin()),
              HasSubstr("holds result.json, and nothing says of what result"));
  EXPECT_EQ(scratch.read("out/result.json"), "{\"mine\": \"measurements\"}");
  scratch.write("out/result.json", "{\"format\": \"withy-result/1\", \"comm");
  EXPECT_EQ(refusal(scratch / "out", "run", origin()), "") << "one of its own that was cut short";
  scratch.write("out/result.json", "mine");
  EXPECT_EQ(refusal(scratch / "out", "run", origin(), FolderUse::replace), "");
}

TEST(ResultsFolder, NothingThatIsReadIsRemovedOrReplaced) {
  const Scratch scratch;
  const auto refused = [&](const std::string& read) -> std::string {
    Provenance p = origin();
    p.reads = {scratch / "elsewhere", scratch / read};
    try {
      const ResultsFolder taken(scratch / "out", "run", p, content, FolderUse::replace);
    } catch (const study::InputError& e) {
      return e.what();
    }
    return {};
  };
  scratch.write("out/run.json", "data");
  scratch.write("out/mine.csv", "data");
  EXPECT_EQ(refused("out/mine.csv"), "") << "no name of this result";
  scratch.write("out/run.json", "data");
  std::filesystem::create_symlink("run.json", scratch / "out/link.json");
  for (const char* read : {"out/run.json", "out/../out/run.json", "out/link.json", "out/result.json"})
    EXPECT_THAT(refused(read), HasSubstr("read by this command and is not replaced")) << read;
  EXPECT_EQ(scratch.read("out/run.json"), "data");
  std::filesystem::remove(scratch / "out/run.json");
  scratch.write("out/run.json/below/data.csv", "data");
  EXPECT_THAT(refused("out/run.json/below/data.csv"), HasSubstr("is read by this command, and "));
  EXPECT_EQ(scratch.read("out/run.json/below/data.csv"), "data");
}

TEST(ResultsFolder, SaysWhatHasChangedSinceItWasWritten) {
  const Scratch scratch;
  EXPECT_EQ(refusal(scratch / "out", "run", origin()), "");
  const auto changed = [&](const Provenance& p) {
    return ResultsFolder(scratch / "out", "run", p, content, FolderUse::go_on).changed();
  };
  Provenance plugin = origin();
  plugin.plugin_builds = {"c"};
  Provenance program = origin();
  program.program.description = "other";
  EXPECT_EQ(changed(origin("w")), "the values of the scene");
  EXPECT_EQ(changed(origin("v", "g")), "the file 'boom.SID_FEM'");
  EXPECT_EQ(changed(plugin), "the plugin body/beam");
  EXPECT_EQ(changed(program), "the program");
  EXPECT_EQ(changed(origin()), "");
}

TEST(Provenance, FingerprintIsOfEverythingAResultComesFrom) {
  Provenance plugin = origin(), program = origin(), moved = origin();
  plugin.plugin_builds = {"c"};
  program.program.build = "i";
  moved.scene = "elsewhere/arm.yaml";
  moved.sources.plugins[0].file = "/opt/lib/beam.so";
  std::set<std::string> all;
  for (const Provenance& p : {origin(), origin("w"), origin("v", "g"), plugin, program}) all.insert(p.fingerprint());
  EXPECT_EQ(all.size(), 5U);
  EXPECT_EQ(moved.fingerprint(), origin().fingerprint()) << "not of where things are";
  const Provenance read = provenance_of_json(stored_provenance(plugin));
  EXPECT_EQ(read.fingerprint(), plugin.fingerprint());
  EXPECT_EQ(differences(read, plugin), "");
  EXPECT_THROW(provenance_of_json(nlohmann::ordered_json::object()), ResultsError);
}

TEST(Provenance, TheProgramIsKnownByItsBuild) {
  EXPECT_EQ(build_identity().build.size(), 64U);
  EXPECT_EQ(library_identity("built in"), "");
  EXPECT_GE(library_identity("/proc/self/exe").size(), 40U);
}

TEST(KeptResults, AreFoundByTheSameFingerprintAlone) {
  const Scratch scratch;
  const KeptResults mine(scratch / "points", "mine"), others(scratch / "points", "other");
  EXPECT_FALSE(mine.find("a"));
  const nlohmann::ordered_json value = {{"error", 0.1}, {"status", "completed"}, {"peak", std::nan("")}};
  mine.keep("a", value);
  ASSERT_TRUE(mine.find("a"));
  EXPECT_EQ(mine.find("a")->at("error"), 0.1);
  EXPECT_TRUE(mine.find("a")->at("peak").is_null());
  EXPECT_FALSE(others.find("a"));
}

TEST(KeptResults, ThatAreDamagedAreNotFound) {
  const Scratch scratch;
  const KeptResults kept(scratch / "points", "mine");
  kept.keep("a", {{"error", 0.125}, {"steps", 17}});
  const std::string good = scratch.read("points/a.json");
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 1);
    scratch.write("points/a.json", bad);
    if (const auto found = kept.find("a")) {
      EXPECT_EQ(found->dump(), R"({"error":0.125,"steps":17})") << i;
    }
    if (i + 2 >= good.size()) continue;  // the last line break alone is nothing
    scratch.write("points/a.json", good.substr(0, i));
    EXPECT_FALSE(kept.find("a")) << "cut at " << i;
  }
}

TEST(FolderSuffix, TellsSettingsApartInANameForAFolder) {
  EXPECT_EQ(folder_suffix({}), "");
  EXPECT_EQ(folder_suffix({"loads.slew.time_scale=1.2"}), "-loads.slew.time_scale=1.2");
  EXPECT_EQ(folder_suffix({"a=1", "b=2"}), "-a=1,b=2");
  const std::string long_one = folder_suffix({"a=" + std::string(200, '1')}), map = folder_suffix({"loads={}"});
  EXPECT_THAT(long_one, testing::MatchesRegex("-set-[0-9a-f]{8}"));
  EXPECT_THAT(map, testing::MatchesRegex("-set-[0-9a-f]{8}"));
  EXPECT_NE(long_one, map);
  EXPECT_NE(folder_suffix({"name=../../x"}).find("set-"), std::string::npos);
}

TEST(OutputFile, GoesThroughLinksAndIntoPipesAndLeavesNothingHalfWritten) {
  namespace fs = std::filesystem;
  const Scratch scratch;
  scratch.write("kept/there.txt", "old");
  fs::create_symlink(scratch / "kept/there.txt", scratch / "link.txt");
  fs::create_symlink("kept/new.txt", scratch / "nowhere.txt");
  write_file(scratch / "link.txt", "new");
  write_file(scratch / "nowhere.txt", "first");
  EXPECT_TRUE(fs::is_symlink(scratch / "link.txt"));
  EXPECT_TRUE(fs::is_symlink(scratch / "nowhere.txt"));
  EXPECT_EQ(scratch.read("kept/there.txt"), "new");
  EXPECT_EQ(scratch.read("kept/new.txt"), "first");

  const fs::path pipe = scratch / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  write_file(pipe, "through");
  std::string text(16, '\0');
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(::read(reader, text.data(), text.size()), 0)));
  ::close(reader);
  EXPECT_EQ(text, "through");
  EXPECT_TRUE(fs::is_fifo(pipe));

  fs::create_directory(scratch / "folder");
  try {
    write_file(scratch / "folder", "text");
    FAIL();
  } catch (const study::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("folder is a folder; need the name of a file"));
  }
  const auto broken = [](OutputFile& file) {
    file.write("half");
    throw std::domain_error("no more");
  };
  EXPECT_THROW(write_file(scratch / "broken.txt", broken), std::domain_error);
  for (const char* part : {"broken.txt", "broken.txt.part", "folder.part", "kept/there.txt.part", "pipe.part"})
    EXPECT_FALSE(fs::exists(scratch / part)) << part;
}

TEST(OutputFile, IsNoneThatTheSameCommandReadsByWhateverName) {
  namespace fs = std::filesystem;
  const Scratch scratch;
  scratch.write("scene.yaml", "a");
  scratch.write("other.yaml", "b");
  fs::create_symlink("scene.yaml", scratch / "soft.yaml");
  fs::create_hard_link(scratch / "scene.yaml", scratch / "hard.yaml");
  for (const char* name : {"scene.yaml", "soft.yaml", "hard.yaml"}) {
    EXPECT_THROW(keep_inputs(scratch / name, {scratch / "other.yaml", scratch / "scene.yaml"}), study::InputError);
    EXPECT_THROW(static_cast<void>(output_name((scratch / name).string(), "", true, {scratch / "scene.yaml"})),
                 study::InputError);
  }
  EXPECT_NO_THROW(keep_inputs(scratch / "new.yaml", {scratch / "scene.yaml", ""}));
  EXPECT_NO_THROW(keep_inputs("/dev/null", {"/dev/null"}));
  // A name that nobody gave takes the place of nothing; one that was given, or --force, does.
  EXPECT_THROW(static_cast<void>(output_name("", scratch / "other.yaml", false, {})), study::InputError);
  EXPECT_EQ(output_name("", scratch / "other.yaml", true, {}), (scratch / "other.yaml").string());
  EXPECT_EQ(output_name((scratch / "other.yaml").string(), "", false, {}), (scratch / "other.yaml").string());
}

}  // namespace
}  // namespace withy
