#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/property_tree/xml_parser.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

Finished compare(const Folder& folder, std::vector<std::string> more) {
  std::vector<std::string> arguments = {"compare", "scenes/two-link-slew.yaml", "--set", "time.end=0.2"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return withy(folder, arguments);
}

TEST(Compare, GivesEveryFormulationAtEveryValue) {
  const Folder folder;
  const Finished f = compare(folder, {"--formulations", "ruthless,inconsistent,quadratic", "--over",
                                      "loads.slew.time_scale=0.1685,1.0", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json runs = json::parse(f.out).at("runs");
  ASSERT_EQ(runs.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(runs[i].at("formulation"), (std::vector<std::string>{"ruthless", "inconsistent", "quadratic"})[i % 3]);
    EXPECT_EQ(runs[i].at("value"), i < 3 ? "0.1685" : "1.0");
  }
  EXPECT_EQ(runs[2].at("distance").at("hinges").at("elbow"), 0.0) << "quadratic is the reference";
  EXPECT_GT(runs[3].at("distance").at("tips").at("link2.tip"), 0.0);
  EXPECT_EQ(runs[3].at("distance").at("until"), 0.2);
  EXPECT_NE(runs[4].at("status"), "completed") << "inconsistent diverges at about 0.05 s";
  EXPECT_LT(runs[4].at("distance").at("until"), 0.2);
}

/// Strict forms cannot close loops: a comparison of what nobody asked for by name does without them, and says so.
TEST(Compare, LeavesOutOfItsDefaultsWhatCannotTreatTheScene) {
  const Folder folder;
  const std::vector<std::string> loop = {"compare", "scenes/gallery/four-bar.yaml", "--set", "time.end=0.05"};
  std::vector<std::string> machine = loop, asked = loop;
  machine.emplace_back("--json");
  const Finished f = withy(folder, machine);
  ASSERT_EQ(f.status, 0) << f.err;
  const json j = json::parse(f.out);
  ASSERT_EQ(j.at("runs").size(), 2U);
  EXPECT_EQ(j.at("runs").at(0).at("formulation"), "ruthless");
  EXPECT_EQ(j.at("runs").at(1).at("formulation"), "quadratic");
  ASSERT_EQ(j.at("left_out").size(), 2U);
  EXPECT_EQ(j.at("left_out").at(0).at("formulation"), "inconsistent");
  EXPECT_EQ(j.at("left_out").at(1).at("formulation"), "consistent");
  const std::string why = j.at("left_out").at(1).at("reason");
  EXPECT_THAT(why, HasSubstr("loop"));
  EXPECT_THAT(withy(folder, loop).out, HasSubstr("left out consistent: " + why));
  asked.insert(asked.end(), {"--formulations", "consistent,quadratic"});
  EXPECT_EQ(withy(folder, asked).status, 2) << "what is asked for by name is no default";
}

/// A folder has no `/` in its name: both values would be "name=a_b".
TEST(Compare, KeepsEachValueInAFolderOfItsOwn) {
  const Folder folder;
  const Finished f = compare(folder, {"--formulations", "quadratic", "--over", "name=a/b,a_b", "--out", "c"});
  ASSERT_EQ(f.status, 0) << f.err;
  const auto set = [&](const std::string& run) {
    return json::parse(folder.read("c/" + run + "/quadratic/run.json")).at("set").back();
  };
  EXPECT_EQ(set("name=a_b"), "name=a/b");
  EXPECT_EQ(set("name=a_b_2"), "name=a_b");
}

TEST(Compare, TableSaysWhyARunStopped) {
  const Folder folder;
  const Finished f = compare(folder, {"--formulations", "inconsistent,quadratic", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const std::string why = json::parse(f.out).at("runs").at(0).at("message");
  EXPECT_THAT(compare(folder, {"--formulations", "inconsistent,quadratic"}).out, HasSubstr(why));
}

/// At the start all runs are alike: that tells nothing of how far they are apart later.
TEST(Compare, ARunWithNoOutputInCommonButTheStartHasNoErrors) {
  const Folder folder;
  std::vector<std::string> ends_early = {"--set",          "loads.slew.time_scale=1.2",
                                         "--formulations", "inconsistent",
                                         "--reference",    "exact"};  // singular at 0.0365 s, outputs are 0.05 s apart
  const std::string text = compare(folder, ends_early).out;
  EXPECT_THAT(text, testing::ContainsRegex("singular at 0.0365[0-9]* s +- +-\n"));
  EXPECT_THAT(text, HasSubstr("No errors: it and the reference have no output in common but the start"));
  ends_early.emplace_back("--json");
  const json distance = json::parse(compare(folder, ends_early).out).at("runs").at(0).at("distance");
  EXPECT_TRUE(distance.at("hinges").empty());
  EXPECT_TRUE(distance.at("tips").empty());
  EXPECT_EQ(distance.at("until"), 0.0);
  ends_early.insert(ends_early.end(), {"--set", "time.output=0.001"});
  const json told = json::parse(compare(folder, ends_early).out).at("runs").at(0).at("distance");
  EXPECT_NEAR(told.at("until"), 0.036, 1e-12);
  EXPECT_GT(told.at("hinges").at("elbow"), 0.0);
}

/// x = t reaches 0.6 at 0.6 s of 2 s.
TEST(Compare, ARunThatAnEventEndsSaysWhen) {
  const Folder folder;
  folder.write("block.yaml", R"(format: withy/1
time: {end: 2, output: 0.25}
bodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
initial: {hinges: {slide: {rate: [1]}}}
events: {there: {hinge: slide, value: 0.6, stop: true}}
)");
  const std::string text = withy(folder, {"compare", "block.yaml", "--formulations", "linear,quadratic"}).out;
  EXPECT_THAT(text, HasSubstr("completed by an event at 0.6 s"));
  EXPECT_THAT(text, HasSubstr("linear: The event 'there' ended the run at t = 0.6 s."));
  EXPECT_THAT(withy(folder, {"run", "block.yaml", "--out", "out"}).out, HasSubstr("completed by an event at 0.6 s"));
}

TEST(Compare, ReferenceIsRunWhereItIsNotListed) {
  const Folder folder;
  const Finished f = compare(folder, {"--formulations", "ruthless", "--reference", "consistent", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json j = json::parse(f.out);
  EXPECT_EQ(j.at("reference"), "consistent");
  ASSERT_EQ(j.at("runs").size(), 2U);
  EXPECT_EQ(j.at("runs").at(1).at("formulation"), "consistent");
}

TEST(Compare, LegendOfThePictureSaysHowFarOffEachTipWas) {
  const Folder folder;
  ASSERT_EQ(compare(folder, {"--formulations", "ruthless,quadratic", "--out", "out"}).status, 0);
  const std::string svg = folder.read("out/compare.svg"), before = ">ruthless: ";
  const double off =
      json::parse(folder.read("out/compare.json")).at("runs").at(0).at("distance").at("tips").at("payload.tip");
  const std::size_t at = svg.find(before);
  ASSERT_NE(at, std::string::npos);
  std::size_t digits = 0;
  const double told = std::stod(svg.substr(at + before.size(), 20), &digits);
  const bool thousandths = svg.substr(at + before.size() + digits).starts_with(" mm off<");
  EXPECT_NEAR(told * (thousandths ? 1e-3 : 1e-6), off, 0.06 * off);
  EXPECT_NE(svg.find(">quadratic<"), std::string::npos) << "the reference is off by nothing";
}

/// Trees are seen at the first output in the second half: of 0, 1.1, 2.2 and 3 s that at 2.2 s, and of 5 to 8 s that at
/// 7 s, whose middle is 6.5 s.
TEST(Compare, ThePictureSaysAtWhichTimeItsTreesAreSeen) {
  const Folder folder;
  folder.write("block.yaml", R"(format: withy/1
time: {end: 3, output: 1.1}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
initial: {hinges: {slide: {rate: [0.3]}}}
)");
  const auto picture = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"compare", "block.yaml", "--formulations", "linear,quadratic"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished f = withy(folder, arguments);
    EXPECT_EQ(f.status, 0) << f.err;
    return folder.read(more.back() + "/compare.svg");
  };
  EXPECT_THAT(picture({"--out", "early"}), HasSubstr(" [m], at 2.2 s or where the run stopped"));
  EXPECT_THAT(picture({"--set", "initial.time=5", "--set", "time.end=8", "--set", "time.output=1", "--out", "late"}),
              HasSubstr(" [m], at 7 s or where the run stopped"));
}

TEST(Compare, KeepsResultsAndAWellFormedPicture) {
  const Folder folder;
  const Finished f =
      compare(folder, {"--formulations", "inconsistent,quadratic", "--set", "time.output=0.01", "--out", "out"});
  ASSERT_EQ(f.status, 0) << f.err;
  for (const char* formulation : {"inconsistent", "quadratic"}) {
    const std::string at = std::string("out/") + formulation;
    EXPECT_EQ(json::parse(folder.read(at + "/run.json")).at("formulation"), formulation);
    EXPECT_GT(lines(folder.read(at + "/results.csv")).size(), 2U);
  }
  EXPECT_EQ(json::parse(folder.read("out/compare.json")).at("runs").size(), 2U);

  std::istringstream svg(folder.read("out/compare.svg"));
  boost::property_tree::ptree tree;
  ASSERT_NO_THROW(boost::property_tree::read_xml(svg, tree));
  std::size_t panels = 0;
  std::size_t curves = 0;
  for (const auto& [name, child] : tree.get_child("svg")) {
    if (name != "g") continue;
    ++panels;
    curves += child.count("polyline");
  }
  EXPECT_EQ(panels, 6U) << "the arm, the error, deflections along y of two links, two angles";
  const std::size_t bodies = 5;
  EXPECT_EQ(curves, 2 * bodies + 1 + 2 * 4) << "of the arm, of all but the reference, a curve a formulation";
}

// Times of frames increase from 0 to 1, there is a shape for each, and the run that stops has its cross.
TEST(Compare, LeavesAMovingPicture) {
  const Folder folder;
  ASSERT_EQ(compare(folder,
                    {"--formulations", "inconsistent,quadratic", "--set", "loads.slew.time_scale=1.2", "--out", "out"})
                .status,
            0);
  std::istringstream svg(folder.read("out/motion.svg"));
  boost::property_tree::ptree tree;
  ASSERT_NO_THROW(boost::property_tree::read_xml(svg, tree));
  std::size_t moving = 0, crosses = 0;
  for (const auto& [name, child] : tree.get_child("svg.g")) {
    if (name == "g") ++crosses;
    if (name != "polyline" || child.count("animate") == 0) continue;
    ++moving;
    const std::string times = child.get<std::string>("animate.<xmlattr>.keyTimes");
    const std::string shapes = child.get<std::string>("animate.<xmlattr>.values");
    EXPECT_EQ(std::count(times.begin(), times.end(), ';'), std::count(shapes.begin(), shapes.end(), ';'));
    EXPECT_EQ(times.substr(0, 2), "0;");
    EXPECT_EQ(times.substr(times.size() - 2), ";1");
    EXPECT_EQ(shapes.find("nan"), std::string::npos);
  }
  EXPECT_EQ(moving, 2U * 5U) << "bodies of two runs";
  EXPECT_EQ(crosses, 1U);
}

TEST(Compare, AMalformedVariationIsBadInput) {
  const Folder folder;
  for (const char* over : {"loads.slew.time_scale", "=1", "loads.slew.time_scale="}) {
    const Finished f = compare(folder, {"--over", over});
    EXPECT_EQ(f.status, 2) << over;
    EXPECT_THAT(f.err, HasSubstr("PATH=VALUE"));
  }
}

}  // namespace
}  // namespace withy::test
