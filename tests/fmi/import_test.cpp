/// \file
/// FMUs as controllers of scenes: a loop closed by one is that of the controller of its own kind, it can be gone back
/// in, and what is wrong with an FMU is said with its place.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "withy/bindings/fmi/zip_file.hpp"
#include "withy/host/simulation.hpp"
#include "withy/host/stopped.hpp"
#include "withy/scene/document.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/prepared.hpp"
#include "withy/tests/fmi/importer.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

/// An FMU of tests/fmi/controller.c.
struct ControllerFmu {
  int version = 2;
  bool keeps_states = true;
  std::string platform = {}, attributes = {}, extra = {};

  /// \returns the name of its file, in the folder of the tests
  std::string pack(const std::string& name) const {
    const bool two = version == 2;
    const std::string number = two ? "Real" : "Float64";
    std::string text = two ? R"(<fmiModelDescription fmiVersion="2.0" modelName="c" guid="controller">)"
                           : R"(<fmiModelDescription fmiVersion="3.0" modelName="c" instantiationToken="controller">)";
    text += R"(<CoSimulation modelIdentifier="controller" )" + attributes;
    if (keeps_states)
      text += two ? R"( canGetAndSetFMUstate="true" canSerializeFMUstate="true")"
                  : R"( canGetAndSetFMUState="true" canSerializeFMUState="true")";
    text += R"(/><DefaultExperiment stepSize="0.01"/><ModelVariables>)";
    const char* names[][2] = {{"angle", "input"},  {"torque", "output"},       {"kp", "parameter"},
                              {"ki", "parameter"}, {"reference", "parameter"}, {"fail", "parameter"}};
    int reference = 0;
    for (const auto& [variable, causality] : names) {
      const std::string head = "name=\"" + std::string(variable) + "\" valueReference=\"" +
                               std::to_string(reference++) + "\" causality=\"" + causality + '"';
      text += two ? "<ScalarVariable " + head + "><Real/></ScalarVariable>" : "<Float64 " + head + "/>";
    }
    text += extra + "</ModelVariables></fmiModelDescription>";
    fmi::ZipFile zip(scratch() / name);
    zip.add("modelDescription.xml", text);
    zip.add("binaries/" +
                (!platform.empty() ? platform
                 : two             ? "linux64"
                                   : "x86_64-linux") +
                "/controller.so",
            read_bytes(CONTROLLER_LIBRARY));
    zip.finish();
    return name;
  }
};

/// A turntable with this load.
std::string turned(const std::string& load) {
  return R"(format: withy/1
time: {end: 1, output: 0.01}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
initial: {hinges: {axle: {position: [0.3]}}}
outputs: {turn: {type: gyro, of: table}}
loads:
  law: )" +
         load + '\n';
}

host::Scene scene_of(const std::string& text) {
  return host::Scene::parse(library(), text, (scratch() / "scene.yaml").string());
}

std::string fmu_load(const std::string& file, const std::string& more = {}) {
  return "{type: fmu, file: " + file + ", of: axle, inputs: angle, hinge: axle, set: [kp=4, ki=2, reference=0.1]" +
         more + "}";
}

std::string problem(const std::string& load) {
  try {
    scene_of(turned(load)).check();
  } catch (const SceneError& e) {
    return e.what();
  }
  return {};
}

class ImportedFmu : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Versions, ImportedFmu, testing::Values(2, 3));

TEST_P(ImportedFmu, ClosesTheLoopOfTheControllerOfItsKind) {
  const std::string file = ControllerFmu{.version = GetParam(), .keeps_states = false}.pack("loop.fmu");
  for (const std::string delay : {"", ", delay: 0.01"}) {
    const host::Result own = scene_of(turned("{type: pid, of: axle, hinge: axle, proportional: 4, integral: 2, "
                                             "reference: 0.1, sample: 0.01" +
                                             delay + "}"))
                                 .run();
    // The rate is the one that the FMU proposes, where the scene names none.
    const host::Result foreign =
        scene_of(turned(fmu_load(file, delay.empty() ? std::string() : ", sample: 0.01" + delay))).run();
    ASSERT_EQ(foreign.status, "completed") << foreign.message;
    const auto a = own.column("axle"), b = foreign.column("axle");
    ASSERT_EQ(a.size(), b.size());
    double moved = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_NEAR(a[i], b[i], 1e-12);
      moved = std::max(moved, std::abs(a[i] - a[0]));
    }
    EXPECT_GT(moved, 0.1);
    // A run depends on the file.
    const auto files = scene_of(turned(fmu_load(file))).prepare()->scene.sources.files;
    EXPECT_TRUE(std::any_of(files.begin(), files.end(), [&](const FileUsed& f) { return f.path == file; }));
  }
}

TEST_P(ImportedFmu, GoesBackToASnapshotBitByBit) {
  const std::string file = ControllerFmu{.version = GetParam()}.pack("back.fmu");
  if (GetParam() == 3) {
    // This one says that it keeps states, and lacks the functions for it.
    EXPECT_THAT(problem(fmu_load(file)), HasSubstr("lacks the function fmi3GetFMUState"));
    return;
  }
  const host::Scene scene = scene_of(turned(fmu_load(file)));
  host::Simulation sim(scene), other(scene);
  sim.step(0.355);
  const host::Snapshot before = host::Snapshot::of_numbers(sim.snapshot().numbers());
  sim.step(0.8);
  const double there = sim.output("axle");
  sim.restore(before);
  sim.step(0.8);
  EXPECT_EQ(sim.output("axle"), there);
  other.restore(before);
  other.step(0.8);
  EXPECT_EQ(other.output("axle"), there);
}

TEST(ImportedFmus, ThatKeepTheirStatesToThemselvesAreNotGoneBackIn) {
  const std::string file = ControllerFmu{.keeps_states = false}.pack("secret.fmu");
  host::Simulation sim(scene_of(turned(fmu_load(file))));
  sim.step(0.355);
  const host::Snapshot before = sim.snapshot();
  sim.step(0.8);
  try {
    sim.restore(before);
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_THAT(e.what(),
                HasSubstr("load 'law': FMU 'secret.fmu' (line 9 of the scene) cannot go on from a saved state"));
  }
  sim.step(1);  // it stands where it stood
}

TEST(ImportedFmus, OfWithyCloseALoop) {
  // A wheel with a brake, whose angle goes back as a torque: a first-order lag with an integrator.
  const std::filesystem::path wheel = scratch() / "wheel.yaml";
  std::ofstream(wheel) << R"(format: withy/1
time: {end: 1, output: 0.02}
integrator: {name: dopri5, rtol: 1e-11, atol: 1e-13}
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 0.5, 0, 0, 0]}}
hinges: {spin: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
loads:
  drive: {type: input, hinge: spin}
  brake: {type: hinge-spring, hinge: spin, stiffness: 0, damping: 1.5}
)";
  for (const int version : {2, 3}) {
    const auto prepared = host::Scene::read(library(), wheel.string()).prepare();
    const std::filesystem::path out = scratch() / ("wheel" + std::to_string(version) + ".fmu");
    static_cast<void>(fmi::export_fmu(*prepared, {}, library().registry(), {version, true, true, out}));
    // θ'' = 2 w − 3 θ', θ the command. What the FMU gives after a step is what the system has a sample later.
    const host::Result own =
        scene_of(turned("{type: state-space, A: [[0, 1], [0, -3]], B: [[0], [2]], C: [[1, 0]], of: "
                        "axle, hinge: axle, sample: 0.02}"))
            .run();
    const host::Scene with_fmu =
        scene_of(turned("{type: fmu, file: " + out.filename().string() +
                        ", of: axle, inputs: drive, outputs: spin, hinge: axle, sample: 0.02, delay: 0.02}"));
    const host::Result foreign = with_fmu.run();
    ASSERT_EQ(foreign.status, "completed") << foreign.message;
    EXPECT_NEAR(foreign.column("axle").back(), own.column("axle").back(), 1e-9);
    EXPECT_GT(std::abs(own.column("axle").back() - 0.3), 0.01);
    host::Simulation sim(with_fmu);
    sim.step(0.31);
    const host::Snapshot before = sim.snapshot();
    sim.step(0.7);
    const double there = sim.output("axle");
    sim.restore(before);
    sim.step(0.7);
    EXPECT_EQ(sim.output("axle"), there);
  }
}

TEST(ImportedFmus, ThatFailStopARunWithTheirWords) {
  for (const int version : {2, 3}) {
    const std::string file = ControllerFmu{.version = version, .keeps_states = false}.pack("fails.fmu");
    const host::Scene scene =
        scene_of(turned("{type: fmu, file: " + file + ", of: axle, inputs: angle, to: nothing, set: [fail=0.505]}"));
    const host::Result result = scene.run();
    EXPECT_EQ(result.status, "load-failed");
    EXPECT_THAT(result.message, HasSubstr("load 'law': FMU 'fails.fmu' (line 9 of the scene) at t = 0.51 s: "));
    EXPECT_THAT(result.message, HasSubstr("DoStep gives error: the valve is stuck"));
    EXPECT_EQ(result.column("t").back(), 0.51);  // what is known up to there stays
    host::Simulation sim(scene);
    try {
      sim.step(1);
      ADD_FAILURE() << "it stepped over the failure";
    } catch (const host::SimulationStopped& e) {
      EXPECT_EQ(e.status(), "load-failed");
    }
    EXPECT_THROW(static_cast<void>(scene.linearize()), study::InputError);
  }
}

TEST(ImportedFmus, ThatFailEndARunOfTheProgram) {
  const std::string file = ControllerFmu{.keeps_states = false}.pack("fails.fmu");
  std::ofstream(scratch() / "failing.yaml")
      << turned("{type: fmu, file: " + file + ", of: axle, inputs: angle, to: nothing, set: [fail=0.505]}");
  const std::string folder = (scratch() / "failing").string();
  const int status = std::system((std::string(WITHY_PROGRAM) + " run '" + (scratch() / "failing.yaml").string() +
                                  "' --out '" + folder + "' > '" + folder + ".log' 2>&1")
                                     .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const auto run = nlohmann::json::parse(std::ifstream(folder + "/run.json"));
  EXPECT_EQ(run.at("status"), "load-failed");
  EXPECT_EQ(run.at("t_end"), 0.51);
  EXPECT_THAT(run.at("message").get<std::string>(),
              HasSubstr("load 'law': FMU 'fails.fmu' (line 9 of the scene) at t = 0.51 s: fmi2DoStep gives error: the "
                        "valve is stuck"));
}

TEST(ImportedFmus, AreRefusedWithThePlaceAndTheReason) {
  const std::string good = ControllerFmu{}.pack("good.fmu");
  const auto of = [](const ControllerFmu& fmu) { return fmu_load(fmu.pack("bad.fmu")); };
  EXPECT_THAT(problem(fmu_load("none.fmu")),
              HasSubstr("scene.yaml:9:26: /loads/law/file: got 'none.fmu'; there is no"));
  std::ofstream(scratch() / "text.fmu") << "no archive";
  EXPECT_THAT(problem(fmu_load("text.fmu")), HasSubstr("is no archive"));
  EXPECT_THAT(problem(of({.platform = "win64"})), HasSubstr("no library for this platform, binaries/linux64/"));
  EXPECT_THAT(problem(of({.platform = "win64"})), HasSubstr("it is for: win64"));
  EXPECT_THAT(problem(of({.attributes = "needsExecutionTool=\"true\""})), HasSubstr("needs the tool that made it"));
  EXPECT_THAT(problem(of({.extra = "<broken"})), HasSubstr("modelDescription.xml:1:"));
  EXPECT_THAT(problem(of({.extra = "<ScalarVariable name='x' valueReference='z'/>"})), HasSubstr("no value reference"));
  EXPECT_THAT(problem("{type: fmu, file: good.fmu, of: axle, inputs: angel, hinge: axle}"),
              HasSubstr("/loads/law/inputs: got 'angel'; the FMU has no such variable, did you mean 'angle'?"));
  EXPECT_THAT(problem("{type: fmu, file: good.fmu, of: axle, inputs: kp, hinge: axle}"),
              HasSubstr("it is no input of the FMU but parameter"));
  EXPECT_THAT(problem("{type: fmu, file: good.fmu, of: [axle, turn.z], inputs: angle, hinge: axle}"),
              HasSubstr("got 1 names; need 2"));
  EXPECT_THAT(problem("{type: fmu, file: good.fmu, of: axle, hinge: axle}"), HasSubstr("got 'axle'; the FMU has no"));
  EXPECT_THAT(problem("{type: fmu, file: good.fmu, of: axle, inputs: angle, outputs: [torque, torque], hinge: axle}"),
              HasSubstr("got 2 outputs; need 1"));
  EXPECT_THAT(problem("{type: fmu, file: good.fmu, of: axle, inputs: angle, hinge: axle, set: [kp]}"),
              HasSubstr("need name=number"));
  EXPECT_THAT(problem("{type: fmu, file: good.fmu, of: axle, inputs: angle, hinge: axle, set: [kq=1]}"),
              HasSubstr("did you mean 'kp'?"));
  ControllerFmu array{.version = 3, .keeps_states = false};
  array.extra = R"(<Float64 name="many" valueReference="9" causality="input"><Dimension start="3"/></Float64>)";
  array.pack("array.fmu");
  EXPECT_THAT(problem("{type: fmu, file: array.fmu, of: axle, inputs: many, hinge: axle}"), HasSubstr("an array"));
}

}  // namespace
}  // namespace withy::test
