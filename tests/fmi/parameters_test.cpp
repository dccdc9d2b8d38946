/// \file
/// Parameters that importers tune between steps and at events act from then on.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "withy/host/simulation.hpp"
#include "withy/tests/fmi/importer.hpp"

namespace withy::test {
namespace {

/// A swinging arm with a spring, as an FMU.
const Unpacked& sprung(int version) {
  const std::filesystem::path file = scratch() / "sprung.yaml";
  std::ofstream(file) << R"(format: withy/1
time: {end: 1, output: 0.05}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
gravity: [0, -9.8, 0]
bodies: {boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 30, modes: 1}}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
initial: {hinges: {axle: {position: [0.4]}}}
loads:
  spring: {type: hinge-spring, hinge: axle, stiffness: 3, damping: 0.1}
  servo: {type: pid, hinge: axle, proportional: 2, integral: 3}
  held: {type: pid, hinge: axle, proportional: 1, sample: 0.1}
  drive: {type: input, hinge: axle}
)";
  return exported(file.string(), version);
}

/// From t = 0.3 on what was tuned there is what an FMU does that has had these parameters from its start, at this
/// state.
TEST(FmuParameters, AreTunedBetweenSteps) {
  const std::vector<std::pair<std::string, double>> tuned{{"loads.spring.stiffness", 40},
                                                          {"loads.servo.proportional", 9}};
  const auto run = [&](const Unpacked& fmu, auto& early, auto& late, auto step) {
    step(early, 0.0, 0.3);
    const double drive = 0.7;
    early.set(fmu.reference("drive"), drive);
    for (const auto& [name, value] : tuned) {
      EXPECT_EQ(static_cast<int>(early.set(fmu.reference(name), value)), 0) << early.heard.last;
      EXPECT_EQ(static_cast<int>(late.set(fmu.reference(name), value)), 0) << late.heard.last;
    }
    for (const std::uint32_t state : fmu.states) late.set(state, early.get(state));
    late.set(fmu.reference("drive"), drive);
    // What is wrong is refused, and leaves everything as it is.
    EXPECT_EQ(static_cast<int>(early.set(fmu.reference("loads.spring.stiffness"), -1)), 3);
    EXPECT_THAT(early.heard.last, testing::HasSubstr("/loads/spring/stiffness"));
    EXPECT_EQ(early.get(fmu.reference("loads.spring.stiffness")), 40);
    EXPECT_EQ(static_cast<int>(early.set(fmu.reference("bodies.boom.length"), 2)), 3);
    EXPECT_EQ(static_cast<int>(early.set(fmu.reference("loads.held.sample"), 0.2)), 3);
  };
  {
    const Unpacked& fmu = sprung(2);
    Instance2 early(fmu, fmi2CoSimulation), late(fmu, fmi2CoSimulation), other(fmu, fmi2CoSimulation);
    const auto step = [](Instance2& i, double from, double length) {
      EXPECT_EQ(i.fmi.DoStep(i.c, from, length, fmi2True), fmi2OK) << i.heard.last;
    };
    early.initialize();
    other.initialize();
    run(fmu, early, late, step);
    late.initialize(0.3);
    fmi2FMUstate state = nullptr;
    ASSERT_EQ(early.fmi.GetFMUstate(early.c, &state), fmi2OK) << early.heard.last;
    step(early, 0.3, 0.5);
    step(late, 0.3, 0.5);
    step(other, 0.0, 0.8);
    const double there = early.get(fmu.reference("axle"));
    EXPECT_NEAR(there, late.get(fmu.reference("axle")), 1e-8);
    EXPECT_GT(std::abs(there - other.get(fmu.reference("axle"))), 0.01);
    ASSERT_EQ(early.fmi.SetReal(early.c, std::vector{fmu.reference("loads.spring.stiffness")}.data(), 1,
                                std::vector{1.0}.data()),
              fmi2OK);
    ASSERT_EQ(early.fmi.SetFMUstate(early.c, state), fmi2OK) << early.heard.last;
    EXPECT_EQ(early.get(fmu.reference("loads.spring.stiffness")), 40);
    step(early, 0.3, 0.5);
    EXPECT_EQ(early.get(fmu.reference("axle")), there);  // bit by bit, with the parameters of then
    early.fmi.FreeFMUstate(early.c, &state);
  }
  const Unpacked& fmu = sprung(3);
  Instance3 early(fmu, true), late(fmu, true);
  const auto step = [](Instance3& i, double from, double length) {
    bool event = false, terminate = false, stopped = false;
    double last = 0;
    EXPECT_EQ(i.fmi.DoStep(i.c, from, length, true, &event, &terminate, &stopped, &last), fmi3OK) << i.heard.last;
  };
  early.initialize();
  run(fmu, early, late, step);
  EXPECT_EQ(late.fmi.EnterInitializationMode(late.c, false, 0, 0.3, false, 0), fmi3OK) << late.heard.last;
  EXPECT_EQ(late.fmi.ExitInitializationMode(late.c), fmi3OK) << late.heard.last;
  step(early, 0.3, 0.5);
  step(late, 0.3, 0.5);
  EXPECT_NEAR(early.get(fmu.reference("axle")), late.get(fmu.reference("axle")), 1e-8);
}

TEST(FmuParameters, AreTunedAtEventsOfModelExchange) {
  const Unpacked& fmu = sprung(2);
  Instance2 i(fmu, fmi2ModelExchange);
  i.initialize();
  const std::uint32_t stiffness = fmu.reference("loads.spring.stiffness"), rate = fmu.reference("der(axle.rate)");
  for (const Described& v : fmu.variables)
    if (v.reference == stiffness) {
      EXPECT_EQ(v.attributes.at("variability"), "tunable");
      EXPECT_EQ(v.attributes.at("start"), "3");
      EXPECT_EQ(v.attributes.at("unit"), "N m/rad");
    }
  const double before = i.get(rate), angle = i.get(fmu.reference("axle"));
  ASSERT_EQ(i.set(stiffness, 5), fmi2OK) << i.heard.last;
  const double softened = i.get(rate);
  ASSERT_EQ(i.set(stiffness, 7), fmi2OK) << i.heard.last;
  EXPECT_LT(softened, before);
  EXPECT_NEAR(i.get(rate) - softened, softened - before, 1e-9);  // accelerations are affine in it
  EXPECT_EQ(i.get(fmu.reference("axle")), angle);
  fmi2EventInfo info{};
  ASSERT_EQ(i.fmi.NewDiscreteStates(i.c, &info), fmi2OK);
  ASSERT_EQ(i.fmi.EnterContinuousTimeMode(i.c), fmi2OK);
  EXPECT_EQ(i.set(stiffness, 3), fmi2Error);  // not between events
  EXPECT_THAT(i.heard.last, testing::HasSubstr("is a tunable parameter"));
}

/// A controller whose filter begins elsewhere than at what it measures kicks: with other start values, or at another
/// time, an FMU begins as the scene does that says the same.
TEST(FmuParameters, StartValuesAndTimesBeginTheStatesOfLoads) {
  const std::string file = SCENES "/manipulator-pid.yaml";
  for (const int version : {2, 3}) {
    const Unpacked& fmu = exported(file, version);
    const auto check = [&](auto& i, double start, const std::function<void(double)>& initialize) {
      i.set(fmu.reference("shoulder"), 0.65);
      i.set(fmu.reference("hold_wrist.integral"), 0.01);
      initialize(start);
      host::Scene scene = host::Scene::read(library(), file);
      scene.set("initial.time", start).set("initial.hinges.shoulder.position", "[0.65]");
      scene.set("initial.loads", "{hold_wrist: {integral: 0.01}}");
      const host::Simulation simulation(scene);
      for (const host::Port& port : simulation.outputs()) {
        if (port.name == "work") continue;
        EXPECT_EQ(i.get(fmu.reference(port.name)), simulation.output(port.name)) << port.name << " at " << start;
      }
      EXPECT_EQ(i.get(fmu.reference("hold_wrist.integral")), 0.01);
    };
    for (const double start : {0.0, 0.4}) {
      if (version == 2) {
        Instance2 i(fmu, fmi2CoSimulation);
        check(i, start, [&](double t) { i.initialize(t); });
      } else {
        Instance3 i(fmu, true);
        check(i, start, [&](double t) {
          EXPECT_EQ(i.fmi.EnterInitializationMode(i.c, false, 0, t, false, 0), fmi3OK) << i.heard.last;
          EXPECT_EQ(i.fmi.ExitInitializationMode(i.c), fmi3OK) << i.heard.last;
        });
      }
    }
  }
}

/// A loop is closed around the start values that a host sets, as around those of a scene.
TEST(FmuParameters, StartValuesCloseLoops) {
  const std::string file = SCENES "/gallery/four-bar.yaml";
  host::Scene scene = host::Scene::read(library(), file);
  const std::filesystem::path out = scratch() / "four-bar.fmu";
  static_cast<void>(fmi::export_fmu(*scene.prepare(), {}, library().registry(), {3, false, true, out}));
  const Unpacked fmu = unpack(out, 3);
  Instance3 i(fmu, true);
  i.set(fmu.reference("motor"), 1.2);
  i.set(fmu.reference("motor.rate"), 5);
  i.initialize();
  EXPECT_EQ(i.get(fmu.reference("motor")), 1.2);
  EXPECT_EQ(i.get(fmu.reference("motor.rate")), 5);
  const double pivot = i.get(fmu.reference("pivot"));
  EXPECT_NEAR(i.get(fmu.reference("coupler.tip.x")), 0.9 + 0.8 * std::cos(pivot), 1e-12);
  EXPECT_NEAR(i.get(fmu.reference("coupler.tip.y")), 0.8 * std::sin(pivot), 1e-12);
  // Where every hinge is set, no way is left.
  Instance3 torn(fmu, true);
  for (const char* hinge : {"motor", "elbow", "pivot"}) torn.set(fmu.reference(hinge), 0);
  EXPECT_EQ(torn.fmi.EnterInitializationMode(torn.c, false, 0, 0, false, 0), fmi3OK);
  EXPECT_EQ(torn.fmi.ExitInitializationMode(torn.c), fmi3Error);
  EXPECT_THAT(torn.heard.last, testing::HasSubstr("constraint 'loop'"));
}

/// A start value that is set changes nothing of what the scene gives, and what it closes is seen at once.
TEST(FmuParameters, StartValuesLeaveWhatTheSceneGivesInClosedLoops) {
  const std::string file = SCENES "/gallery/four-bar.yaml";
  const std::filesystem::path out = scratch() / "four-bar-2.fmu";
  host::Scene scene = host::Scene::read(library(), file);
  static_cast<void>(fmi::export_fmu(*scene.prepare(), {}, library().registry(), {3, false, true, out}));
  const Unpacked fmu = unpack(out, 3);
  for (const char* state : {"elbow", "motor.rate"})
    EXPECT_EQ(fmu.variables.at(fmu.reference(state)).attributes.at("initial"), "approx") << state;
  const double motor = 1.8708;
  const State said = scene.set("initial.hinges.motor.position.0", motor).prepare()->scene.initial;
  const auto expect_begun = [&](Instance3& i) {
    EXPECT_EQ(i.get(fmu.reference("motor")), motor);
    EXPECT_EQ(i.get(fmu.reference("motor.rate")), 6);
    for (std::size_t s = 0; s < fmu.states.size(); ++s) EXPECT_NEAR(i.get(fmu.states[s]), said.y[s], 1e-9) << s;
    const double pivot = i.get(fmu.reference("pivot"));
    EXPECT_NEAR(i.get(fmu.reference("coupler.tip.x")), 0.9 + 0.8 * std::cos(pivot), 1e-12);
  };
  Instance3 i(fmu, true);
  EXPECT_EQ(i.fmi.EnterInitializationMode(i.c, false, 0, 0, false, 0), fmi3OK);
  i.set(fmu.reference("motor"), 1.2);
  EXPECT_NE(i.get(fmu.reference("elbow")), 0);  // closed, and not what the next closing goes from
  i.set(fmu.reference("motor"), motor);
  expect_begun(i);
  EXPECT_EQ(i.fmi.ExitInitializationMode(i.c), fmi3OK) << i.heard.last;
  expect_begun(i);
  // Where the scene's own position leaves no way it yields to what is set; its rate stays.
  Instance3 by_elbow(fmu, true);
  by_elbow.set(fmu.reference("elbow"), -1.3);
  by_elbow.initialize();
  EXPECT_EQ(by_elbow.get(fmu.reference("elbow")), -1.3);
  EXPECT_GT(by_elbow.get(fmu.reference("motor")), 1.6);
  EXPECT_EQ(by_elbow.get(fmu.reference("motor.rate")), 6);
  // What cannot be closed cannot be read.
  Instance3 torn(fmu, true);
  for (const char* hinge : {"motor", "elbow", "pivot"}) torn.set(fmu.reference(hinge), 0);
  EXPECT_EQ(torn.fmi.EnterInitializationMode(torn.c, false, 0, 0, false, 0), fmi3OK);
  double value = 0;
  const std::uint32_t elbow = fmu.reference("elbow");
  EXPECT_EQ(torn.fmi.GetFloat64(torn.c, &elbow, 1, &value, 1), fmi3Discard);
}

/// Motions that are elsewhere at another start time open loops, which are closed there.
TEST(FmuParameters, LoopsAreClosedAtTheStartTimeOfTheHost) {
  host::Scene scene = host::Scene::read(library(), SCENES "/gallery/four-bar.yaml");
  scene.set("initial", "{guess: {hinges: {elbow: {position: [60 deg]}, pivot: {position: [80 deg]}}}}");
  scene.set("loads.torque", "null");
  scene.set("motions", "{drive: {type: spin-up, hinge: motor, rate: 6 rad/s, duration: 1}}");
  const std::filesystem::path out = scratch() / "driven-four-bar.fmu";
  static_cast<void>(fmi::export_fmu(*scene.prepare(), {}, library().registry(), {3, false, true, out}));
  const Unpacked fmu = unpack(out, 3);
  Instance3 i(fmu, true);
  EXPECT_EQ(i.fmi.EnterInitializationMode(i.c, false, 0, 0.5, false, 0), fmi3OK) << i.heard.last;
  EXPECT_EQ(i.fmi.ExitInitializationMode(i.c), fmi3OK) << i.heard.last;
  EXPECT_GT(i.get(fmu.reference("motor.rate")), 1);
  const double pivot = i.get(fmu.reference("pivot"));
  EXPECT_NEAR(i.get(fmu.reference("coupler.tip.x")), 0.9 + 0.8 * std::cos(pivot), 1e-12);
  EXPECT_NEAR(i.get(fmu.reference("coupler.tip.y")), 0.8 * std::sin(pivot), 1e-12);
}

/// Hosts write back every start value before they say when they start: a motion then is where it is at that time.
TEST(FmuParameters, StartValuesOfDrivenHingesHoldNoMotionBack) {
  const Unpacked& fmu = exported(SCENES "/spin-up.yaml", 3);
  Instance3 plain(fmu, true), told(fmu, true);
  for (const char* name : {"axle", "axle.rate"})
    EXPECT_EQ(told.set(fmu.reference(name), std::stod(fmu.variables.at(fmu.reference(name)).attributes.at("start"))),
              fmi3OK);
  for (const Instance3* i : {&plain, &told}) {
    EXPECT_EQ(i->fmi.EnterInitializationMode(i->c, false, 0, 2, false, 0), fmi3OK) << i->heard.last;
    EXPECT_EQ(i->fmi.ExitInitializationMode(i->c), fmi3OK) << i->heard.last;
  }
  EXPECT_GT(plain.get(fmu.reference("axle")), 0.01);
  for (const char* name : {"axle", "axle.rate"})
    EXPECT_EQ(told.get(fmu.reference(name)), plain.get(fmu.reference(name))) << name;
}

/// Numbers of vectors that the file has not, or has in another form, are parameters as others are.
TEST(FmuParameters, AreElementsOfVectorsThatTheFileLeavesOut) {
  const std::filesystem::path file = scratch() / "plain.yaml";
  std::ofstream(file) << R"(format: withy/1
time: {end: 1, output: 0.05}
bodies: {rod: {type: rigid, mass: 2, inertia: [0.1, 0.1, 0.1, 0, 0, 0], frames: {tip: {position: [1, 0, 0]}}}}
hinges:
  axle:
    {type: revolute, axis: [0, 0, 1], parent: world, child: rod, offset: {orientation: {axis: [0, 0, 1], angle: 0}}}
)";
  const Unpacked& fmu = exported(file.string(), 3);
  Instance3 i(fmu, true);
  const auto set = [&](const std::string& name, double value) {
    EXPECT_EQ(i.set(fmu.reference(name), value), fmi3OK) << i.heard.last;
  };
  set("gravity.1", -10);
  set("bodies.rod.center_of_mass.0", 0.5);
  set("hinges.axle.offset.position.2", 3);
  set("hinges.axle.offset.orientation.0", 0.6);  // a quaternion about z: cos ψ = 0.36 − 0.64, sin ψ = 0.96
  set("hinges.axle.offset.orientation.3", 0.8);
  i.initialize();
  EXPECT_NEAR(i.get(fmu.reference("rod.tip.x")), -0.28, 1e-15);
  EXPECT_NEAR(i.get(fmu.reference("rod.tip.y")), 0.96, 1e-15);
  EXPECT_EQ(i.get(fmu.reference("rod.tip.z")), 3);
  // −m g l cos ψ over the inertia about the hinge, 0.1 + 2 · 0.25.
  EXPECT_NEAR(i.get(fmu.reference("der(axle.rate)")), 2 * 10 * 0.5 * 0.28 / 0.6, 1e-13);
}

}  // namespace
}  // namespace withy::test
