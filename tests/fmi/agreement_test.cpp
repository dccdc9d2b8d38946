/// \file
/// What an FMU computes is what the scene computes: co-simulation, model exchange, parameters, rollback, early return.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "withy/host/simulation.hpp"
#include "withy/study/input_error.hpp"
#include "withy/tests/fmi/importer.hpp"

namespace withy::test {
namespace {

const std::string jets = SCENES "/attitude-jets.yaml";

/// Model exchange with the classic Runge-Kutta method: it lands on time events and finds zeros of indicators by
/// halving.
class Integration {
 public:
  Integration(Instance2& instance, std::size_t states, std::size_t indicators)
      : i_(instance), y_(states), z_(indicators), before_(indicators) {
    event();
    EXPECT_EQ(i_.fmi.GetContinuousStates(i_.c, y_.data(), states), fmi2OK);
  }
  void to(double end, double step) {
    while (t_ < end && !terminated) {
      const double limit = std::min(next_, end);
      double h = std::min(step, limit - t_);
      if (limit - (t_ + h) < 1e-3 * step) h = limit - t_;
      const std::vector<double> start = y_;
      indicators(before_);
      std::vector<double> y = advanced(start, h);
      if (passed(y, t_ + h)) {
        double least = 0, most = h;  // no zero before `least`, one before `most`
        while (most - least > 1e-12) {
          const double middle = (least + most) / 2;
          (passed(advanced(start, middle), t_ + middle) ? most : least) = middle;
        }
        h = most;
        y = advanced(start, h);
      }
      t_ = h == limit - t_ ? limit : t_ + h;
      y_ = y;
      put(t_, y_);
      if (t_ == next_ || passed(y_, t_)) event();
    }
  }
  bool terminated = false;
  int events = 0;
  [[nodiscard]] double time() const { return t_; }

 private:
  void put(double t, const std::vector<double>& y) {
    ASSERT_EQ(i_.fmi.SetTime(i_.c, t), fmi2OK) << i_.heard.last;
    ASSERT_EQ(i_.fmi.SetContinuousStates(i_.c, y.data(), y.size()), fmi2OK) << i_.heard.last;
  }
  std::vector<double> slope(double t, const std::vector<double>& y) {
    std::vector<double> f(y.size());
    put(t, y);
    EXPECT_EQ(i_.fmi.GetDerivatives(i_.c, f.data(), f.size()), fmi2OK) << i_.heard.last;
    return f;
  }
  std::vector<double> advanced(const std::vector<double>& y, double h) {
    const auto along = [&](const std::vector<double>& f, double by) {
      std::vector<double> moved = y;
      for (std::size_t k = 0; k < y.size(); ++k) moved[k] += by * f[k];
      return moved;
    };
    const auto a = slope(t_, y), b = slope(t_ + h / 2, along(a, h / 2)), c = slope(t_ + h / 2, along(b, h / 2)),
               d = slope(t_ + h, along(c, h));
    std::vector<double> end = y;
    for (std::size_t k = 0; k < y.size(); ++k) end[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
    return end;
  }
  void indicators(std::vector<double>& values) {
    EXPECT_EQ(i_.fmi.GetEventIndicators(i_.c, values.data(), values.size()), fmi2OK) << i_.heard.last;
  }
  bool passed(const std::vector<double>& y, double t) {
    if (z_.empty()) return false;
    put(t, y);
    indicators(z_);
    for (std::size_t k = 0; k < z_.size(); ++k)
      if (before_[k] * z_[k] < 0) return true;
    return false;
  }
  void event() {
    ++events;
    if (t_ > 0) {
      EXPECT_EQ(i_.fmi.EnterEventMode(i_.c), fmi2OK);
    }
    fmi2EventInfo info{};
    do {
      ASSERT_EQ(i_.fmi.NewDiscreteStates(i_.c, &info), fmi2OK) << i_.heard.last;
      terminated = terminated || info.terminateSimulation != fmi2False;
    } while (info.newDiscreteStatesNeeded != fmi2False);
    next_ = info.nextEventTimeDefined != fmi2False ? info.nextEventTime : 1e300;
    EXPECT_GT(next_, t_);
    EXPECT_EQ(i_.fmi.EnterContinuousTimeMode(i_.c), fmi2OK);
  }

  Instance2& i_;
  double t_ = 0, next_ = 0;
  std::vector<double> y_, z_, before_;
};

std::size_t indicator_count(const Unpacked& fmu) {
  return std::stoul(attributes_of(fmu.xml).at("numberOfEventIndicators"));
}

/// All outputs but the work, by the tables of a run.
void expect_same(const Unpacked& fmu, const std::function<double(std::uint32_t)>& get, const host::Result& run,
                 std::size_t row, double tolerance) {
  for (std::size_t c = 0; c < run.columns.size(); ++c) {
    const std::string& name = run.columns[c].name;
    if (name == "work") continue;
    const double want = run.values[row * run.columns.size() + c];
    EXPECT_NEAR(get(fmu.reference(name)), want, tolerance * (1 + std::abs(want))) << name << " in row " << row;
  }
}

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

}  // namespace

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

TEST(Agreement, AnIntegratorOfTheImportersGivesTheSameRunByModelExchange) {
  for (const auto& [file, end] : {std::pair(commanded, 1.5), std::pair(jets, 12.0)}) {
    host::Scene scene = host::Scene::read(library(), file);
    scene.set("time.end", end).set("time.output", end);
    scene.set("integrator.rtol", 1e-10).set("integrator.atol", 1e-12);
    const host::Result run = scene.run();
    const Unpacked& fmu = exported(file, 2);
    Instance2 instance(fmu, fmi2ModelExchange);
    instance.initialize();
    Integration integration(instance, fmu.states.size(), indicator_count(fmu));
    integration.to(end, 3e-4);
    // The command jumps at 0, 0.6 and 1.2 s; the jets fire and stop, the target is passed.
    EXPECT_GE(integration.events, 3);
    expect_same(
        fmu, [&](auto vr) { return instance.get(vr); }, run, run.rows() - 1, 1e-6);
  }
}

TEST(Agreement, ModelExchangeKeepsTheClocksOfSampledControllersAndEndsAtTheScenesEvent) {
  const Unpacked& fmu = exported(busy_arm_file(), 2);
  Instance2 instance(fmu, fmi2ModelExchange);
  instance.initialize();
  Integration integration(instance, fmu.states.size(), indicator_count(fmu));
  integration.to(1, 2e-4);
  host::Scene scene = host::Scene::parse(library(), busy_arm);
  host::Simulation simulation(scene.set("integrator.rtol", 1e-11).set("integrator.atol", 1e-12));
  ASSERT_FALSE(simulation.advance_to(1));  // the event `halt`
  EXPECT_TRUE(integration.terminated);
  EXPECT_NEAR(integration.time(), simulation.time(), 1e-6);
  for (const char* name : {"axle", "axle.rate", "base.qw", "base.z", "boom.bending_y[1]", "boom.tip.y"})
    EXPECT_NEAR(instance.get(fmu.reference(name)), simulation.output(name), 1e-6) << name;
  // In co-simulation the step is discarded there, and the importer is told.
  Instance2 stepped(fmu, fmi2CoSimulation);
  stepped.initialize();
  EXPECT_EQ(stepped.fmi.DoStep(stepped.c, 0, 1, fmi2True), fmi2Discard);
  double last = 0;
  fmi2Boolean terminated = fmi2False;
  EXPECT_EQ(stepped.fmi.GetRealStatus(stepped.c, fmi2LastSuccessfulTime, &last), fmi2OK);
  EXPECT_EQ(stepped.fmi.GetBooleanStatus(stepped.c, fmi2Terminated, &terminated), fmi2OK);
  EXPECT_NEAR(last, simulation.time(), 1e-6);
  EXPECT_EQ(terminated, fmi2True);
  EXPECT_NE(stepped.heard.last.find("event 'halt'"), std::string::npos);
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

}  // namespace withy::test
