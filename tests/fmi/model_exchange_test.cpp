/// \file
/// An integrator that is not withy's around an FMU gives the run that the scene gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "withy/host/simulation.hpp"
#include "withy/tests/fmi/same_as_run.hpp"

namespace withy::test {
namespace {

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

}  // namespace

TEST(Agreement, AnIntegratorOfTheImportersGivesTheSameRunByModelExchange) {
  for (const auto& [file, end] : {std::pair(commanded, 1.5), std::pair(jets, 12.0)}) {
    const host::Result run = exact_run(file, end);
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

/// Events that only report, or end the run, act on nothing: FMUs look for all kinds of them.
TEST(Agreement, EventsThatDoNothingAreLookedForInBothKinds) {
  const std::string watched = R"(
  far: {signal: reach.x, value: 0.7, direction: down}
  again: {signal: axle.rate, value: 0.2, delay: 0.01, repeat: true}
  timed: {at: 0.15}
)";
  const auto ended_by = [&](const std::string& name, const std::string& last) {
    std::string text = busy_arm + watched + last + "outputs: {reach: {type: frame, of: boom.tip, in: world}}\n";
    text.erase(text.find("  halt:"), text.find("far:") - text.find("  halt:") - 2);
    const std::filesystem::path file = scratch() / (name + ".yaml");
    std::ofstream(file) << text;
    const Unpacked& fmu = exported(file.string(), 2);
    host::Scene scene = host::Scene::read(library(), file.string());
    host::Simulation simulation(scene.set("integrator.rtol", 1e-11).set("integrator.atol", 1e-12));
    EXPECT_FALSE(simulation.advance_to(1)) << name;
    Instance2 exchanged(fmu, fmi2ModelExchange);
    exchanged.initialize();
    Integration integration(exchanged, fmu.states.size(), indicator_count(fmu));
    integration.to(1, 2e-4);
    EXPECT_TRUE(integration.terminated) << name;
    EXPECT_NEAR(integration.time(), simulation.time(), 1e-6) << name;
    Instance2 stepped(fmu, fmi2CoSimulation);
    stepped.initialize();
    EXPECT_EQ(stepped.fmi.DoStep(stepped.c, 0, 1, fmi2True), fmi2Discard);
    double end = 0;
    EXPECT_EQ(stepped.fmi.GetRealStatus(stepped.c, fmi2LastSuccessfulTime, &end), fmi2OK);
    EXPECT_NEAR(end, simulation.time(), 1e-6) << name;
    EXPECT_NE(stepped.heard.last.find("event '" + name + "'"), std::string::npos) << stepped.heard.last;
  };
  ended_by("passed", "  passed: {signal: axle.rate, value: 0.3, stop: true}\n");
  ended_by("late", "  late: {hinge: axle, value: 0.05, delay: 0.05, stop: true}\n");
  ended_by("clock", "  clock: {at: 0.4, stop: true}\n");
  ended_by("after", "  first: {hinge: axle, value: 0.05}\n  after: {after: first, delay: 0.03, stop: true}\n");
}

}  // namespace withy::test
