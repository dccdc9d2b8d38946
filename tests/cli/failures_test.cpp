#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(Failures, ASceneThatIsNotThereIsBadInput) {
  const Folder folder;
  const Finished f = withy(folder, {"run", "nowhere.yaml"});
  EXPECT_EQ(f.status, 2);
  EXPECT_EQ(f.out, "");
  EXPECT_THAT(f.err, HasSubstr("nowhere.yaml"));
}

TEST(Failures, ABadSceneIsReportedWithEveryPlaceAndLeavesNoResults) {
  const Folder folder;
  folder.write("bad.yaml", "format: withy/1\nbodies:\n  a: {type: rigid, mass: -1}\n  b: {type: rigid, maas: 1}\n");
  const Finished f = withy(folder, {"run", "bad.yaml", "--out", "out"});
  EXPECT_EQ(f.status, 2);
  EXPECT_EQ(f.out, "");
  EXPECT_THAT(f.err, HasSubstr("bad.yaml:3:"));
  EXPECT_THAT(f.err, HasSubstr("bad.yaml:4:"));
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

// A tip of 1e9 times the beam's mass: κ·2⁻⁵² is 0.4.
TEST(Failures, AnAccuracyThatCannotBeHadIsRefusedAndWhatCanIsRun) {
  const Folder folder;
  const std::string scene =
      "format: withy/1\ntime: {end: 0.01}\nintegrator: {name: dopri5, rtol: 1e-6}\nbodies:\n"
      "  arm: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 1, modes: 10}}\n"
      "  load: {type: rigid, mass: 1e9}\nhinges:\n"
      "  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}\n"
      "  tip: {type: weld, parent: arm.tip, child: load}\n";
  folder.write("heavy.yaml", scene);
  const Finished refused = withy(folder, {"run", "heavy.yaml", "--out", "out"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("heavy.yaml:3:34: /integrator/rtol: got 1e-06, an accuracy that cannot be had"));
  EXPECT_THAT(refused.err, HasSubstr("modes of 'arm'"));
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
  EXPECT_EQ(withy(folder, {"run", "heavy.yaml", "--set", "integrator.rtol=0.9", "--out", "out"}).status, 0);
  const Finished inspected = withy(folder, {"inspect", "heavy.yaml"});
  EXPECT_THAT(inspected.out, HasSubstr("nearly massless: "));
  EXPECT_THAT(inspected.out, HasSubstr("without arm.bending_y[10] the condition is"));
}

TEST(Failures, APluginThatEndsTheProgramIsNamed) {
  const Folder folder;
  folder.write("s.yaml",
               "format: withy/1\ntime: {end: 1}\nbodies:\n  a: {type: rigid, mass: 1}\nhinges:\n"
               "  h: {type: prismatic, axis: [1, 0, 0], parent: world, child: a}\nloads:\n"
               "  l: {type: zoo-sudden-end, way: out of order}\n");
  const std::string plugin = std::string("the plugin ") + WITHY_SUDDEN_END + "/zoo-sudden-end.so has ";
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "s.yaml", "--out", "out", "--plugins", WITHY_SUDDEN_END});
    return withy(folder, std::move(more));
  };
  const Finished thrown = run({});
  EXPECT_EQ(thrown.status, 3);
  EXPECT_THAT(thrown.err, HasSubstr(plugin + "let an exception ('out of order') out of code that must not"));
  const Finished left = run({"--set", "loads.l.way=exit"});
  EXPECT_EQ(left.status, 3);
  EXPECT_THAT(left.err, HasSubstr(plugin + "ended the program by a call of exit()"));
}

TEST(Failures, NoCommandReplacesWhatItReadsNorAFileThatNobodyNamed) {
  const Folder folder;
  const std::string scene = folder.read("scenes/pendulum.yaml");
  folder.write("s.yaml", scene);
  folder.write("state.json", "{}\n");
  fs::create_symlink("s.yaml", folder.path() / "link.yaml");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"export", "s.yaml", "--out", "s.yaml"},
        {"export", "s.yaml", "--out", "link.yaml"},
        {"export", "link.yaml", "--out", "./s.yaml", "--force"},
        {"fmu", "s.yaml", "--out", "link.yaml"},
        {"equilibrium", "s.yaml", "--out", "s.yaml"},
        {"equilibrium", "s.yaml", "--at", "state.json", "--out", "state.json"},
        {"advise", "s.yaml", "--accuracy", "5%", "--write", "link.yaml"}}) {
    const Finished f = withy(folder, command);
    EXPECT_EQ(f.status, 2) << command[0];
    EXPECT_THAT(f.err, HasSubstr("read by this command and is not replaced; name another file")) << command[0];
    EXPECT_EQ(folder.read("s.yaml"), scene);
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link.yaml"));
  }
  EXPECT_EQ(folder.read("state.json"), "{}\n");
  folder.write("s.urdf", "mine");
  folder.write("s.fmu", "mine");
  for (const std::string command : {"export", "fmu"}) {
    const std::string file = command == "fmu" ? "s.fmu" : "s.urdf";
    const Finished f = withy(folder, {command, "s.yaml"});
    EXPECT_EQ(f.status, 2);
    EXPECT_THAT(f.err, HasSubstr(file + " is there already: name another file, or add --force to replace it"));
    EXPECT_EQ(folder.read(file), "mine");
    EXPECT_EQ(withy(folder, {command, "s.yaml", "--force"}).status, 0);
    EXPECT_NE(folder.read(file), "mine");
    EXPECT_EQ(withy(folder, {command, "s.yaml", "--out", file}).status, 0);
  }
  // What was imported is not lost to the way back.
  fs::copy_file(folder.path() / "scenes/models/double-pendulum.urdf", folder.path() / "double-pendulum.urdf");
  const std::string original = folder.read("double-pendulum.urdf");
  EXPECT_EQ(withy(folder, {"import", "double-pendulum.urdf"}).status, 0);
  EXPECT_EQ(withy(folder, {"export", "double-pendulum.yaml"}).status, 2);
  EXPECT_EQ(withy(folder, {"import", "double-pendulum.urdf", "--out", "double-pendulum.urdf", "--force"}).status, 2);
  EXPECT_EQ(folder.read("double-pendulum.urdf"), original);
  // Beside a name that was given a surface that import has written is made anew, and no other file.
  const std::vector<std::string> mesh = {
      "import", "scenes/meshes/cantilever", "--root", "ROOT", "--station", "85", "--modes", "1", "--out", "b.SID_FEM"};
  folder.write("b.vtk", "mine");
  const Finished foreign = withy(folder, mesh);
  EXPECT_EQ(foreign.status, 2);
  EXPECT_THAT(foreign.err, HasSubstr("b.vtk is there already"));
  EXPECT_EQ(folder.read("b.vtk"), "mine");
  EXPECT_FALSE(fs::exists(folder.path() / "b.SID_FEM"));
  fs::remove(folder.path() / "b.vtk");
  EXPECT_EQ(withy(folder, mesh).status, 0);
  EXPECT_EQ(withy(folder, mesh).status, 0);
  // A folder is said to be one, and a pipe is written.
  const Finished into = withy(folder, {"export", "s.yaml", "--out", "scenes"});
  EXPECT_EQ(into.status, 2);
  EXPECT_THAT(into.err, HasSubstr("scenes is a folder; need the name of a file to write"));
  EXPECT_FALSE(fs::exists(folder.path() / "scenes.part"));
  EXPECT_THAT(withy(folder, {"export", "s.yaml", "--out", "/dev/stdout"}).out, HasSubstr("<robot"));
}

TEST(Failures, OutputsOfAnFmuThatNobodyKnowsAreNamedWithTheNearest) {
  const Folder folder;
  const Finished f =
      withy(folder, {"fmu", "scenes/commanded-arm.yaml", "--output", "shoulder.efort", "--out", "q.fmu"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("did you mean 'shoulder.effort'?"));
  EXPECT_FALSE(fs::exists(folder.path() / "q.fmu"));
}

// What run refuses check refuses, with the place.
TEST(Failures, AStartThatNoRunCanBeginWithIsBadInputToCheckToo) {
  const Folder folder;
  const auto told = [&](const std::string& rod, const std::string& more) {
    folder.write("s.yaml", "format: withy/1\ntime: {end: 1, output: 0.1}\nbodies:\n  rod: {type: rigid, " + rod +
                               "}\nhinges:\n  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}\n" +
                               more);
    const Finished checked = withy(folder, {"check", "s.yaml"});
    const Finished run = withy(folder, {"run", "s.yaml", "--out", "out"});
    EXPECT_EQ(checked.status, 2);
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(checked.err, run.err);
    return checked.err;
  };
  const std::string sound = "mass: 1.2, center_of_mass: [0, -0.5, 0], inertia: [0.1, 0, 0.1, 0, 0, 0]";
  const std::string massless = told("mass: 0", "");
  EXPECT_THAT(massless, HasSubstr("s.yaml:6:10: /hinges/pivot: the mass matrix is singular: pivot.0 moves no mass"));
  EXPECT_THAT(massless, testing::Not(HasSubstr("rtol")));
  EXPECT_THAT(told(sound, "integrator: {name: dopri5, rtol: 1e-300}\n"),
              HasSubstr("s.yaml:7:34: /integrator/rtol: got 1e-300, an accuracy that cannot be had"));
  EXPECT_THAT(told("mass: 1, center_of_mass: [0, 1e300, 0]", ""),
              HasSubstr("/hinges/pivot: the inertia that pivot.0 moves is beyond the range of numbers"));
}

TEST(Failures, ALeastStepThatIsTooGreatIsNamed) {
  const Folder folder;
  const Finished f = withy(folder, {"run", "scenes/pendulum.yaml", "--set", "integrator.min_step=0.5", "--out", "out"});
  EXPECT_EQ(f.status, 1);
  EXPECT_THAT(f.err, HasSubstr("make min_step smaller: it is 0.5 s"));
}

TEST(Failures, AFullDiskIsAnErrorWhereverItIsMet) {
  const Folder folder;
  fs::create_directory(folder.path() / "out");
  fs::create_symlink("/dev/full", folder.path() / "out/checkpoint.cbor.part");
  const Finished checkpoint = withy(folder, {"run", "scenes/pendulum.yaml", "--checkpoint", "1e-9", "--out", "out"});
  EXPECT_EQ(checkpoint.status, 3);
  EXPECT_THAT(checkpoint.err, HasSubstr("checkpoint.cbor.part: No space left on device"));
  EXPECT_FALSE(fs::exists(folder.path() / "out/run.json"));

  fs::create_directory(folder.path() / "out2");
  fs::create_symlink("/dev/full", folder.path() / "out2/run.json.part");
  const Finished summary = withy(folder, {"run", "scenes/pendulum.yaml", "--out", "out2"});
  EXPECT_EQ(summary.status, 3);
  EXPECT_THAT(summary.err, HasSubstr("run.json.part: No space left on device"));

  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"schema"}, {"inspect", "scenes/pendulum.yaml"}, {"--help"}}) {
    std::vector<std::string> arguments = {WITHY_PROGRAM};
    arguments.insert(arguments.end(), command.begin(), command.end());
    const Finished f = Process(folder, arguments, "/dev/full").wait();
    EXPECT_EQ(f.status, 3) << command[0];
    EXPECT_THAT(f.err, HasSubstr("standard output: No space left on device"));
  }
}

TEST(Failures, AFolderThatCannotBeMadeIsTheEnvironments) {
  const Folder folder;
  folder.write("file", "");
  const Finished f = withy(folder, {"run", "scenes/pendulum.yaml", "--out", "file/out"});
  EXPECT_EQ(f.status, 3);
  EXPECT_THAT(f.err, HasSubstr("the folder file/out for results cannot be made: file is a file; give one"));
  const Finished nowhere = withy(folder, {"run", "scenes/pendulum.yaml", "--out", "/proc/x"});
  EXPECT_EQ(nowhere.status, 3);
  EXPECT_THAT(nowhere.err, HasSubstr("the folder /proc/x for results cannot be made: No such file or directory; give"));
}

TEST(Failures, APluginThatIsRefusedIsTheEnvironmentsAndIsListed) {
  const Folder folder;
  folder.write("plugins/broken.plugin",
               "[withy-plugin]\nlibrary = broken.so\nentry = withy_plugin_broken\nprovides = formulation/broken\n"
               "version = 1\n");
  folder.write("plugins/broken.so", "this is no library");
  const Finished run =
      withy(folder, {"run", "scenes/pendulum.yaml", "--plugins", "plugins", "--formulation", "broken"});
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("broken.so"));
  const Finished list = withy(folder, {"plugins", "--plugins", "plugins"});
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.out, HasSubstr("refused:\nformulation/broken: "));
  const Finished schema = withy(folder, {"schema", "--plugins", "plugins"});
  EXPECT_EQ(schema.status, 0);
  EXPECT_EQ(schema.out, withy(folder, {"schema"}).out) << "that of the others";
  EXPECT_THAT(schema.err, AllOf(HasSubstr("left out: "), HasSubstr("broken.so")));
}

TEST(Failures, AnUnknownPluginIsBadInputAndTheNearestIsNamed) {
  const Folder folder;
  const Finished f = withy(folder, {"run", "scenes/pendulum.yaml", "--formulation", "quadratc"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("quadratic"));
  EXPECT_EQ(withy(folder, {"plugins", "quadratc"}).status, 2);
}

TEST(Failures, APluginFolderThatIsNotThereIsBadInput) {
  const Folder folder;
  const Finished f = withy(folder, {"plugins", "--plugins", "nowhere"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("nowhere"));
}

// 2^53 samples to the end: the number of one and of the next are the same.
TEST(Failures, SamplesThatCannotBeToldApartAreBadInputAtReading) {
  const Folder folder;
  folder.write("fast.yaml",
               "format: withy/1\ntime: {end: 2}\nbodies: {table: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
               "hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}\n"
               "loads:\n  servo: {type: pid, hinge: axle, proportional: 1, sample: 1e-16}\n");
  for (const char* command : {"check", "run"}) {
    const Finished f = withy(folder, {command, "fast.yaml"});
    EXPECT_EQ(f.status, 2) << command;
    EXPECT_EQ(f.out, "");
    EXPECT_THAT(f.err, HasSubstr("fast.yaml:6:60: /loads/servo/sample: got a period of 1e-16 s"));
    EXPECT_THAT(f.err, HasSubstr("2e+16 samples in a run, with a step at each; need at most 1e+09"));
  }
  EXPECT_EQ(withy(folder, {"check", "fast.yaml", "--set", "loads.servo.sample=2e-9"}).status, 0);
  const Finished late = withy(folder, {"check", "fast.yaml", "--set", "loads.servo.sample=1e-9", "--set",
                                       "initial.time=1e8", "--set", "time.end=1e8"});
  EXPECT_EQ(late.status, 2);
  EXPECT_THAT(late.err, HasSubstr("at t = 1e+08 s; need more than 1.11e-08 s"));
}

}  // namespace
}  // namespace withy::test
