/// \file
/// Faults that people make at a keyboard: each is told with its place, its cause, and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

/// A scene of a hub and a boom; faults change one thing in it.
constexpr const char* sound_scene = R"(format: withy/1
time: {end: 1, output: 0.1}
bodies:
  hub: {type: rigid, mass: 20, inertia: [1, 1, 1, 0, 0, 0], frames: {out: {position: [0.1, 0, 0]}}}
  boom:
    type: beam
    length: 8
    mass_per_length: 1.3
    bending_y: {stiffness: 112, modes: 2}
hinges:
  shoulder: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.out, child: boom}
loads:
  motor: {type: hinge-effort, hinge: shoulder, law: constant, value: 2}
)";

struct Fault {
  const char* kind;
  const char *from, *to;               ///< in the scene, s.yaml; empty: it is sound
  std::vector<std::string> arguments;  ///< of withy
  int status;
  std::vector<std::string> said;  ///< on standard error or, where the status is 0, on standard output
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.kind; }

const std::vector<std::string> check_scene = {"check", "s.yaml"};

const Fault faults[] = {
    // What is written.
    {"comma_missing", "[0, 0, 1], parent", "[0, 0, 1] parent", check_scene, 2, {"s.yaml:11:46", "is a ',' missing"}},
    {"colon_missing",
     "    length: 8",
     "    length 8",
     check_scene,
     2,
     {"s.yaml:8:20", "does the line before lack its own"}},
    {"no_end", "end: 1, ", "", check_scene, 0, {"it has no end, and for a run wants time.end"}},
    {"tab", "    length: 8", "\tlength: 8", check_scene, 2, {"s.yaml:7:1", "indent with spaces, not tabs"}},
    {"body_twice", "  boom:\n", "  hub:\n", check_scene, 2, {"s.yaml:5:3", "duplicate key 'hub'", "4:3 already"}},
    {"key_misspelt", "    length: 8", "    lenght: 8", check_scene, 2, {"s.yaml:7:5", "did you mean 'length'?"}},
    {"decimal_comma", ": 1.3", ": 1,3", check_scene, 2, {"s.yaml:8:22", "behind a point, not a comma"}},
    {"quoted_number", "mass: 20", "mass: \"20\"", check_scene, 2, {"s.yaml:4:28", "write it without quotes"}},
    {"format_missing", "format: withy/1\n", "", check_scene, 2, {"s.yaml:1:1: /format", "withy/1"}},
    // Numbers and units.
    {"mass_negative", "mass: 20", "mass: -20", check_scene, 2, {"s.yaml:4:28", "got -20; need finite >= 0 [kg]"}},
    {"unit_wrong", "length: 8", "length: 8 kg", check_scene, 2, {"s.yaml:7:13", "'kg' is a wrong unit here", "[m]"}},
    {"unit_unknown", "length: 8", "length: 8 mmm", check_scene, 2, {"s.yaml:7:13", "did you mean 'mm'?"}},
    {"inertia_impossible",
     "[1, 1, 1, 0, 0, 0]",
     "[1, 1, 5, 0, 0, 0]",
     check_scene,
     2,
     {"s.yaml:4:41", "above the sum of the"}},
    {"inertia_of_three", "[1, 1, 1, 0, 0, 0]", "[1, 1, 1]", check_scene, 2, {"s.yaml:4:41", "need a list of 6"}},
    {"rates_of_one_hinge",
     "loads:",
     "initial: {hinges: {shoulder: {rate: [10 rpm, 0]}}}\nloads:",
     check_scene,
     2,
     {"s.yaml:13:37", "got a list of 2", "need one finite number"}},
    {"table_backwards",
     "law: constant, value: 2",
     "law: table, table: [[0, 1], [2, 0], [1, 3]]",
     check_scene,
     2,
     {"s.yaml:14:85", "got 1 after 2; the first column must increase"}},
    {"step_of_nothing",
     "loads:",
     "integrator: {name: rk4, step: 1e-15}\nloads:",
     check_scene,
     2,
     {"s.yaml:13:31: /integrator/step", "makes 1e+15 steps in a run; need at most 1e+09"}},
    {"greatest_step_of_nothing",
     "loads:",
     "integrator: {name: dopri5, max_step: 1e-300}\nloads:",
     check_scene,
     2,
     {"s.yaml:13:38: /integrator/max_step", "need at most 1e+09"}},
    {"damping_beyond_all",
     "    length: 8",
     "    damping_ratio: 1.7e308\n    length: 8",
     check_scene,
     2,
     {"s.yaml:7:20: /bodies/boom/damping_ratio", "<= 1000000"}},
    {"name_that_acts_on_terminals",
     "format: withy/1\n",
     "format: withy/1\nname: \"a\\eb\"\n",
     check_scene,
     2,
     {"s.yaml:2:7: /name", "got \"a?b\", with control characters"}},
    {"event_in_a_wrong_unit",
     "loads:",
     "events: {e: {signal: shoulder.rate, value: 2 m/s^2}}\nloads:",
     check_scene,
     2,
     {"s.yaml:13:44: /events/e/value", "'m/s^2' is a wrong unit here; need finite [rad/s]"}},
    {"event_in_its_unit",
     "loads:",
     "events: {e: {signal: shoulder.rate, value: 20 rpm}}\nloads:",
     check_scene,
     0,
     {"s.yaml is valid"}},
    {"setting_misspelt",
     "loads:",
     "events: {boost: {at: 0.5, do: {set: loads.motor.valu=5}}}\nloads:",
     check_scene,
     2,
     {"s.yaml:13:37: /events/boost/do/set: of /loads/motor/valu: unknown key", "did you mean 'value'?"}},
    {"setting_that_does_not_fit",
     "loads:",
     "events:\n  turn: {at: 0.5, do: {set: [loads.motor.law=sine, loads.motor.amplitude=2]}}\nloads:",
     check_scene,
     2,
     {"s.yaml:14:30: /events/turn/do/set: of /loads/motor"}},
    // What hangs where.
    {"parent_missing", "parent: hub.out, ", "", check_scene, 2, {"s.yaml:12:3", "world, a body, or body.frame"}},
    {"parent_misspelt", "hub.out", "hubb.out", check_scene, 2, {"s.yaml:12:30", "did you mean 'hub'?"}},
    {"ring_of_hinges",
     "parent: world",
     "parent: boom.tip",
     check_scene,
     2,
     {"s.yaml:11:3", "shoulder, root make a ring", "let one of their parents be world"}},
    {"hung_on_itself",
     "parent: hub.out",
     "parent: boom.tip",
     check_scene,
     2,
     {"s.yaml:12:3", "root hangs a body on itself", "another body, or the world"}},
    {"body_loose",
     "  root: {type: weld, parent: hub.out, child: boom}\n",
     "",
     check_scene,
     2,
     {"s.yaml:5:3", "no hinge has this body as its child", "type free for one that floats"}},
    {"hinge_named_as_a_column",
     "  shoulder: {type",
     "  work: {type",
     check_scene,
     2,
     {"s.yaml:11:3: /hinges/work", "that of a column that every table of results has"}},
    {"folder_as_modal_data",
     "    type: beam\n    length: 8\n    mass_per_length: 1.3\n    bending_y: {stiffness: 112, modes: 2}\n",
     "    {type: modal, file: runs}\n",
     check_scene,
     2,
     {"'runs' is a folder, pipe or device; need a file of Standard Input Data"}},
    // Names of what there is.
    {"family_unknown",
     "modes: 2",
     "modes: 2, family: clamped-fre",
     check_scene,
     2,
     {"s.yaml:9:51", "did you mean 'clamped-free'?"}},
    {"law_missing",
     "law: constant, value: 2",
     "table: [[0, 1], [1, 2]]",
     check_scene,
     2,
     {"s.yaml:14:10: /loads/motor", "a 'table' needs a 'law': table"}},
    {"law_of_another_option",
     "law: constant, value",
     "law: sine, value",
     check_scene,
     2,
     {"s.yaml:14:66", "the law 'sine' takes no 'value'; law: constant does"}},
    {"section_of_a_rigid_body",
     "loads:",
     "outputs: {m: {type: section, of: hub, at: 0}}\nloads:",
     check_scene,
     2,
     {"s.yaml:13:11", "'hub' is no beam", "type: reaction"}},
    // Allowed, and hardly meant.
    {"degrees_as_radians",
     "child: hub}",
     "child: hub, offset: {orientation: {axis: [0, 0, 1], angle: 90}}}",
     check_scene,
     0,
     {"s.yaml:11:121", "90 rad is 14.32 turns", R"(write "90 deg")"}},
    {"start_in_degrees",
     "loads:",
     "initial: {hinges: {shoulder: {position: [60]}}}\nloads:",
     check_scene,
     0,
     {"s.yaml:13:42", R"(write "60 deg")"}},
    {"damping_in_percent",
     "    length: 8",
     "    damping_ratio: 5\n    length: 8",
     check_scene,
     0,
     {"s.yaml:6:5", "5 % is 0.05"}},
    {"no_modes", "modes: 2", "modes: 0", check_scene, 0, {"s.yaml:6:5", "bending_y has no modes"}},
    {"frame_unused",
     "[0.1, 0, 0]}",
     "[0.1, 0, 0]}, spare: {}",
     check_scene,
     0,
     {"s.yaml:4:107", "nothing uses the frame"}},
    // The command line, and files.
    {"command_misspelt", "", "", {"chekc", "s.yaml"}, 2, {"\"chekc\" is no command; did you mean 'check'?"}},
    {"option_misspelt",
     "",
     "",
     {"run", "s.yaml", "--formulatoin", "exact"},
     2,
     {"\"--formulatoin\" is no option; did you mean --formulation?", "withy run --help"}},
    {"option_of_nothing",
     "",
     "",
     {"run", "s.yaml", "--rtol", "1e-6"},
     2,
     {"\"--rtol\" is no option; --set PATH=VALUE sets what a scene says", "withy run --help"}},
    {"rate_that_is_no_number",
     "",
     "",
     {"modes", "s.yaml", "--spin", "shoulder=fast"},
     2,
     {"--spin: rate of 'shoulder': got 'fast'; need a number in rad/s, or one with its unit, as '60 rev/min'"}},
    {"output_misspelt",
     "",
     "",
     {"linearize", "s.yaml", "--outputs", "boom.tip.w"},
     2,
     {"--outputs: no 'boom.tip.w'; did you mean 'boom.tip."}},
    {"model_missing", "", "", {"import", "nothing.urdf"}, 2, {"cannot read nothing.urdf: No such file"}},
    {"neither_model_nor_mesh",
     "",
     "",
     {"import", "robot.urd"},
     2,
     {"robot.urd is no model, whose name ends with .urdf, .xml, .mjcf or .dat, and no mesh: there is no "
      "robot.urd.inp"}},
    {"picture_of_another_kind",
     "",
     "",
     {"plot", "runs", "shoulder", "--out", "p.jpg"},
     2,
     {"got the file 'p.jpg' for a picture; need a name that ends in .svg or .png"}},
    {"place_that_is_no_number",
     "",
     "",
     {"plot", "runs", "shoulder", "--over", "nan"},
     2,
     {"--over: got \"nan\"; need a finite number"}},
    {"value_within_a_list",
     "",
     "",
     {"check", "s.yaml", "--set", "bodies.hub.inertia.2=5"},
     2,
     {"--set 'bodies.hub.inertia.2=5': /bodies/hub/inertia: no distribution of mass"}},
    {"value_without_a_path", "", "", {"run", "s.yaml", "--set", "time.end"}, 2, {"need path=value, as time.end=2"}},
    {"value_of_nobody", "", "", {"run", "s.yaml", "--set", "bodies.bom.length=3"}, 2, {"did you mean 'boom'?"}},
    {"formulation_misspelt", "", "", {"run", "s.yaml", "--formulation", "exat"}, 2, {"did you mean 'exact'?"}},
    {"accuracy_of_one", "", "", {"advise", "s.yaml", "--accuracy", "1"}, 2, {"100 % of each", "need 1%, or 100% if"}},
    {"scene_as_a_plan",
     "",
     "",
     {"sweep", "run", "s.yaml"},
     2,
     {"s.yaml is a scene; need a plan of a sweep", "format: withy-sweep/1", "withy run s.yaml"}},
    {"accuracy_in_kilograms", "", "", {"advise", "s.yaml", "--accuracy", "1 kg"}, 2, {"need a share as 1%"}},
    {"file_missing", "", "", {"run", "t.yaml"}, 2, {"cannot read t.yaml (did you mean s.yaml?): No such file"}},
    {"folder_as_a_scene", "", "", {"run", "scenes"}, 2, {"cannot read scenes (it is a folder; name a file in it)"}},
    {"column_misspelt",
     "",
     "",
     {"inverse", "s.yaml", "--motion", "misspelt.csv"},
     2,
     {"misspelt.csv:1:6: no hinge is named 'sholder'; did you mean 'shoulder'?"}},
    {"text_in_a_column",
     "",
     "",
     {"inverse", "s.yaml", "--motion", "text.csv"},
     2,
     {"text.csv:3:5: got \"ten\" in column 2; need a number"}},
    {"time_backwards",
     "",
     "",
     {"inverse", "s.yaml", "--motion", "back.csv"},
     2,
     {"back.csv:4:1: got the time 0.5 s after 1 s; need times that increase"}},
    {"text_in_a_measurement",
     "",
     "",
     {"tune", "s.yaml", "--match", "text.csv", "--parameters", "bodies.hub.mass"},
     2,
     {"text.csv:3:5: got \"ten\"; need a number, or nothing"}},
    {"bound_that_is_no_number",
     "",
     "",
     {"tune", "s.yaml", "--match", "back.csv", "--parameters", "bodies.hub.mass=nan..30"},
     2,
     {"bound \"nan\": need a number"}},
    {"part_without_its_option", "", "", {"sweep", "run", "p.yaml"}, 2, {"--out is missing", "withy sweep run --help"}},
    {"option_of_a_part_misspelt",
     "",
     "",
     {"sweep", "run", "p.yaml", "--out", "o", "--jobz", "2"},
     2,
     {"\"--jobz\" is no option; did you mean --jobs?", "withy sweep run --help"}},
    {"case_below_zero", "", "", {"sweep", "case", "p.yaml", "-1"}, 2, {"got \"-1\"; need a whole number from 0"}},
    {"run_zero", "", "", {"report", "runs", "--reference", "0"}, 2, {"--reference: got \"0\"; need a number > 0"}},
    {"limit_of_nothing", "", "", {"trade", "s.yaml", "--limit", "0%"}, 2, {"--limit: got '0%'; need above 0"}},
    {"standard_with_a_point",
     "",
     "",
     {"fmu", "s.yaml", "--fmi", "2.0"},
     2,
     {"--fmi: got \"2.0\"; need a whole number"}},
    {"option_of_an_empty_variable", "", "", {"run", "s.yaml", "--formulation", ""}, 2, {"--formulation: got an empty"}},
    {"folder_of_an_empty_variable", "", "", {"run", "s.yaml", "--out", ""}, 2, {"--out: got an empty text"}},
    {"integrator_for_other_equations",
     "",
     "",
     {"check", "s.yaml", "--formulation", "inconsistent", "--integrator", "imex"},
     2,
     {"/integrator: integrator 'imex' folds stiffness"}},
    {"integrator_for_other_equations_in_a_run",
     "loads:",
     "integrator: imex\nloads:",
     {"run", "s.yaml", "--formulation", "inconsistent"},
     2,
     {"s.yaml:13:13: /integrator: integrator 'imex' folds stiffness"}},
};

class Faults : public testing::TestWithParam<Fault> {};

TEST_P(Faults, AreToldWithPlaceCauseAndRemedy) {
  const Fault& fault = GetParam();
  const Folder folder;
  std::string scene = sound_scene;
  if (const std::string from = fault.from; !from.empty()) {
    const std::size_t at = scene.find(from);
    if (at == std::string::npos) throw std::logic_error("the sound scene has no '" + from + "'");
    scene.replace(at, from.size(), fault.to);
  }
  folder.write("s.yaml", scene);
  folder.write("runs/results.csv", "t[s],shoulder[rad]\n0,0\n1,0.1\n");
  folder.write("misspelt.csv", "t[s],sholder[deg]\n0,0\n1,10\n");
  folder.write("text.csv", "t[s],shoulder[deg]\n0,0\n0.5,ten\n1,20\n");
  folder.write("back.csv", "t[s],shoulder[deg]\n0,0\n1,10\n0.5,20\n");
  const Finished f = withy(folder, fault.arguments);
  EXPECT_EQ(f.status, fault.status) << f.out << f.err;
  const std::string& told = fault.status == 0 ? f.out : f.err;
  if (fault.status != 0) {
    EXPECT_EQ(f.out, "") << "what is wrong is told on standard error alone";
  }
  for (const std::string& words : fault.said) EXPECT_THAT(told, testing::HasSubstr(words));
}

INSTANTIATE_TEST_SUITE_P(OfPeople, Faults, testing::ValuesIn(faults),
                         [](const auto& fault) { return std::string(fault.param.kind); });

TEST(FaultsOfPeople, TheSoundSceneIsSound) {
  const Folder folder;
  folder.write("s.yaml", sound_scene);
  EXPECT_THAT(withy(folder, {"check", "s.yaml", "--strict"}).out, testing::HasSubstr("nothing is implausible"));
}

/// What `--set` says is not in the file, and is named as itself.
TEST(FaultsOfPeople, RemarksOnWhatIsSetNameIt) {
  const Folder folder;
  folder.write("s.yaml", sound_scene);
  const std::string set = "events.e={hinge: shoulder, value: 90}", origin = "--set '" + set + "'";
  EXPECT_THAT(withy(folder, {"check", "s.yaml", "--set", set}).out,
              testing::StartsWith(origin + ": /events/e/value: an angle of 90 rad"));
  const nlohmann::json remark =
      nlohmann::json::parse(withy(folder, {"check", "s.yaml", "--set", set, "--json"}).out).at("remarks").at(0);
  EXPECT_TRUE(remark.at("line").is_null() && remark.at("column").is_null()) << remark;
  EXPECT_EQ(remark.at("origin"), origin);
}

/// Names that are offered can be asked for: sections are of beams, and behind their @ stands a place.
TEST(FaultsOfPeople, NamesOfOutputsThatAreOfferedAreThere) {
  const Folder folder;
  const auto said = [&](const std::string& name) {
    const Finished f = withy(folder, {"run", "scenes/two-link-slew.yaml", "--output", name});
    EXPECT_EQ(f.status, 2) << f.out;
    return f.err;
  };
  EXPECT_THAT(said("link1.segment"), testing::Not(testing::HasSubstr("hub.section")));
  for (const char* place : {"300mm", "", "tip"})
    EXPECT_THAT(said(std::string("link1.section@") + place),
                testing::HasSubstr("need a number, in m, without its unit, as link1.section@0.3"))
        << place;
}

}  // namespace
}  // namespace withy::test
