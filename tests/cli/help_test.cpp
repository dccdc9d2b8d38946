#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::vector<std::string> commands = {
    "run",         "compare",   "inverse",  "terms", "trade",      "advise", "tune",    "eval",   "inspect",
    "equilibrium", "linearize", "response", "modes", "import",     "bench",  "plugins", "schema", "new",
    "check",       "report",    "plot",     "sweep", "completion", "manual", "fmu",     "export"};

/// The command lines under "Examples:" in a help text, without the program's name.
std::vector<std::vector<std::string>> examples(const std::string& help) {
  std::vector<std::vector<std::string>> found;
  bool under_head = false;
  for (const std::string& line : lines(help)) {
    if (line == "Examples:") under_head = true;
    std::vector<std::string> w = words(line);
    if (under_head && w.size() > 1 && w[0] == "withy") found.push_back({w.begin() + 1, w.end()});
  }
  return found;
}

TEST(Help, VersionIsTheProjects) {
  const Folder folder;
  const Finished f = withy(folder, {"--version"});
  EXPECT_EQ(f.status, 0);
  EXPECT_EQ(f.out, "withy " WITHY_VERSION "\n");
  EXPECT_EQ(f.err, "");
}

TEST(Help, NamesEveryCommand) {
  const Folder folder;
  const Finished f = withy(folder, {"--help"});
  EXPECT_EQ(f.status, 0);
  for (const std::string& c : commands) EXPECT_THAT(f.out, HasSubstr("\n  " + c + " "));
}

TEST(Help, AnUnknownCommandIsCalledThatWithTheNearest) {
  const Folder folder;
  const Finished near = withy(folder, {"comparre", "scenes/pendulum.yaml"});
  EXPECT_EQ(near.status, 2);
  EXPECT_EQ(near.out, "");
  EXPECT_THAT(near.err, HasSubstr("\"comparre\" is no command; did you mean 'compare'?"));
  const Finished far = withy(folder, {"fly"});
  EXPECT_EQ(far.status, 2);
  for (const std::string& c : commands) EXPECT_THAT(far.err, HasSubstr(c));
  EXPECT_EQ(withy(folder, {}).status, 2);
  EXPECT_EQ(withy(folder, {"run", "scenes/pendulum.yaml", "--checkpoint", "nan"}).status, 2);
}

/// Lines of tables, around their rules, that have more characters than a terminal shows.
std::vector<std::string> too_wide(const std::string& out) {
  std::vector<std::string> wide;
  const std::vector<std::string> all = lines(out);
  bool in_table = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool rule = all[i].size() > 2 && all[i].find_first_not_of('-') == std::string::npos;
    in_table = rule || (in_table && !all[i].empty());
    const bool head =
        i + 1 < all.size() && all[i + 1].size() > 2 && all[i + 1].find_first_not_of('-') == std::string::npos;
    const auto characters = std::count_if(all[i].begin(), all[i].end(), [](char c) { return (c & '\xC0') != '\x80'; });
    if ((in_table || head) && characters > 100) wide.push_back(all[i]);
  }
  return wide;
}

/// Pages of runs and studies in a folder.
std::size_t pages(const Folder& folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
    count += entry.path().filename() == "report.html" ? 1 : 0;
  return count;
}

class HelpOf : public testing::TestWithParam<std::string> {};

TEST_P(HelpOf, HasExamplesThatRun) {
  const Folder folder;
  const Finished help = withy(folder, {GetParam(), "--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(help.err, "");
  const auto found = examples(help.out);
  ASSERT_FALSE(found.empty()) << help.out;
  for (const auto& arguments : found) {
    const std::size_t before = pages(folder);
    const Finished f = withy(folder, arguments);
    if (pages(folder) > before) {
      EXPECT_THAT(f.out, HasSubstr("report.html")) << testing::PrintToString(arguments) << " leaves a page and says it";
    }
    EXPECT_EQ(f.status, 0) << testing::PrintToString(arguments) << '\n' << f.err;
    EXPECT_NE(f.out, "");
    EXPECT_THAT(too_wide(f.out), testing::IsEmpty()) << testing::PrintToString(arguments);
    EXPECT_EQ(f.err, "") << "standard error is for errors, and for progress on a terminal";
  }
}

TEST_P(HelpOf, AnUnknownOptionIsBadInputAndLeavesStandardOutputAlone) {
  const Folder folder;
  const Finished f = withy(folder, {GetParam(), "--no-such-option"});
  EXPECT_EQ(f.status, 2);
  EXPECT_EQ(f.out, "");
  EXPECT_NE(f.err, "");
}

TEST(Help, ColoursAreForTerminalsThatWantThem) {
  const Folder folder;
  const std::string program = WITHY_PROGRAM;
  // `script` gives a program a terminal.
  const auto on_terminal = [&](const std::string& before) {
    return Process(folder, {"/bin/sh", "-c",
                            "exec env TERM=xterm " + before + " script -qec \"'" + program +
                                "' run scenes/pendulum.yaml --out out --force\" /dev/null"})
        .wait()
        .out;
  };
  EXPECT_THAT(on_terminal(""), HasSubstr("\033[32mcompleted\033[0m"));
  EXPECT_THAT(on_terminal("NO_COLOR=1"), testing::Not(HasSubstr("\033[32m")));
  EXPECT_THAT(withy(folder, {"run", "scenes/pendulum.yaml", "--out", "out", "--force"}).out,
              testing::Not(HasSubstr("\033")));
}

TEST(Help, SentencesFitATerminalAndStayWholeElsewhere) {
  const Folder folder;
  const auto widest = [](const std::string& text) {
    std::ptrdiff_t most = 0;
    for (const std::string& line : lines(text))
      most = std::max(most, std::count_if(line.begin(), line.end(), [](char c) { return (c & '\xC0') != '\x80'; }));
    return most;
  };
  for (const std::string command : {"run scenes/two-link-slew.yaml --out out --force",
                                    "check scenes/two-link-slew.yaml", "inspect scenes/two-link-slew.yaml",
                                    "plugins quadratic", "response scenes/pd-arm.yaml --input control.shoulder"}) {
    const std::string call = std::string("'") + WITHY_PROGRAM + "' " + command;
    const auto shell = [&](const std::string& text) { return Process(folder, {"/bin/sh", "-c", text}).wait().out; };
    const std::string piped = shell("exec " + call);
    const std::string shown = shell("exec env NO_COLOR=1 script -qec \"" + call + " 2>/dev/null\" /dev/null");
    EXPECT_GT(widest(piped), 100) << command << ": a command whose sentences are short shows nothing";
    EXPECT_GT(widest(shown), 20) << command;
    EXPECT_LE(widest(shown), 100 + 1) << command << "\n" << shown;  // a terminal's lines end with \r\n
  }
}

/// What bash offers behind the words.
std::vector<std::string> completed(const Folder& folder, const std::string& typed) {
  const std::string script = withy(folder, {"completion", "bash"}).out;
  const Finished f =
      Process(folder, {"/bin/bash", "-c",
                       script + "\ncompopt() { :; }\nwithy() { '" WITHY_PROGRAM "' \"$@\"; }\nCOMP_WORDS=(" + typed +
                           ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_withy\necho ${COMPREPLY[@]}"})
          .wait();
  EXPECT_EQ(f.err, "") << typed;
  return words(f.out);
}

TEST(Help, BashCompletesCommandsOptionsWordsAndFiles) {
  const Folder folder;
  using testing::Contains;
  using testing::ElementsAre;
  EXPECT_THAT(completed(folder, "withy com"), testing::UnorderedElementsAre("compare", "completion"));
  EXPECT_THAT(completed(folder, "withy run --form"), ElementsAre("--formulation"));
  EXPECT_THAT(completed(folder, "withy run scene.yaml --estimate a"), testing::UnorderedElementsAre("auto", "always"));
  EXPECT_THAT(completed(folder, "withy sweep co"), ElementsAre("collect"));
  EXPECT_THAT(completed(folder, "withy sweep run --sh"), ElementsAre("--shard"));
  EXPECT_THAT(completed(folder, "withy completion z"), ElementsAre("zsh"));
  EXPECT_THAT(completed(folder, "withy run scenes/pendulu"), Contains("scenes/pendulum.yaml"));
  EXPECT_THAT(completed(folder, "withy run scenes/pendulum.yaml --checkpoint 1"), testing::IsEmpty());
  EXPECT_THAT(completed(folder, "withy new ''"), testing::UnorderedElementsAre("beam", "satellite", "arm", "turbine"));
}

TEST(Help, BashCompletesPluginsByTheirIds) {
  const Folder folder;
  using testing::ElementsAre;
  EXPECT_THAT(completed(folder, "withy run s.yaml --formulation quad"), ElementsAre("quadratic"));
  EXPECT_THAT(completed(folder, "withy run s.yaml --integrator dop"),
              testing::UnorderedElementsAre("dopri5", "dop853"));
  EXPECT_THAT(completed(folder, "withy compare s.yaml --formulations linear,rut"), ElementsAre("linear,ruthless"));
  EXPECT_THAT(completed(folder, "withy trade s.yaml --families clamped-l"), ElementsAre("clamped-loaded"));
}

/// What zsh runs where it is to complete the value of an option: its script with a stand-in for _arguments.
std::string zsh_action(const Folder& folder, const std::string& command, const std::string& option) {
  const std::string script = withy(folder, {"completion", "zsh"}).out;
  const std::string call = script.substr(0, script.rfind("_withy_\n")) + "\nwithy() { '" WITHY_PROGRAM "' \"$@\"; }\n" +
                           "_arguments() { local s a; for s in \"$@\"; do [[ $s == *" + option +
                           "* ]] && eval \"a=( ${s##*: :} )\" && print -r -- $a; done }\n_withy_" + command;
  return Process(folder, {"/usr/bin/env", "zsh", "-f", "-c", call}).wait().out;
}

TEST(Help, ZshCompletesPluginsByTheirIds) {
  const Folder folder;
  if (Process(folder, {"/bin/sh", "-c", "command -v zsh"}).wait().out.empty()) GTEST_SKIP() << "zsh is not installed";
  EXPECT_THAT(zsh_action(folder, "run", "--formulation"),
              testing::AllOf(StartsWith("compadd - auto "), HasSubstr(" quadratic ")));
  EXPECT_THAT(zsh_action(folder, "trade", "--integrators"),
              testing::AllOf(StartsWith("_sequence compadd - "), HasSubstr(" dopri5 ")));
}

TEST(Help, WhatIsMissingIsSaidWithItsMeaning) {
  const Folder folder;
  EXPECT_THAT(withy(folder, {"run"}).err, HasSubstr("SCENE is missing: Scene file"));
  EXPECT_THAT(withy(folder, {"new"}).err, HasSubstr("KIND is missing: beam, satellite, arm or turbine"));
  EXPECT_THAT(withy(folder, {"sweep"}).err, HasSubstr("which command? sweep knows run, submit, status, collect, case"));
  EXPECT_THAT(withy(folder, {}).err, HasSubstr("which command? withy knows new, check, run"));
}

TEST(Help, WhatMayBeLeftOutOrRepeatedIsSaidInTheManualAsInTheHelp) {
  const Folder folder;
  const std::string manual = withy(folder, {"manual"}).out;
  for (const char* usage :
       {"\\fBwithy new\\fR \\fIKIND\\fR [\\fIFILE\\fR] [\\fIoptions\\fR]",
        "\\fBwithy plugins\\fR [\\fINAME\\fR] [\\fIoptions\\fR]",
        "\\fBwithy report\\fR \\fIRUN\\fR... [\\fIoptions\\fR]", "\\fBwithy check\\fR \\fISCENE\\fR [\\fIoptions\\fR]"})
    EXPECT_NE(manual.find(usage), std::string::npos) << usage;
}

/// The store is given by its place or by name, and either alone does.
TEST(Help, WhatIsNeededByItsPlaceOrByNameIsNeededOnce) {
  const Folder folder;
  const std::string help = withy(folder, {"sweep", "status", "--help"}).out;
  EXPECT_THAT(help, HasSubstr("STORE STORE REQUIRED"));
  EXPECT_EQ(help.find("REQUIRED"), help.rfind("REQUIRED")) << help;
  EXPECT_THAT(withy(folder, {"sweep", "status"}).err, HasSubstr("STORE is missing"));
}

TEST_P(HelpOf, NamesTheOptionsThatCompletionAndManualName) {
  const Folder folder;
  std::string manual;
  for (const char c : withy(folder, {"manual"}).out)
    if (c != '\\') manual += c;  // roff writes \- for -
  const std::vector<std::string> made = {manual, withy(folder, {"completion", "bash"}).out,
                                         withy(folder, {"completion", "zsh"}).out};
  EXPECT_NE(manual.find("withy " + GetParam()), std::string::npos);
  for (const std::string& word : words(withy(folder, {GetParam(), "--help"}).out)) {
    if (!word.starts_with("--")) continue;
    const std::string option = word.substr(0, word.find_first_not_of("abcdefghijklmnopqrstuvwxyz-"));
    for (const std::string& text : made) EXPECT_NE(text.find(option), std::string::npos) << option;
  }
}

INSTANTIATE_TEST_SUITE_P(Commands, HelpOf, testing::ValuesIn(commands),
                         [](const auto& parameter) { return parameter.param; });

TEST(Help, NothingToDoOrAnUnknownCommandIsBadInput) {
  const Folder folder;
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{}, {"fly"}}) {
    const Finished f = withy(folder, arguments);
    EXPECT_EQ(f.status, 2);
    EXPECT_EQ(f.out, "");
    EXPECT_THAT(f.err, HasSubstr("--help"));
  }
}

}  // namespace
}  // namespace withy::test
