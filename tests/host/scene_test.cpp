// Scenes in a program.
#include <gmock/gmock.h>
#include <unistd.h>

#include <cfenv>
#include <clocale>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "withy/core/simulation/simulate.hpp"
#include "withy/host/equations.hpp"
#include "withy/host/simulation.hpp"
#include "withy/host/stopped.hpp"
#include "withy/tests/host/arm.hpp"

namespace withy {
namespace {

using host::Scene;
using nlohmann::json;
using test::library;
using testing::HasSubstr;

Scene slew() { return Scene::read(library(), WITHY_SOURCES "/scenes/two-link-slew.yaml"); }

TEST(HostedScene, is_varied_as_a_value) {
  const Scene original = slew();
  Scene fast = original;
  fast.set("loads.slew.time_scale", 1.2).set("integrator.rtol", "1e-5").formulation("ruthless");
  const host::Result slow = original.run(), quick = fast.run();
  EXPECT_EQ(quick.status, "completed");
  EXPECT_LT(quick.column("t").back(), slow.column("t").back());
  EXPECT_EQ(json::parse(quick.json)["formulation"], "ruthless");
  EXPECT_EQ(json::parse(slow.json)["final"]["hinges"]["shoulder"]["position"][0].get<double>(),
            slow.column("shoulder").back());
  // What text and changes say is the same scene.
  Scene again = Scene::parse(library(), fast.text(), fast.name());
  for (const std::string& change : fast.changes())
    again.set(change.substr(0, change.find('=')), std::string_view(change).substr(change.find('=') + 1));
  EXPECT_EQ(again.run().values, quick.values);
}

TEST(HostedScene, says_what_it_is_as_a_scene_again) {
  Scene arm = Scene(slew()).set("time.end", 0.2).set("bodies.link1.length", "950 mm").formulation("linear");
  const Scene again = Scene::parse(library(), arm.values());
  EXPECT_EQ(again.run().values, arm.run().values);
  arm.set("bodies.lnk1.length", 1);
  EXPECT_THAT([&] { static_cast<void>(arm.values()); },
              testing::ThrowsMessage<SceneError>(HasSubstr("did you mean 'link1'")));
}

/// A hub that floats, with arms of links.
Scene with_arms(int links) {
  std::string bodies =
                  "  hub: {type: rigid, mass: 4, inertia: [1, 2, 3, 0, 0, 0], frames: {left: {position: [-1, 0, 0]}, "
                  "right: {position: [1, 0, 0]}}}\n",
              hinges = "  base: {type: free, parent: world, child: hub}\n";
  for (const std::string arm : {"left", "right"}) {
    for (int i = 0; i < links; ++i) {
      const std::string name = arm + std::to_string(i);
      bodies += "  " + name + ": {type: beam, length: 0.5, mass_per_length: 1, bending_y: {stiffness: 90}}\n";
      hinges += "  h_" + name + ": {type: revolute, axis: [0, 0, 1], child: " + name +
                ", parent: " + (i == 0 ? "hub." + arm : arm + std::to_string(i - 1) + ".tip") + "}\n";
    }
  }
  return Scene::parse(library(), "format: withy/1\ntime: {end: 0.05}\nbodies:\n" + bodies + "hinges:\n" + hinges +
                                     "loads:\n  push: {type: hinge-effort, hinge: h_left0, value: 0.1}\n");
}

TEST(HostedScene, has_the_same_results_on_any_number_of_threads) {
  const host::Result one = with_arms(6).run();
  ASSERT_EQ(one.status, "completed");
  for (const std::size_t threads : {1, 2, 3}) {
    const host::Result several = with_arms(6).threads(threads).run();
    EXPECT_EQ(several.values, one.values) << threads;
    EXPECT_EQ(json::parse(several.json)["peaks"], json::parse(one.json)["peaks"]) << threads;
  }
  EXPECT_THROW(with_arms(6).threads(0), std::runtime_error);
}

TEST(HostedScene, has_the_linear_model_of_its_equations) {
  const Scene arm = Scene::read(library(), WITHY_SOURCES "/scenes/commanded-arm.yaml");
  const json linear = json::parse(arm.linearize({}, {"shoulder"}));
  host::Equations equations(arm, "");
  std::vector<double> jacobian(equations.size() * equations.size());
  equations.jacobian(0, equations.y0(), jacobian);
  ASSERT_EQ(linear["A"].size(), equations.size());
  for (std::size_t i = 0; i < equations.size(); ++i)
    for (std::size_t j = 0; j < equations.size(); ++j)
      EXPECT_NEAR(linear["A"][i][j].get<double>(), jacobian[i * equations.size() + j],
                  1e-9 * (1 + std::abs(jacobian[i * equations.size() + j])));
  EXPECT_EQ(linear["inputs"], json({"command"}));
  EXPECT_EQ(linear["C"].size(), 2U);  // the angle and its rate
  EXPECT_THROW(static_cast<void>(arm.linearize({"comand"})), std::runtime_error);
}

/// A bead on a spoke of a turntable, held by a spring: k/m is 25.
Scene bead() {
  return Scene::parse(library(), R"(format: withy/1
bodies:
  table: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  bead: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}
  slide: {type: prismatic, axis: [1, 0, 0], parent: table, child: bead}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 50}}
)");
}

TEST(HostedScene, is_looked_at_where_it_turns) {
  const host::Place turning{{}, {"axle=3"}};
  const json modes = json::parse(bead().modes({}, {}, {.place = turning}));
  EXPECT_NEAR(modes["points"][0]["modes"][0]["frequency"], 4, 1e-9);
  EXPECT_TRUE(modes.contains("against_next"));
  const json linear = json::parse(bead().linearize({"slide"}, {"slide"}, {}, turning));
  EXPECT_NEAR(linear["A"][1][0], -16, 1e-9);
  EXPECT_NEAR(json::parse(bead().response({"slide", "slide", {}, {}, 100, {}}, {}, turning))["static_gain"], 1 / 32.0,
              1e-9);
  // The state of an equilibrium is a place for others; so is the text of any.
  const json steady = json::parse(bead().equilibrium({}, turning));
  EXPECT_TRUE(steady["converged"]);
  const host::Place there{{"steady", steady["state"].dump()}, {}};
  EXPECT_NEAR(json::parse(bead().linearize({"slide"}, {"slide"}, {"axle"}, there))["A"][1][0], -16, 1e-9);
  EXPECT_THAT(
      [] {
        static_cast<void>(bead().equilibrium({}, {{"steady", "{hinges: {axel: {rate: [3]}}}"}, {}}));
      },
      testing::ThrowsMessage<SceneError>(HasSubstr("steady:1:11: /hinges/axel")));
  EXPECT_THAT(
      [] {
        static_cast<void>(bead().response({"axle", "slide", {}, {}, 100, {}}));
      },
      testing::ThrowsMessage<std::runtime_error>(HasSubstr("does not feel")));
}

TEST(HostedScene, tells_what_its_motions_take) {
  Scene scene = bead().set("time.end", 1).set("time.output", 0.1);
  EXPECT_THROW(static_cast<void>(scene.inverse()), std::runtime_error) << "nothing is driven";
  scene.set("hinges.axle", "{type: weld, parent: world, child: table}");
  std::string table = "t,slide\n";
  for (int i = 0; i <= 10; ++i) table += std::to_string(0.1 * i) + ',' + std::to_string(0.001 * i * i * i) + '\n';
  const host::Inverse found = scene.inverse({"cubic", table});
  EXPECT_EQ(json::parse(found.json)["status"], "completed");
  EXPECT_EQ(found.run.status, "completed");
  ASSERT_EQ(found.drives.size(), 1U);
  const host::Inverse::Drive& drive = found.drives[0];
  EXPECT_EQ(drive.effort_on.name, "slide.0");
  EXPECT_EQ(drive.effort_on.unit, "N");
  ASSERT_EQ(drive.effort.size(), found.times.size());
  for (std::size_t i = 0; i < found.times.size(); ++i) {
    const double t = found.times[i];
    EXPECT_NEAR(drive.effort[i], 2 * 6 * t + 50 * t * t * t, 1e-7) << t;
  }
}

TEST(HostedScene, reports_every_problem_with_its_place) {
  Scene scene = Scene::parse(library(), "format: withy/1\nbodies: {b: {type: rigd}}\nhinges: {}\n", "mine.yaml");
  scene.set("time.end", "soon");
  try {
    scene.check();
    FAIL();
  } catch (const SceneError& e) {
    EXPECT_THAT(e.what(), HasSubstr("mine.yaml:2:"));
    EXPECT_THAT(e.what(), HasSubstr("did you mean 'rigid'"));
    EXPECT_THAT(e.what(), HasSubstr("set(time.end=soon)"));
  }
  EXPECT_THROW(static_cast<void>(Scene::parse(library(), "a: [")), SceneError);
  EXPECT_THROW(static_cast<void>(Scene::read(library(), "no-such-file.yaml")), std::system_error);
  EXPECT_THROW(static_cast<void>(slew().formulation("quadratc").run()), std::runtime_error);
  EXPECT_THROW(static_cast<void>(slew().run().column("shouldr")), std::out_of_range);
}

TEST(HostedScene, that_no_run_can_begin_with_is_refused_by_its_check_with_the_place) {
  Scene strict = slew().set("integrator", "{name: imex, rtol: 1e-4}").formulation("consistent");
  const auto refused = testing::ThrowsMessage<SceneError>(
      testing::AllOf(HasSubstr("set(integrator="), HasSubstr("/integrator"), HasSubstr("symmetric mass matrix")));
  EXPECT_THAT([&] { strict.check(); }, refused);
  EXPECT_THAT([&] { static_cast<void>(strict.run()); }, refused);
  EXPECT_THAT([&] { host::Simulation simulation(strict); }, refused);
  EXPECT_THAT([&] { static_cast<void>(strict.compare({"consistent"}, "consistent")); },
              testing::ThrowsMessage<SceneError>(HasSubstr("symmetric mass matrix")));
  strict.formulation("quadratic").check();
  const Scene massless = Scene::parse(library(),
                                      "format: withy/1\ntime: {end: 1}\n"
                                      "bodies: {bar: {type: rigid, mass: 1, inertia: [0, 0, 0, 0, 0, 0]}}\n"
                                      "hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: bar}}\n",
                                      "mine.yaml");
  EXPECT_THAT([&] { massless.check(); },
              testing::ThrowsMessage<SceneError>(HasSubstr("mine.yaml:4:17: /hinges/pivot: the mass matrix is")));
}

TEST(HostedScene, is_compared_in_the_formulations_that_its_integrator_can_treat) {
  Scene scene = slew().set("integrator", "{name: imex, rtol: 1e-4}").set("time.end", 0.02);
  const json compared = json::parse(scene.compare({}, "quadratic"));
  std::vector<std::string> run, left;
  for (const json& one : compared["runs"]) run.push_back(one["formulation"]);
  for (const json& one : compared["left_out"]) {
    left.push_back(one["formulation"]);
    EXPECT_THAT(one["reason"].get<std::string>(), HasSubstr("symmetric mass matrix"));
  }
  EXPECT_EQ(run, (std::vector<std::string>{"ruthless", "quadratic"}));
  EXPECT_EQ(left, (std::vector<std::string>{"inconsistent", "consistent"}));
}

/// A load whose root is of a negative number gives no effort: nothing of the masses, which are sound.
TEST(HostedScene, of_which_something_is_not_finite_is_told_so_by_linear_analyses) {
  const Scene scene = Scene::parse(library(), R"(format: withy/1
bodies: {bar: {type: rigid, mass: 1, center_of_mass: [0.3, 0, 0], inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: bar}}
loads: {n: {type: expression, hinge: h, value: sqrt(h - 5)}, s: {type: hinge-spring, hinge: h, stiffness: 3}}
)");
  try {
    static_cast<void>(scene.linearize());
    FAIL();
  } catch (const host::SimulationStopped& e) {
    EXPECT_EQ(e.status(), "diverged");
    EXPECT_THAT(e.what(), HasSubstr("load 'n' gives nan on h.0"));
  }
  const json point = json::parse(scene.modes())["points"][0];
  EXPECT_THAT(point["problem"].get<std::string>(), HasSubstr("no steady state was found: load 'n' gives nan on h.0"));
}

/// Two folders with files of the same name: a triangle, and what is none.
class InFolders : public testing::Test {
 protected:
  InFolders() {
    for (const char* name : {"own", "other"}) std::filesystem::create_directories(folder_ / name);
    std::ofstream(folder_ / "own" / "shape.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::ofstream(folder_ / "other" / "shape.obj") << "f 1 2 3\n";
    std::ofstream(folder_ / "own" / "scene.yaml")
        << "format: withy/1\ntime: {end: 0.1}\n"
           "bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], visual: {mesh: shape.obj}}}\n"
           "hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}\n";
  }
  ~InFolders() override {
    std::filesystem::current_path(began_);
    std::filesystem::remove_all(folder_);
  }
  std::filesystem::path began_ = std::filesystem::current_path();
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("withy-folders-" + std::to_string(::getpid()));
};

TEST_F(InFolders, a_scene_keeps_its_own_wherever_the_process_goes) {
  std::filesystem::current_path(folder_ / "own");
  const Scene scene = Scene::read(library(), "scene.yaml");
  std::filesystem::current_path(folder_ / "other");
  scene.check();
  Scene(scene).set("time.end", 0.05).check();
  Scene::parse(library(), scene.text(), scene.name(), scene.folder()).check();
  // What is read here is of this folder.
  EXPECT_THROW(Scene::parse(library(), scene.text(), scene.name()).check(), SceneError);
  EXPECT_EQ(scene.name(), "scene.yaml");
}

TEST(HostedScene, is_interrupted_and_tells_its_progress) {
  double seen = 0;
  host::Follow follow;
  follow.progress = [&](double done, double all) { seen = std::max(seen, done / all); };
  follow.interrupted = [&] { return seen > 0.3; };
  const host::Result part = slew().run(follow);
  EXPECT_EQ(part.status, "interrupted");
  EXPECT_GT(part.rows(), 2U);
  EXPECT_LT(part.column("t").back(), 3.8);
}

TEST(HostedScene, is_studied) {
  const Scene scene = Scene(slew()).set("time.end", 0.3);
  const json compared = json::parse(scene.compare({"ruthless", "linear"}, "quadratic"));
  ASSERT_EQ(compared["runs"].size(), 3U);
  EXPECT_GT(compared["runs"][0]["distance"]["hinges"]["shoulder"], 0);
  const json modes = json::parse(scene.modes({"shoulder", "elbow"}));
  EXPECT_GT(modes["points"][0]["modes"][0]["hertz"], 0);
  Scene::Axes axes{{"ruthless", "quadratic"}, {}, {1}, {"dopri5"}, {1e-4}};
  const json trade = json::parse(scene.trade(axes, 1));
  EXPECT_EQ(trade["points"].size(), 2U);
  const json advice = json::parse(scene.advise("10%", {}, axes));
  EXPECT_TRUE(advice["advice"].is_object()) << advice.dump();
  EXPECT_FALSE(advice.contains("until"));
  const json ended = json::parse(
      Scene(scene).set("events.done", "{hinge: shoulder, value: 0.008, stop: true}").advise("10%", {}, axes));
  EXPECT_THAT(ended["until"].get<std::string>(), testing::HasSubstr("event 'done' ends the run at 0.1"));
}

// The values of inputs go over from one formulation to the next.
TEST(HostedScene, with_inputs_runs_in_the_formulation_that_is_needed) {
  Scene arm = Scene::read(library(), WITHY_SOURCES "/scenes/commanded-arm.yaml");
  arm.set("initial", "{inputs: {command: 2}}").set("time.end", 1.5);
  const host::Result quadratic = arm.run();
  const host::Result automatic = arm.set("formulation", "{name: auto, accuracy: 0.01%}").run();
  ASSERT_EQ(automatic.status, "completed") << automatic.message;
  EXPECT_GT(json::parse(automatic.json)["certificate"]["stretches"]["list"].size(), 1U);
  EXPECT_NEAR(automatic.column("shoulder").back(), quadratic.column("shoulder").back(), 0.01);
}

/// What of a process is everybody's.
struct Process {
  std::string locale = std::setlocale(LC_ALL, nullptr);
  std::filesystem::path folder = std::filesystem::current_path();
  int rounding = std::fegetround(), traps = ::fegetexcept();
  std::vector<void (*)(int)> handlers;
  std::vector<int> blocked;
  Process() {
    sigset_t mask;
    ::pthread_sigmask(SIG_BLOCK, nullptr, &mask);
    for (int signal = 1; signal < NSIG; ++signal) {
      struct sigaction action {};
      ::sigaction(signal, nullptr, &action);
      handlers.push_back(action.sa_handler);
      blocked.push_back(::sigismember(&mask, signal));
    }
  }
  bool operator==(const Process&) const = default;
};

TEST(HostedScene, leaves_the_process_as_it_is_and_prints_nothing) {
  const auto handler = std::signal(SIGINT, SIG_IGN);  // the host's own choice, which is to stay
  const Process before;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  {
    const host::Library own;
    Scene arm = Scene(Scene::read(own, WITHY_SOURCES "/scenes/commanded-arm.yaml")).set("time.end", 0.1);
    static_cast<void>(arm.run());
    static_cast<void>(arm.compare({"ruthless", "linear"}, "quadratic"));
    static_cast<void>(arm.linearize());
    host::Simulation simulation(arm);
    simulation.step(0.1);
    EXPECT_THROW(simulation.step(0.05), std::invalid_argument);
    EXPECT_THROW(Scene::parse(own, "bodies: {a: {type: rgid}}").check(), SceneError);
    Scene failing = slew();
    EXPECT_NE(failing.set("loads.slew.time_scale", 1.2).formulation("consistent").run().status, "completed");
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(Process() == before);
  std::signal(SIGINT, handler);
}

TEST(HostedScene, hears_the_remarks_of_the_library) {
  std::vector<std::string> remarks;
  const host::Library own({{"no/such/folder"}, [&](std::string_view remark) { remarks.emplace_back(remark); }});
  EXPECT_THAT(remarks, testing::Contains(HasSubstr("no/such/folder")));
}

}  // namespace
}  // namespace withy
