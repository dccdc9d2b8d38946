/// \file
/// Efforts, peaks and drifts that a run reports beside its states.
#include <gmock/gmock.h>

#include <cmath>

#include "withy/core/simulation/simulate.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/tests/simulation/made_scene.hpp"

namespace withy::test {
namespace {

// The axle is driven, and a load acts on it as well.
TEST(RunSummaries, efforts_found_by_an_evaluation_are_those_asked_for) {
  const std::string text =
      "format: withy/1\ntime: {end: 1}\nbodies:\n  hub: {type: rigid, mass: 2, inertia: [1, 1, 0.3, 0, 0, 0]}\n"
      "  boom: {type: beam, length: 1.2, mass_per_length: 0.4, bending_y: {stiffness: 5, modes: 2}}\nhinges:\n"
      "  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n"
      "  root: {type: revolute, axis: [0, 0, 1], parent: hub, child: boom}\nloads:\n"
      "  motor: {type: hinge-effort, hinge: axle, law: sine, amplitude: 0.6, period: 0.7}\n"
      "  spring: {type: spring-damper, frame: boom.tip, anchor: [1, 1, 0], stiffness: 3, damping: 0.2}\nmotions:\n"
      "  spin: {type: spin-up, hinge: axle, rate: 3, duration: 1}\n";
  for (const char* formulation :
       {"ruthless", "rate-linear", "inconsistent", "consistent", "symmetric", "quadratic", "exact"}) {
    SCOPED_TRACE(formulation);
    Made m(text, formulation);
    const EquationsOfMotion& equations = *m.equations;
    State state = m.scene.initial;
    for (std::size_t i = 0; i + 1 < state.y.size(); ++i) state.y[i] = 0.05 * std::sin(1.0 + static_cast<double>(i));
    Work work = equations.make_work(), other = equations.make_work();
    std::vector<double> rates(equations.size());
    const std::size_t speeds = equations.layout().speeds;
    std::vector<double> loads(speeds), motions(speeds), all(speeds), driven(speeds);
    ASSERT_TRUE(equations.derivatives(0.3, state.y, rates, work).ok());
    equations.load_efforts(0.3, state.y, EquationsOfMotion::all_loads, all, other);
    ASSERT_TRUE(equations.motion_efforts(0.3, state.y, driven, other).ok());
    ASSERT_TRUE(equations.found_efforts(work, loads, motions));
    for (std::size_t i = 0; i < speeds; ++i) {
      EXPECT_NEAR(loads[i], all[i], 1e-14) << i;
      EXPECT_EQ(motions[i], driven[i]) << i;
    }
    EXPECT_GT(std::abs(driven[0]), 0.01);
    EXPECT_GT(std::abs(all[0]), 0.01);
  }
}

// What a run says of itself comes from its steps: outputs show it and change nothing. dop853 makes evaluations for its
// outputs, which are not to move the samples.
TEST(RunSummaries, peaks_drift_and_samples_do_not_depend_on_the_output_interval) {
  const std::string text =
      "format: withy/1\ntime: {end: 1.5}\nbodies:\n  hub: {type: rigid, mass: 2, inertia: [1, 1, 0.3, 0, 0, 0]}\n"
      "  boom: {type: beam, length: 1.2, mass_per_length: 0.4, bending_y: {stiffness: 5, modes: 2}}\n"
      "  rod: {type: beam, length: 1, mass_per_length: 0.4, bending_y: {stiffness: 5, modes: 2}}\nhinges:\n"
      "  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n"
      "  root: {type: weld, parent: hub, child: boom}\n"
      "  elbow: {type: revolute, axis: [0, 0, 1], parent: boom.tip, child: rod}\nloads:\n"
      "  motor: {type: hinge-effort, hinge: elbow, law: sine, amplitude: 0.6, period: 0.7}\nmotions:\n"
      "  spin: {type: spin-up, hinge: axle, rate: 3, duration: 1}\n";
  for (const char* formulation : {"ruthless", "quadratic", "exact"}) {
    Made m(text, formulation);
    const auto beyond = m.in("exact");
    const auto summary_of = [&](double interval) {
      RunOptions options;
      options.end = 1.5;
      options.output = interval;
      options.beyond = beyond.get();
      return simulate(*m.scene.model, *m.equations, *make_plugin<Integrator>(m.registry, "dop853"), m.scene.initial,
                      options, {});
    };
    const RunSummary a = summary_of(0.003), b = summary_of(0.21), c = summary_of(1.5);
    for (const RunSummary& other : {b, c}) {
      EXPECT_EQ(a.peak_deflection, other.peak_deflection) << formulation;
      EXPECT_EQ(a.peak_deflection_ratio, other.peak_deflection_ratio);
      EXPECT_EQ(a.peak_section_angle, other.peak_section_angle);
      EXPECT_EQ(a.peak_effort, other.peak_effort);
      EXPECT_EQ(a.peak_motion_effort, other.peak_motion_effort);
      EXPECT_EQ(a.energy_drift, other.energy_drift);
      EXPECT_EQ(a.validity.samples, other.validity.samples);
      EXPECT_EQ(a.validity.neglected.rms, other.validity.neglected.rms);
      EXPECT_EQ(a.validity.neglected.peak, other.validity.neglected.peak);
    }
    EXPECT_GE(a.validity.samples, 10U) << "of a short run";
    // The peak between steps is that of the finest outputs.
    double greatest = 0;
    RunOptions options;
    options.end = 1.5;
    options.output = 1e-3;
    const std::vector<Tip> ends = tips(*m.scene.model);
    static_cast<void>(simulate(
        *m.scene.model, *m.equations, *make_plugin<Integrator>(m.registry, "dop853"), m.scene.initial, options,
        [&](const State& s) { greatest = std::max(greatest, std::abs(deflection(*m.equations, s.y, ends[0])[1])); }));
    EXPECT_NEAR(a.peak_deflection.at("boom")[1], greatest, 2e-3 * greatest) << formulation;
  }
}

// The square of 1e200 is beyond all numbers: what it does to the energy must not pass for a balance.
TEST(RunSummaries, a_motion_whose_energy_is_no_number_is_not_completed) {
  const auto run = [](const std::string& rate) {
    const Made m(
        "format: withy/1\ntime: {end: 1}\nbodies: {wheel: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}\n"
        "hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}\n"
        "initial: {hinges: {axle: {rate: " +
        rate + "}}}\n");
    RunOptions options;
    options.end = options.output = 1;
    return simulate(*m.scene.model, *m.equations, *m.scene.integrator, m.scene.initial, options, [](const State&) {});
  };
  const RunSummary summary = run("1e200");
  EXPECT_EQ(summary.status, RunStatus::diverged);
  EXPECT_THAT(summary.message, testing::HasSubstr("the energy is not finite: the speed 'axle.0' is 1e+200"));
  EXPECT_EQ(run("1e150").status, RunStatus::completed);
}

}  // namespace
}  // namespace withy::test
