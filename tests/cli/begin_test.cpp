/// \file
/// What beginners do first: a scene to start from, and a look at what in it is hardly meant.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// What stands in the fenced blocks of a page: the language, and the lines.
std::vector<std::pair<std::string, std::string>> blocks(const std::string& page) {
  std::vector<std::pair<std::string, std::string>> all;
  bool inside = false;
  for (const std::string& line : lines(page)) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (inside) all.emplace_back(line.substr(3), "");
    } else if (inside) {
      all.back().second += line + '\n';
    }
  }
  return all;
}

TEST(Tutorial, EveryCommandRunsOnTheScenesThatItHasWritten) {
  const Folder folder;
  std::ifstream in(WITHY_SOURCES "/docs/tutorial.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}}, program = WITHY_PROGRAM;
  int commands = 0;
  for (const auto& [language, text] : blocks(page)) {
    // A file says its name in its first line.
    if (language == "yaml") folder.write(text.substr(2, text.find('\n') - 2), text);
    if (language != "sh") continue;
    for (const std::string& line : lines(text)) {
      ASSERT_TRUE(line.starts_with("withy ")) << line;
      const Finished f = Process(folder, {"/bin/sh", "-c", '\'' + program + "' " + line.substr(6)}).wait();
      EXPECT_EQ(f.status, 0) << line << '\n' << f.err;
      EXPECT_EQ(f.err, "") << line;
      ++commands;
    }
  }
  EXPECT_GE(commands, 12);
}

TEST(New, EveryKindIsPlausibleAndRuns) {
  const Folder folder;
  for (const std::string kind : {"beam", "satellite", "arm", "turbine"}) {
    Finished f = withy(folder, {"new", kind});
    ASSERT_EQ(f.status, 0) << f.err;
    const std::string file = kind + ".yaml";
    EXPECT_EQ(folder.read(file), folder.read("scenes/new/" + file));
    f = withy(folder, {"check", file, "--strict"});
    EXPECT_EQ(f.status, 0) << f.out << f.err;
    EXPECT_THAT(f.out, HasSubstr(file + " is valid"));
    f = withy(folder, {"run", file, "--json", "--out", kind});
    ASSERT_EQ(f.status, 0) << f.err;
    const json run = json::parse(f.out);
    EXPECT_EQ(run.at("status"), "completed");
    EXPECT_EQ(run.at("message"), "") << kind;
    if (kind == "satellite") {
      // Its momenta are zero but for rounding, and that is no drift of them.
      EXPECT_LT(run.at("certificate").at("momentum_drift").at("linear"), 1e-9);
      EXPECT_LT(run.at("certificate").at("momentum_drift").at("angular"), 1e-9);
    }
    for (const json& indicator : run.at("certificate").at("indicators"))
      EXPECT_LT(indicator.at("value"), indicator.at("limit")) << kind << ": " << indicator;
  }
  EXPECT_EQ(withy(folder, {"new", "beam"}).status, 2) << "what is there is not overwritten";
  EXPECT_EQ(withy(folder, {"new", "beam", "--force"}).status, 0);
  const Finished f = withy(folder, {"new", "satelite"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("did you mean \"satellite\"?"));
}

TEST(Check, SaysWhatIsHardlyMeant) {
  const Folder folder;
  const auto said = [&](const std::vector<std::string>& settings, const std::string& scene = "scenes/new/arm.yaml") {
    std::vector<std::string> words = {"check", scene};
    for (const std::string& s : settings) words.insert(words.end(), {"--set", s});
    const Finished f = withy(folder, words);
    EXPECT_EQ(f.status, 0) << f.err;
    return f.out;
  };
  EXPECT_THAT(said({}), HasSubstr("nothing is implausible"));
  // The place is that of the body, hinge or frame.
  const std::string tiny = said({"bodies.upper_link.length=8 mm"});
  EXPECT_THAT(tiny,
              HasSubstr("scenes/new/arm.yaml:22:5: /bodies/upper_link: a flexible body 0.008 m long in a tree of"));
  EXPECT_THAT(said({"bodies.upper_link.mass_per_length=1e-5", "bodies.payload.mass=500"}),
              HasSubstr("a flexible body of 1e-05 kg carries 5"));
  EXPECT_THAT(said({"bodies.fore_link.damping_ratio=5"}), HasSubstr("damping ratio 5 is above 1"));
  EXPECT_THAT(said({"bodies.fore_link.bending_y.modes=0"}), HasSubstr("/bodies/fore_link: "));
  EXPECT_THAT(said({"bodies.payload.frames={handle: {position: [0, 0, 1]}}"}),
              HasSubstr("nothing uses the frame 'payload.handle'"));
  // Next to no rotor behind the elbow's gains.
  const std::string light = said({"bodies.elbow_rotor.inertia=[1e-6, 1e-6, 1e-6, 0, 0, 0]"});
  EXPECT_THAT(light, HasSubstr("/loads/control/hinges/elbow: the servo on 'elbow' drives an inertia of"));
  EXPECT_THAT(light, Not(HasSubstr("the servo on 'shoulder'")));
  // Functions without a moment at the tip, and the remedy that is named.
  EXPECT_THAT(said({}, "scenes/spacecraft.yaml"), HasSubstr("/bodies/right_boom: 3 bending_y and 1 bending_z modes of "
                                                            "clamped-free carry no moment at the tip"));
  const std::vector<std::string> polynomials = {"bodies.right_boom.bending_y.family=orthogonal-polynomials",
                                                "bodies.right_boom.bending_z.family=orthogonal-polynomials"};
  EXPECT_THAT(said(polynomials, "scenes/spacecraft.yaml"), Not(HasSubstr("/bodies/right_boom")));
  EXPECT_THAT(said({}, "scenes/rotating-blade.yaml"), Not(HasSubstr("clamped-free"))) << "it carries nothing";
  Finished f = withy(folder, {"check", "scenes/new/arm.yaml", "--set", "bodies.fore_link.damping_ratio=5", "--json"});
  EXPECT_EQ(json::parse(f.out).at("remarks").size(), 1U);
  f = withy(folder, {"check", "scenes/new/arm.yaml", "--set", "bodies.fore_link.damping_ratio=5", "--strict"});
  EXPECT_EQ(f.status, 2);
  f = withy(folder, {"check", "scenes/new/arm.yaml", "--set", "bodies.fore_link.lenght=5"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("length"));
}

}  // namespace
}  // namespace withy::test
