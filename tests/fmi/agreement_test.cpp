/// \file
/// What an FMU computes in co-simulation is what the scene computes: parameters, motions, rollback, early return.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "withy/host/simulation.hpp"
#include "withy/study/input_error.hpp"
#include "withy/tests/fmi/same_as_run.hpp"

namespace withy::test {

TEST(Agreement, CoSimulationGivesTheTableOfARunInBothVersions) {
  for (const std::string& file : {commanded, jets}) {
    host::Scene scene = host::Scene::read(library(), file);
    scene.set("time.end", 2).set("time.output", 0.25);
    const host::Result run = scene.run();
    ASSERT_EQ(run.rows(), 9U);
    Instance2 two(exported(file, 2), fmi2CoSimulation);
    Instance3 three(exported(file, 3), true);
    two.initialize();
    three.initialize();
    for (std::size_t k = 1; k < run.rows(); ++k) {
      const double t = 0.25 * static_cast<double>(k - 1);
      ASSERT_EQ(two.fmi.DoStep(two.c, t, 0.25, fmi2True), fmi2OK) << two.heard.last;
      bool event = true, terminate = true, early = true;
      double last = 0;
      ASSERT_EQ(three.fmi.DoStep(three.c, t, 0.25, true, &event, &terminate, &early, &last), fmi3OK);
      EXPECT_FALSE(event || terminate || early);
      EXPECT_EQ(last, t + 0.25);
      // A run does not land on its outputs: both are as exact as the integrator, rtol 1e-6 and 1e-7.
      expect_same(
          exported(file, 2), [&](auto vr) { return two.get(vr); }, run, k, 2e-5);
      for (const std::uint32_t vr : exported(file, 3).of("output")) EXPECT_EQ(three.get(vr), two.get(vr));
    }
  }
}

TEST(Agreement, ParametersStartValuesInputsAndToleranceActAsInTheScene) {
  const Unpacked& fmu = exported(commanded, 3);
  Instance3 instance(fmu, true);
  EXPECT_EQ(instance.set(fmu.reference("bodies.link1.length"), 0.8), fmi3OK);
  EXPECT_EQ(instance.set(fmu.reference("loads.brake.stiffness"), 6), fmi3OK);
  EXPECT_EQ(instance.set(fmu.reference("shoulder"), 0.2), fmi3OK);
  EXPECT_EQ(instance.fmi.EnterInitializationMode(instance.c, true, 1e-9, 0, false, 0), fmi3OK);
  EXPECT_EQ(instance.set(fmu.reference("command"), 1.5), fmi3OK);
  EXPECT_EQ(instance.fmi.ExitInitializationMode(instance.c), fmi3OK);
  host::Scene scene = host::Scene::read(library(), commanded);
  scene.set("bodies.link1.length", 0.8).set("loads.brake.stiffness", 6).set("integrator.rtol", 1e-9);
  scene.set("initial", "{hinges: {shoulder: {position: [0.2]}}, inputs: {command: 1.5}}");
  host::Simulation simulation(scene);
  for (int k = 1; k <= 20; ++k) {
    const double t = 0.05 * (k - 1);
    bool event = false, terminate = false, early = false;
    double last = 0;
    ASSERT_EQ(instance.fmi.DoStep(instance.c, t, 0.05, true, &event, &terminate, &early, &last), fmi3OK)
        << instance.heard.last;
    simulation.step(t + 0.05);
    if (k == 10) {
      EXPECT_EQ(instance.set(fmu.reference("command"), -1), fmi3OK);
      simulation.set_input("command", -1);
    }
  }
  for (const host::Port& output : simulation.outputs()) {
    if (output.name == "work") continue;
    EXPECT_EQ(instance.get(fmu.reference(output.name)), simulation.output(output.name)) << output.name;
  }
}

/// A position of a hinge that the host sets is an input by the motion's name, the same to the last bit as in a hosted
/// simulation, also where it is set before initialization ends. Model exchange cannot reach positions, and says so.
TEST(Agreement, MotionsOfHostsAreInputsOfCoSimulation) {
  const host::Scene scene = host::Scene::parse(library(), R"(format: withy/1
time: {end: 1}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 30, modes: 2}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
motions: {turn: {type: input, hinge: axle}}
initial: {hinges: {axle: {position: [0.3]}}}
)");
  const auto out = [](const char* name) { return scratch() / name; };
  const auto prepared = scene.prepare();
  const auto packed = [&](bool model_exchange) {
    const fmi::Export what{2, model_exchange, true, out("moved.fmu")};
    static_cast<void>(fmi::export_fmu(*prepared, {}, library().registry(), what));
  };
  EXPECT_THROW(packed(true), study::InputError);
  packed(false);
  const Unpacked fmu = unpack(out("moved.fmu"), 2);
  Instance2 instance(fmu, fmi2CoSimulation);
  host::Simulation simulation(scene);
  const std::uint32_t turn = fmu.reference("turn");
  EXPECT_EQ(instance.fmi.SetupExperiment(instance.c, fmi2False, 0, 0, fmi2False, 0), fmi2OK);
  EXPECT_EQ(instance.fmi.EnterInitializationMode(instance.c), fmi2OK);
  EXPECT_EQ(instance.get(turn), 0.3);
  for (int k = 1; k <= 20; ++k) {
    const double t = 0.05 * k, q = 0.3 + 0.2 * (1 - std::cos(3 * t));
    if (k < 15) {
      EXPECT_EQ(instance.set(turn, q), fmi2OK) << instance.heard.last;
      simulation.set_input("turn", q);
    }
    if (k == 1) {
      EXPECT_EQ(instance.fmi.ExitInitializationMode(instance.c), fmi2OK) << instance.heard.last;
    }
    ASSERT_EQ(instance.fmi.DoStep(instance.c, 0.05 * (k - 1), t - 0.05 * (k - 1), fmi2True), fmi2OK)
        << instance.heard.last;
    simulation.step(t);
    EXPECT_NEAR(simulation.output("axle"), k < 15 ? q : simulation.output("axle"), 1e-7);
  }
  for (const host::Port& output : simulation.outputs()) {
    if (output.name == "work") continue;
    EXPECT_EQ(instance.get(fmu.reference(output.name)), simulation.output(output.name)) << output.name;
  }
}

TEST(Agreement, RollbackGivesTheSameBitsInTheInstanceAndThroughBytesInAnother) {
  const Unpacked& fmu = exported(busy_arm_file(), 3);
  Instance3 one(fmu, true), other(fmu, true);
  one.initialize();
  const auto steps = [&](Instance3& i, int from, int to) {
    std::vector<double> seen;
    for (int k = from; k < to; ++k) {
      bool event = false, terminate = false, early = false;
      double last = 0;
      EXPECT_EQ(i.set(fmu.reference("torque"), 0.01 * k), fmi3OK);
      EXPECT_EQ(i.set(fmu.reference("ramp"), 0.02 * k), fmi3OK);
      EXPECT_EQ(i.fmi.DoStep(i.c, 0.02 * k, 0.02, false, &event, &terminate, &early, &last), fmi3OK) << i.heard.last;
      for (const std::uint32_t vr : fmu.of("output")) seen.push_back(i.get(vr));
    }
    return seen;
  };
  steps(one, 0, 5);
  fmi3FMUState state = nullptr, copy = nullptr;
  ASSERT_EQ(one.fmi.GetFMUState(one.c, &state), fmi3OK);
  const std::vector<double> first = steps(one, 5, 9);
  ASSERT_EQ(one.fmi.SetFMUState(one.c, state), fmi3OK) << one.heard.last;
  EXPECT_EQ(steps(one, 5, 9), first);
  std::size_t size = 0;
  ASSERT_EQ(one.fmi.SerializedFMUStateSize(one.c, state, &size), fmi3OK);
  std::vector<fmi3Byte> bytes(size);
  ASSERT_EQ(one.fmi.SerializeFMUState(one.c, state, bytes.data(), size), fmi3OK);
  ASSERT_EQ(other.fmi.DeserializeFMUState(other.c, bytes.data(), size, &copy), fmi3OK) << other.heard.last;
  ASSERT_EQ(other.fmi.SetFMUState(other.c, copy), fmi3OK) << other.heard.last;
  EXPECT_EQ(steps(other, 5, 9), first);
  // A byte that is damaged is noticed, a state of another instance refused.
  bytes[size / 2] ^= 1U;
  EXPECT_EQ(other.fmi.DeserializeFMUState(other.c, bytes.data(), size, &copy), fmi3Error);
  EXPECT_EQ(other.fmi.SetFMUState(other.c, state), fmi3Error);
  EXPECT_EQ(one.fmi.FreeFMUState(one.c, &state), fmi3OK);
  EXPECT_EQ(state, nullptr);
}

TEST(Agreement, AStepReturnsEarlyWhereItsIntermediateUpdateAsksForIt) {
  static const Unpacked& fmu = exported(commanded, 3);
  static Instance3* running = nullptr;
  static std::vector<double> times;
  times.clear();
  Instance3 instance(fmu, true,
                     [](fmi3InstanceEnvironment, double time, bool set, bool get, bool finished, bool can,
                        bool* requested, double* when) {
                       EXPECT_TRUE(!set && get && finished && can);
                       EXPECT_EQ(running->get(fmu.reference("t")), time);
                       EXPECT_EQ(running->set(fmu.reference("command"), 1), fmi3Error);
                       times.push_back(time);
                       *requested = time > 0.2;
                       *when = 0.35;
                     });
  running = &instance;
  instance.initialize();
  bool event = false, terminate = false, early = false;
  double last = 0;
  ASSERT_EQ(instance.fmi.DoStep(instance.c, 0, 0.5, true, &event, &terminate, &early, &last), fmi3OK);
  EXPECT_TRUE(early);
  EXPECT_FALSE(terminate);
  EXPECT_EQ(last, 0.35);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  EXPECT_GT(times.size(), 2U);
  host::Simulation simulation(host::Scene::read(library(), commanded));
  simulation.step(0.35);
  EXPECT_NEAR(instance.get(fmu.reference("shoulder")), simulation.output("shoulder"), 1e-6);
  // It goes on from there.
  EXPECT_EQ(instance.fmi.DoStep(instance.c, 0.35, 0.05, true, &event, &terminate, &early, &last), fmi3OK);
}

/// Those that it passes on its way to the time that was asked for, and those before.
TEST(Agreement, AStepThatReturnsEarlyLogsTheEventsThatItHasPassed) {
  const Unpacked& fmu = fmu_of_text("passed", R"(format: withy/1
time: {end: 2}
integrator: {name: rk4, step: 0.01}
bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}
initial: {hinges: {h: {rate: [1]}}}
events: {before: {hinge: h, value: 0.105}, between: {hinge: h, value: 0.215}, beyond: {hinge: h, value: 0.4}}
)");
  Instance3 instance(fmu, true,
                     [](fmi3InstanceEnvironment, double time, bool, bool, bool, bool, bool* requested, double* when) {
                       *requested = time > 0.15;
                       *when = 0.3;
                     });
  instance.initialize();
  ASSERT_EQ(instance.fmi.SetDebugLogging(instance.c, true, 0, nullptr), fmi3OK);
  bool event = false, terminate = false, early = false;
  double last = 0;
  instance.heard.all.clear();
  ASSERT_EQ(instance.fmi.DoStep(instance.c, 0, 1, true, &event, &terminate, &early, &last), fmi3OK);
  EXPECT_EQ(last, 0.3);
  std::string events;
  for (const std::string& line : instance.heard.all)
    if (line.starts_with("Event ")) events += line.substr(0, line.find(" at ")) + ";";
  EXPECT_EQ(events, "Event 'before';Event 'between';");
}

}  // namespace withy::test
