#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <string>
#include <string_view>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const std::vector<std::string> arm = {"advise", "scenes/driven-arm.yaml", "--set", "time.end=3"};

Finished advise(const Folder& folder, std::vector<std::string> more, std::vector<std::string> first = arm) {
  first.insert(first.end(), more.begin(), more.end());
  return withy(folder, first);
}

/// What `withy` writes to a terminal that its standard error is; nothing where there are no terminals.
std::optional<std::string> on_a_terminal(const Folder& folder, std::vector<std::string> words) {
  const int ours = ::posix_openpt(O_RDWR | O_NOCTTY);
  if (ours < 0 || ::grantpt(ours) != 0 || ::unlockpt(ours) != 0) return {};
  const char* const terminal = ::ptsname(ours);
  words.insert(words.begin(), WITHY_PROGRAM);
  std::string command = "exec 2>" + std::string(terminal) + ";";
  for (const std::string& word : words) command += " '" + word + "'";
  const int held = ::open(terminal, O_RDWR | O_NOCTTY);  // what was written is there to be read after the end
  EXPECT_EQ(Process(folder, {"/bin/sh", "-c", command}).wait().status, 0);
  // The system hands on what was written in its own time, and in order.
  constexpr std::string_view last = "and that is all";
  EXPECT_EQ(::write(held, last.data(), last.size()), static_cast<ssize_t>(last.size()));
  std::string text;
  for (std::array<char, 4096> part; !text.ends_with(last);) {
    const ssize_t read = ::read(ours, part.data(), part.size());
    if (read <= 0) break;
    text.append(part.data(), static_cast<std::size_t>(read));
  }
  ::close(held);
  ::close(ours);
  return text;
}

/// On a terminal, lines that stay say what has been found; where standard error is none, nothing does.
TEST(Advise, TellsWhatItHasFoundWhileItSearches) {
  const Folder folder;
  const std::vector<std::string> call = {
      "advise", "scenes/pendulum.yaml", "--formulations", "quadratic", "--integrators", "dopri5", "--accuracy", "1%"};
  const std::optional<std::string> on_terminal = on_a_terminal(folder, call);
  if (!on_terminal) GTEST_SKIP() << "no terminals here";
  const std::string& told = *on_terminal;
  EXPECT_THAT(told, HasSubstr(" s  the search takes 10 s of CPU time at most"));
  EXPECT_THAT(told, HasSubstr(" s  reference so far: "));
  EXPECT_THAT(told, HasSubstr(" s  so far: quadratic, dopri5 at "));
  EXPECT_LT(told.find("reference so far"), told.find("  so far: quadratic"));
  const Finished f = withy(folder, call);
  EXPECT_EQ(f.status, 0);
  EXPECT_EQ(f.err, "");
  EXPECT_THAT(f.out, Not(HasSubstr("so far")));
}

/// Greatest share of what is allowed of an output that the model and the reference together may be off by.
double use_with_own(const json& model, const json& reference) {
  double use = 0;
  for (const auto& [output, allowed] : reference.at("allowed").items()) {
    const double off = model.at("distances").at(output), own = reference.at("own_error").at(output);
    use = std::max(use, (off + own) / allowed.get<double>());
  }
  return use;
}

/// The two-link arm driven hard: 10 % of a deflection is not to be had without the stiffening of link 2.
TEST(Advise, PicksAModelWhoseErrorHoldsTheAccuracyAsCompareMeasuresIt) {
  const Folder folder;
  const Finished f = advise(folder, {"--accuracy", "10%", "--modes", "1,2", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json j = json::parse(f.out);
  const json& advice = j.at("advice");
  EXPECT_LE(use_with_own(advice, j.at("reference")), 1);
  std::vector<std::string> compare = {"compare", "scenes/driven-arm.yaml", "--set", "time.end=3",
                                      "--json",  "--formulations",         "exact", "--reference"};
  // The same error, as another command measures it: the scene as advised against `exact` with its modes.
  compare.push_back(advice.at("formulation"));
  for (const auto& o : advice.at("overrides")) {
    compare.emplace_back("--set");
    compare.push_back(o);
  }
  const json runs = json::parse(withy(folder, compare).out).at("runs");
  const double allowed = j.at("reference").at("allowed").at("payload.tip");
  for (const json& run : runs) {
    if (run.at("formulation") != "exact") continue;
    EXPECT_LE(run.at("distance").at("tips").at("payload.tip").get<double>(), 1.5 * allowed) << "modes are the same";
  }
}

/// The tip of the blade goes around 16 m and is bent by half a metre: a share of that way would be a sixth of the
/// bending.
TEST(Advise, HoldsTheAccuracyInDeflectionsAndEffortsToo) {
  const Folder folder;
  const Finished f = advise(folder, {"--json"}, {"advise", "scenes/spin-up.yaml"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json j = json::parse(f.out);
  EXPECT_EQ(j.at("outputs"), json({"blade.tip", "blade.tip.deflection", "axle.motion_effort"}));
  const json &ranges = j.at("reference").at("ranges"), &off = j.at("advice").at("distances");
  for (const std::string output : j.at("outputs"))
    EXPECT_LE(off.at(output).get<double>(), 0.01 * ranges.at(output).get<double>()) << output;
  EXPECT_LT(ranges.at("blade.tip.deflection").get<double>(), 0.6);
  EXPECT_NE(j.at("advice").at("formulation"), "ruthless");
  EXPECT_NE(j.at("advice").at("formulation"), "linear");
}

TEST(Advise, WhatIsNextUpHoldsTheAccuracy) {
  const Folder folder;
  const json j = json::parse(advise(folder, {"--json"}, {"advise", "scenes/spin-up.yaml"}).out);
  ASSERT_FALSE(j.at("next_up").empty());
  for (const json& up : j.at("next_up")) EXPECT_LE(use_with_own(up, j.at("reference")), 1);
}

// Why exact was not chosen, and that it is the next one up, were two runs with two costs.
TEST(Advise, TellsOneCostOfAFormulation) {
  const Folder folder;
  const std::string out = advise(folder, {"--formulations", "quadratic,exact", "--integrators", "imex,dop853"},
                                 {"advise", "scenes/two-link-slew.yaml", "--accuracy", "1%"})
                              .out;
  const auto number = [&](const std::string& pattern) {
    std::smatch found;
    EXPECT_TRUE(std::regex_search(out, found, std::regex(pattern))) << pattern << '\n' << out;
    return found.size() < 2 ? 0.0 : std::stod(found[1]);
  };
  const double cost = number("\ncost +([0-9.]+) ms"), up = number("\nnext up +exact, [^\n]* ([0-9.]+) ms");
  EXPECT_LE(number("exact: holds it at ([0-9.]+) times the cost") * cost, 1.1 * up) << "ratios have two digits";
}

TEST(Advise, BeginsWithWhatTheAccuracyIsOf) {
  const Folder folder;
  const std::string out = advise(folder, {"--modes", "1,2", "--accuracy", "20%"}).out;
  EXPECT_EQ(
      out.substr(0, out.find('\n')),
      "driven arm: 20 % of its own range for each of shoulder, elbow, link1.tip, link1.tip.deflection, link2.tip, "
      "link2.tip.deflection, payload.tip");
  const std::string both =
      advise(folder, {"--modes", "1", "--accuracy", "20%,5deg", "--output", "shoulder,payload.tip"}).out;
  EXPECT_EQ(both.substr(0, both.find('\n')),
            "driven arm: 20 % of its own range and 5 deg for each of shoulder, payload.tip");
}

TEST(Advise, WhereThereIsNoneItSaysWhatWasMeasured) {
  const Folder folder;
  const Finished f = advise(folder, {"--formulations", "ruthless", "--modes", "1", "--accuracy", "3%"});
  EXPECT_EQ(f.status, 1);
  EXPECT_THAT(f.err, testing::ContainsRegex("Measured: .* s of CPU time of the 10 allowed"));
}

TEST(Advise, NothingCheaperAmongItsProbesPasses) {
  const Folder folder;
  const json j = json::parse(advise(folder, {"--accuracy", "10%", "--modes", "1,2", "--json"}).out);
  const double cost = j.at("advice").at("cost_seconds");
  for (const json& p : j.at("probes")) {
    EXPECT_NE(p.at("formulation"), "inconsistent");
    if (p.at("outcome") != "passed") continue;
    EXPECT_GE(p.at("cost_seconds").get<double>(), 0.999 * cost);
  }
}

/// A plate's modes are chosen as those of beams are; without any it would be another scene.
TEST(Advise, PlatesKeepModes) {
  const Folder folder;
  const Finished f =
      advise(folder, {"--accuracy", "5%", "--modes", "1,2", "--json"}, {"advise", "scenes/solar-panel.yaml"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json j = json::parse(f.out);
  EXPECT_GE(j.at("advice").at("modes").get<int>(), 1);
  EXPECT_GE(j.at("reference").at("modes").get<int>(), 2);
  EXPECT_EQ(j.at("reference").at("formulation"), "quadratic") << "a plate has no exact kinematics";
  EXPECT_THAT(j.at("advice").at("scene_lines").get<std::string>(), testing::ContainsRegex("modes: [1-9]"));
}

TEST(Advise, InconsistentIsNeverAdvised) {
  const Folder folder;
  const Finished f = advise(folder, {"--formulations", "inconsistent,quadratic"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("'inconsistent' is never advised"));
}

TEST(Advise, AnAbsoluteAccuracyOfNamedOutputs) {
  const Folder folder;
  const Finished f =
      advise(folder, {"--accuracy", "2mm,0.5deg", "--output", "payload.tip,elbow", "--modes", "1,2", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json j = json::parse(f.out);
  EXPECT_EQ(j.at("outputs"), json({"payload.tip", "elbow"}));
  EXPECT_DOUBLE_EQ(j.at("reference").at("allowed").at("payload.tip").get<double>(), 2e-3);
  EXPECT_LE(j.at("advice").at("distances").at("payload.tip").get<double>(), 2e-3);
  EXPECT_LE(j.at("advice").at("distances").at("elbow").get<double>(), 0.5 * 3.14159266 / 180);
}

TEST(Advise, WhatCannotBeAskedIsBadInputAndSaysWhatCan) {
  const Folder folder;
  Finished f = advise(folder, {"--output", "elbow_tip"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("payload.tip"));
  for (const char* accuracy : {"0", "-1%", "3 kg", "1%,2%", "150%"})
    EXPECT_EQ(advise(folder, {"--accuracy", accuracy}).status, 2) << accuracy;
  f = advise(folder, {"--accuracy", "1mm", "--output", "elbow"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("asks nothing"));
}

TEST(Advise, WhereNoCandidateHoldsTheAccuracyItSaysWhichIsNearest) {
  const Folder folder;
  const Finished f = advise(folder, {"--formulations", "ruthless", "--modes", "1", "--accuracy", "2%"});
  EXPECT_EQ(f.status, 1);
  EXPECT_EQ(f.out, "");
  EXPECT_THAT(f.err, HasSubstr("none of the candidates holds 2 %"));
}

/// A strip that is let go: what few modes cannot carry shows at its tip at once.
TEST(Advise, WhereEightModesWillNotDoMoreAreAdvised) {
  const Folder folder;
  const Finished f = advise(folder, {"--accuracy", "0.1%", "--formulations", "exact", "--json"},
                            {"advise", "scenes/gallery/flexible-pendulum.yaml"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json j = json::parse(f.out);
  EXPECT_GT(j.at("advice").at("modes").get<int>(), 8);
  EXPECT_LE(j.at("advice").at("modes").get<int>(), 16);
}

TEST(Advise, SaysInWordsWhyAndWhatIsLeftOut) {
  const Folder folder;
  const std::string out = advise(folder, {"--modes", "1,2", "--accuracy", "10%"}).out;
  for (const char* part : {"\nadvice ", "\nerror ", "\nwhy ", "ruthless: ", "\nleft out ", "\nnext up ", "\nmeasured ",
                           "\nformulation: ", "\nintegrator: {name: "})
    EXPECT_THAT(out, HasSubstr(part));
}

TEST(Advise, WritesTheSceneWithItsComments) {
  const Folder folder;
  const Finished f = advise(folder, {"--modes", "1", "--write", "advised.yaml", "--accuracy", "5%", "--json"},
                            {"advise", "scenes/spin-up.yaml"});
  ASSERT_EQ(f.status, 0) << f.err;
  const std::string text = folder.read("advised.yaml");
  EXPECT_THAT(text, HasSubstr("# Spin-up of a flexible blade"));
  EXPECT_THAT(text, HasSubstr("# the moment it needs is axle.motion_effort"));
  EXPECT_THAT(text, HasSubstr("modes: 1"));
  const json advice = json::parse(f.out).at("advice");
  // Running the file is running what was advised.
  const json run = json::parse(withy(folder, {"run", "advised.yaml", "--json", "--estimate", "never"}).out);
  EXPECT_EQ(run.at("formulation"), advice.at("formulation"));
  EXPECT_EQ(run.at("integrator"), advice.at("integrator"));
  EXPECT_EQ(run.at("evaluations"), advice.at("evaluations"));
}

TEST(Advise, WritesWhatTheSceneDoesNotSayYet) {
  const Folder folder;
  folder.write("bare.yaml",
               "format: withy/1\n# a comment\nintegrator:\n  name: dopri5\n  rtol: 1e-9   # tight\ntime: {end: 1}\n"
               "gravity: [0, -9.81, 0]\nbodies:\n  rod:\n    type: beam\n    length: 1\n    mass_per_length: 1\n"
               "    bending_y:\n      stiffness: 20\n      modes: 3\nhinges:\n"
               "  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}\n");
  const Finished f = advise(folder, {"--write", "new.yaml", "--accuracy", "10%", "--json"}, {"advise", "bare.yaml"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json advice = json::parse(f.out).at("advice");
  const json run = json::parse(withy(folder, {"run", "new.yaml", "--json", "--estimate", "never"}).out);
  EXPECT_EQ(run.at("evaluations"), advice.at("evaluations")) << folder.read("new.yaml");
  EXPECT_THAT(folder.read("new.yaml"), HasSubstr("# a comment"));
  EXPECT_THAT(folder.read("new.yaml"), Not(HasSubstr("1e-9")));
}

const char* const turned_boom =
    "format: withy/1\ntime: {end: 2}\nbodies:\n  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}\n"
    "  boom: {type: beam, length: 1, mass_per_length: 0.2, bending_y: {stiffness: 10, modes: 2}}\nhinges:\n"
    "  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n"
    "  root: {type: weld, parent: hub, child: boom}\nloads:\n";

TEST(Advise, SampledControllersActInItsProbesAsInARun) {
  const Folder folder;
  folder.write("sampled.yaml", std::string(turned_boom) +
                                   "  control: {type: pd-controller, law: constant, sample: 0.05, hinges: {axle: {to: "
                                   "0.5, stiffness: 2, damping: 0.5}}}\n");
  const Finished f = advise(folder, {"--write", "new.yaml", "--modes", "1,2", "--json"}, {"advise", "sampled.yaml"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json advice = json::parse(f.out).at("advice");
  const json run = json::parse(withy(folder, {"run", "new.yaml", "--json", "--estimate", "never"}).out);
  EXPECT_EQ(run.at("evaluations"), advice.at("evaluations"));
  EXPECT_GT(run.at("final").at("hinges").at("axle").at("position").at(0).get<double>(), 0.1) << "it was turned";
}

TEST(Advise, LoadsThatSwitchByTheStateAreRefusedPlainly) {
  const Folder folder;
  folder.write("relay.yaml", std::string(turned_boom) +
                                 "  jets: {type: hinge-relay, hinge: axle, effort: 0.5, on: 0.03, off: 0.01, "
                                 "rate_time: 1}\n");
  const Finished f = advise(folder, {}, {"advise", "relay.yaml"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, testing::AllOf(HasSubstr("relay.yaml: load 'jets' switches at zeros of a function of the state"),
                                    HasSubstr("'withy trade' and 'withy compare' take it")));
  folder.write("latch.yaml",
               std::string(turned_boom) + "events: {stop: {hinge: axle, value: 0.05, do: {lock: axle}}}\n");
  const Finished latched = advise(folder, {}, {"advise", "latch.yaml"});
  EXPECT_EQ(latched.status, 2);
  EXPECT_THAT(latched.err, HasSubstr("latch.yaml: event 'stop' acts, at times of its own in every model"));
}

TEST(Advise, WhereMotionsThatBeginAlikePartItSaysForHowLongTheyDoNot) {
  const Folder folder;
  const std::vector<std::string> chain = {"advise", "scenes/rigid-chain.yaml", "--accuracy", "1%"};
  const Finished whole = advise(folder, {}, chain);
  EXPECT_EQ(whole.status, 1);
  EXPECT_THAT(whole.err, HasSubstr("the other has a digit of tolerance less) differ by"));
  const std::string before = "(--set ", after = ", up to which they agree)";
  const std::size_t from = whole.err.find(before), to = whole.err.find(after);
  ASSERT_TRUE(from != std::string::npos && to != std::string::npos) << whole.err;
  // At the very end of it the tolerances of candidates are not enough: errors grow by a digit in half a second.
  const std::string said = whole.err.substr(from + before.size(), to - from - before.size());
  ASSERT_EQ(said.rfind("time.end=", 0), 0U) << said;
  const std::string shorter = "time.end=" + json(0.75 * std::stod(said.substr(9))).dump();
  const Finished part = advise(folder, {"--set", shorter, "--json"}, chain);
  ASSERT_EQ(part.status, 0) << shorter << part.err;
  // What is advised, against runs of another kind and as tight as they go.
  const auto ends = [&](const std::vector<std::string>& settings) {
    std::vector<std::string> words = {
        "run", "scenes/rigid-chain.yaml", "--set", shorter, "--estimate", "never", "--json", "--out", "run", "--force"};
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    return json::parse(withy(folder, words).out).at("final").at("hinges");
  };
  const json advice = json::parse(part.out);
  const json advised = ends(advice.at("advice").at("overrides")),
             truth = ends({"integrator={name: dopri5, rtol: 1e-12, atol: 1e-12}"});
  for (const auto& [hinge, range] : advice.at("reference").at("ranges").items()) {
    if (!truth.contains(hinge)) continue;
    EXPECT_NEAR(advised.at(hinge).at("position").at(0).get<double>(),
                truth.at(hinge).at("position").at(0).get<double>(), 0.01 * range.get<double>())
        << hinge;
  }
}

TEST(Advise, WritingAndSettingDoNotGoTogether) {
  const Folder folder;
  EXPECT_EQ(advise(folder, {"--modes", "1", "--accuracy", "20%", "--write", "x.yaml"}).status, 2);
  EXPECT_EQ(folder.read("x.yaml"), "");
}

}  // namespace
}  // namespace withy::test
