/// \file
/// What beginners do first: a scene to start from, and a look at what in it is hardly meant.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
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

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> pages() {
  std::vector<std::string> all = {"README"};
  for (const auto& entry : std::filesystem::directory_iterator(WITHY_SOURCES "/docs"))
    if (entry.path().extension() == ".md") all.push_back("docs/" + entry.path().stem().string());
  return all;
}

/// The lines of a block, those that a backslash continues as one.
std::vector<std::string> command_lines(std::string block) {
  for (std::size_t at; (at = block.find("\\\n")) != std::string::npos;) block.replace(at, 2, "");
  return lines(block);
}

/// A study of a shipped scene without its comment and the program's folder, which takes seconds; empty where a line is
/// anything else.
std::string study_in(const std::string& line) {
  const std::string command = line.substr(0, line.find(" #")),
                    study = command.substr(std::min(command.find("withy "), command.size()));
  const std::vector<std::string> w = words(study);
  if (w.size() < 3 || (w[1] != "trade" && w[1] != "advise") || !w[2].starts_with("scenes/")) return "";
  return study.substr(0, study.find_last_not_of(' ') + 1);
}

/// The studies that pages before this one run, which are the same there.
std::set<std::string> studies_before(const std::string& page) {
  std::set<std::string> all;
  for (const std::string& other : pages()) {
    if (other >= page) continue;
    for (const auto& [language, text] : blocks(text_of(WITHY_SOURCES "/" + other + ".md")))
      for (const std::string& line : command_lines(language == "sh" ? text : ""))
        if (std::string study = study_in(line); !study.empty()) all.insert(std::move(study));
  }
  return all;
}

/// Runs the lines of a block as a user would type them, `withy` being the program and ~ the folder, but for studies
/// that run elsewhere. A line that says so in its comment ends with another status than 0. \returns what the last one
/// prints
std::string run_lines(const Folder& folder, const std::string& block, const std::set<std::string>& elsewhere) {
  std::string out;
  for (const std::string& line : command_lines(block)) {
    if (line.empty() || line.starts_with('#') || elsewhere.contains(study_in(line))) continue;
    const std::vector<std::string> w = words(line);
    if (w[0].starts_with("scripts/")) {
      EXPECT_TRUE(std::filesystem::exists(WITHY_SOURCES "/" + w[0])) << line;
      continue;
    }
    if (w[0] == "xdg-open") {
      EXPECT_TRUE(std::filesystem::exists(folder.path() / w[1])) << line;
      continue;
    }
    if (w[0] != "withy" && w[0] != "build/release/bin/withy" && w[0] != "mkdir") {
      ADD_FAILURE() << line << "\nrun by no test: its block says which test runs it, as ```sh test=FILE";
      continue;
    }
    const std::string built = "build/release/bin/", program = WITHY_PROGRAM;
    const std::string command = "withy() { '" + program + "' \"$@\"; }; HOME=$PWD; " +
                                (line.starts_with(built) ? line.substr(built.size()) : line);
    const std::size_t status = line.find("exit status ");
    const Finished f = Process(folder, {"/bin/sh", "-c", command}).wait();
    EXPECT_EQ(f.status, status == std::string::npos ? 0 : std::stoi(line.substr(status + 12))) << line << '\n' << f.err;
    if (f.status == 0) {
      EXPECT_EQ(f.err, "") << line;
    }
    out = f.out;
  }
  return out;
}

class Pages : public testing::TestWithParam<std::string> {};

TEST_P(Pages, EveryCommandRunsOnTheScenesThatItHasWritten) {
  const Folder folder;
  const std::set<std::string> elsewhere = studies_before(GetParam());
  std::string out;
  for (const auto& [language, text] : blocks(text_of(WITHY_SOURCES "/" + GetParam() + ".md"))) {
    const std::string first = text.substr(0, text.find('\n'));
    // A file says its name in its first line.
    if (language == "yaml" && first.starts_with("# ") && first.ends_with(".yaml")) {
      folder.write(first.substr(2), text);
    } else if (language == "sh") {
      out = run_lines(folder, text, elsewhere);
    } else if (language == "text output") {
      for (const std::string& line : lines(text))
        EXPECT_THAT(out, HasSubstr(line)) << "the last command says otherwise";
    } else if (language.starts_with("sh test=")) {
      EXPECT_TRUE(std::filesystem::exists(WITHY_SOURCES "/" + language.substr(8))) << language;
    } else {
      EXPECT_FALSE(language.empty() && first.starts_with("withy ") && std::islower(first[6]))
          << first << "\nis a command: its block is one of sh";
    }
  }
}

/// What stands in a line between single backquotes.
std::vector<std::string> quoted(const std::string& line) {
  std::vector<std::string> found;
  for (std::size_t from = line.find('`'); from != std::string::npos;) {
    const std::size_t to = line.find('`', from + 1);
    if (to == std::string::npos) break;
    found.push_back(line.substr(from + 1, to - from - 1));
    from = line.find('`', to + 1);
  }
  return found;
}

TEST_P(Pages, CommandsInRunningTextExistWithTheirOptions) {
  const Folder folder;
  std::map<std::string, std::string> help;
  bool inside = false;
  for (const std::string& line : lines(text_of(WITHY_SOURCES "/" + GetParam() + ".md"))) {
    if (line.starts_with("```")) inside = !inside;
    if (inside) continue;
    for (const std::string& phrase : quoted(line)) {
      const std::vector<std::string> w = words(phrase);
      if (w.size() < 2 || w[0] != "withy" || w[1].starts_with("--")) continue;
      const std::size_t deep = w[1] == "sweep" && w.size() > 2 && !w[2].starts_with('-') ? 3 : 2;
      std::vector<std::string> asked(w.begin() + 1, w.begin() + static_cast<std::ptrdiff_t>(deep));
      asked.emplace_back("--help");
      auto [known, first] = help.try_emplace(phrase.substr(0, phrase.find(" -")));
      if (first) {
        const Finished f = withy(folder, asked);
        EXPECT_EQ(f.status, 0) << phrase << '\n' << f.err;
        known->second = f.out;
      }
      for (const std::string& word : w) {
        if (word.starts_with("--")) {
          EXPECT_THAT(known->second, HasSubstr(word.substr(0, word.find_first_of("=,;")))) << phrase;
        }
      }
    }
  }
}

std::string page_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param.substr(info.param.find('/') + 1);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Documentation, Pages, testing::ValuesIn(pages()), page_name);

TEST(New, EveryKindIsPlausibleAndRuns) {
  const Folder folder;
  for (const std::string kind : {"beam", "satellite", "arm", "turbine"}) {
    Finished f = withy(folder, {"new", kind});
    ASSERT_EQ(f.status, 0) << f.err;
    const std::string file = kind + ".yaml";
    EXPECT_EQ(folder.read(file), folder.read("scenes/new/" + file));
    // What its head says to do can be done.
    std::size_t commands = 0;
    std::stringstream head(folder.read(file));
    for (std::string line; std::getline(head, line) && line.starts_with('#');) {
      if (!line.starts_with("#   withy ")) continue;
      std::stringstream words(line.substr(10, line.find('#', 1) - 10));
      std::vector<std::string> command;
      for (std::string word; words >> word;) command.push_back(word);
      if (command.front() == "advise") continue;  // takes minutes
      if (command.front() != "check" && command.front() != "modes")
        command.insert(command.end(), {"--set", "time.end=0.1"});
      const Finished said = withy(folder, command);
      EXPECT_EQ(said.status, 0) << line << '\n' << said.err;
      ++commands;
    }
    EXPECT_GE(commands, 3U) << kind;
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

TEST(Check, SaysThatABodyHasToBendFarToCloseALoop) {
  const Folder folder;
  folder.write("far.yaml",
               "format: withy/1\ntime: {end: 1}\nbodies:\n  hub: {type: rigid, mass: 20, inertia: [1, 1, 1, 0, 0, 0]}\n"
               "  arm: {type: beam, length: 2, mass_per_length: 1, bending_y: {stiffness: 100, modes: 2}}\nhinges:\n"
               "  shoulder: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n"
               "  root: {type: weld, parent: hub, child: arm}\nconstraints:\n"
               "  pin: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: arm.tip, b: world, offset: {position: [9, 9, "
               "0]}}\n");
  const Finished f = withy(folder, {"check", "far.yaml"});
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, testing::AllOf(HasSubstr("far.yaml:5:"), HasSubstr("the tip of 'arm' deflected by 7"),
                                    HasSubstr("loops that hinges cannot close are closed by bending")));
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
  const std::string light = said({"hinges.elbow.reflected_inertia=1e-6"});
  EXPECT_THAT(light, HasSubstr("/loads/control/hinges/elbow: the servo on 'elbow' drives an inertia of"));
  EXPECT_THAT(light, Not(HasSubstr("the servo on 'shoulder'")));
  // Functions without a moment at the tip, and the remedy that is named.
  EXPECT_THAT(said({}, "scenes/spacecraft.yaml"), HasSubstr("/bodies/right_boom: 1 bending_z mode of clamped-free "
                                                            "carries no moment at the tip"));
  const std::vector<std::string> polynomials = {"bodies.right_boom.bending_y.family=orthogonal-polynomials",
                                                "bodies.right_boom.bending_z.family=orthogonal-polynomials"};
  EXPECT_THAT(said(polynomials, "scenes/spacecraft.yaml"), Not(HasSubstr("/bodies/right_boom")));
  EXPECT_THAT(said({}, "scenes/rotating-blade.yaml"), Not(HasSubstr("clamped-free"))) << "it carries nothing";
  // Functions of an even beam on a blade, and the remedy.
  const std::string blade = "scenes/gallery/wind-turbine-blade.yaml";
  EXPECT_THAT(said({}, blade), Not(HasSubstr("/bodies/blade")));
  EXPECT_THAT(said({"bodies.blade.bending_z.family=clamped-free"}, blade),
              HasSubstr("/bodies/blade: 3 bending_z modes of clamped-free vibrate first at 0.6"));
  EXPECT_THAT(said({"bodies.blade.bending_z.family=clamped-free", "bodies.blade.bending_z.modes=9"}, blade),
              Not(HasSubstr("/bodies/blade")));
}

TEST(Check, SaysWhatManyBodiesShareOnce) {
  const Folder folder;
  std::string bodies, hinges;
  for (int i = 0; i < 60; ++i) {
    const std::string n = std::to_string(i);
    bodies += "  l" + n + ": {type: beam, length: 1, mass_per_length: 1, damping_ratio: " + std::to_string(2 + i) +
              ", bending_y: {stiffness: 100, modes: 2}}\n";
    hinges += "  h" + n + ": {type: revolute, axis: [0, 0, 1], parent: " +
              (i == 0 ? "world" : "l" + std::to_string(i - 1) + ".tip") + ", child: l" + n + "}\n";
  }
  folder.write("chain.yaml", "format: withy/1\ntime: {end: 1}\nbodies:\n" + bodies + "hinges:\n" + hinges);
  const std::string text = withy(folder, {"check", (folder.path() / "chain.yaml").string()}).out;
  EXPECT_THAT(text, HasSubstr("and 57 more: ")) << "each with its own damping ratio";
  EXPECT_THAT(text, HasSubstr("5 to 61"));
  // Twenty bodies are looked at for functions with a moment at the tip.
  EXPECT_THAT(text, HasSubstr("and 17 more: 2 bending_y modes of clamped-free carry no moment at the tip"));
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
