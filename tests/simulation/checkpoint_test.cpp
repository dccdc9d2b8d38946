/// \file
/// Runs restored from checkpoints at random steps end as the uninterrupted run, in all that it reports.
#include <optional>
#include <random>
#include <set>

#include "made_scene.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {
namespace {

struct Ran {
  RunSummary summary;
  std::vector<State> outputs;
  std::size_t asked = 0;
  std::optional<Checkpoint> checkpoint;
};

/// Runs; a checkpoint is made when the run has asked for one `save_at` times.
Ran run(const test::Made& made, const EquationsOfMotion* beyond, std::size_t save_at, const Checkpoint* resume) {
  Ran r;
  RunOptions options;
  options.end = made.scene.end.value_or(1);
  options.output = made.scene.output;
  options.events = made.scene.events;
  options.beyond = beyond;
  options.resume = resume;
  options.checkpoint_due = [&] { return ++r.asked == save_at; };
  options.checkpoint = [&](const Checkpoint& c) { r.checkpoint = c; };
  r.summary = simulate(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, options,
                       [&](const State& s) { r.outputs.push_back(s); });
  return r;
}

void expect_equal(const BodyValidity& a, const BodyValidity& b) {
  EXPECT_EQ(a.rate_ratio, b.rate_ratio);
  EXPECT_EQ(a.rate_time, b.rate_time);
  EXPECT_EQ(a.load.least, b.load.least);
  EXPECT_EQ(a.load.greatest, b.load.greatest);
  EXPECT_EQ(a.load.shares, b.load.shares);
  EXPECT_EQ(a.load_time, b.load_time);
  EXPECT_EQ(a.buckling, b.buckling);
  for (std::size_t i = 0; i < a.highest.size(); ++i) EXPECT_EQ(a.highest[i].share, b.highest[i].share);
}

/// Everything but CPU time.
void expect_equal(const RunSummary& a, const RunSummary& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.message, b.message);
  EXPECT_EQ(a.final.time, b.final.time);
  EXPECT_EQ(a.final.y, b.final.y);
  EXPECT_EQ(a.peak_deflection, b.peak_deflection);
  EXPECT_EQ(a.peak_deflection_ratio, b.peak_deflection_ratio);
  EXPECT_EQ(a.peak_section_angle, b.peak_section_angle);
  EXPECT_EQ(a.peak_effort, b.peak_effort);
  EXPECT_EQ(a.peak_motion_effort, b.peak_motion_effort);
  EXPECT_EQ(a.energy_drift, b.energy_drift);
  EXPECT_EQ(a.switchings, b.switchings);
  EXPECT_EQ(a.suspected_jumps, b.suspected_jumps);
  EXPECT_EQ(a.conditioning.condition, b.conditioning.condition);
  EXPECT_EQ(a.fastest_mode, b.fastest_mode);
  ASSERT_EQ(a.events.size(), b.events.size());
  for (std::size_t i = 0; i < a.events.size(); ++i) {
    EXPECT_EQ(a.events[i].name, b.events[i].name);
    EXPECT_EQ(a.events[i].time, b.events[i].time);
    EXPECT_EQ(a.events[i].direction, b.events[i].direction);
  }
  EXPECT_EQ(a.steps.accepted, b.steps.accepted);
  EXPECT_EQ(a.steps.rejected, b.steps.rejected);
  EXPECT_EQ(a.steps.evaluations, b.steps.evaluations);
  EXPECT_EQ(a.validity.samples, b.validity.samples);
  EXPECT_EQ(a.validity.neglected.samples, b.validity.neglected.samples);
  EXPECT_EQ(a.validity.neglected.rms, b.validity.neglected.rms);
  EXPECT_EQ(a.validity.neglected.peak, b.validity.neglected.peak);
  ASSERT_EQ(a.validity.bodies.size(), b.validity.bodies.size());
  for (std::size_t i = 0; i < a.validity.bodies.size(); ++i) expect_equal(a.validity.bodies[i], b.validity.bodies[i]);
}

/// Restores runs of a scene at 100 random steps.
void expect_restores(const std::string& text, const std::string& next_up = "") {
  test::Made made(text);
  const auto beyond = next_up.empty() ? nullptr : made.in(next_up);
  const Ran whole = run(made, beyond.get(), 0, nullptr);
  ASSERT_GT(whole.asked, 100U);
  std::mt19937 random(7);
  std::uniform_int_distribution<std::size_t> any(1, whole.asked);
  std::set<std::size_t> steps;
  while (steps.size() < 100) steps.insert(any(random));
  for (const std::size_t step : steps) {
    SCOPED_TRACE("step " + std::to_string(step));
    const Ran interrupted = run(made, beyond.get(), step, nullptr);
    ASSERT_TRUE(interrupted.checkpoint);
    expect_equal(run(made, beyond.get(), 0, &*interrupted.checkpoint).summary, whole.summary);
  }
}

/// Stops so hard that steps are rejected in bursts, of which a run reports sixteen at most, each once.
TEST(Checkpoints, restore_what_is_known_of_rejected_steps) {
  expect_restores(R"(format: withy/1
bodies: {p: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {a: {type: revolute, axis: [0, 0, 1], parent: world, child: p}}
loads: {l: {type: hinge-limit, hinge: a, lower: -0.1, upper: 0.1, stiffness: 1.0e+8, onset: 1.0e-7}}
initial: {hinges: {a: {rate: [1.0]}}}
time: {end: 3, output: 0.1}
integrator: {name: dopri5, rtol: 1.0e-2, atol: 1.0e-4}
)");
}

/// A beam in segments, whose tip is watched at outputs alone, a relay, events, and what a sample of validity holds.
TEST(Checkpoints, restore_peaks_events_and_validity) {
  expect_restores(R"(format: withy/1
formulation: ruthless
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, segments: 2, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 1, family: orthogonal-polynomials}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
loads:
  switch: {type: hinge-relay, hinge: axle, effort: 0.3, on: 0.05, off: 0.01, rate_time: 0.2}
events:
  half: {hinge: axle, value: 0.02}
initial: {hinges: {axle: {rate: [0.5]}}}
time: {end: 3, output: 0.05}
integrator: {name: dopri5, rtol: 1.0e-6, atol: 1.0e-8}
)",
                  "quadratic");
}

/// Hinges that events lock and unlock, a load that they switch, and an event that waits.
TEST(Checkpoints, restore_what_events_have_done) {
  expect_restores(R"(format: withy/1
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 1}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: revolute, axis: [0, 0, 1], parent: hub, child: boom}
loads:
  spring: {type: hinge-spring, hinge: root, stiffness: 2, damping: 0.02}
  motor: {type: hinge-effort, hinge: axle, law: constant, value: 0.3}
outputs: {knee: {type: hinge, hinge: root}}
events:
  latch: {hinge: root, value: 0.05, direction: up, repeat: true, do: {lock: root, switch_off: motor}}
  open: {after: latch, delay: 0.3, repeat: true, do: {unlock: root, switch_on: motor}}
  pull: {signal: knee.acceleration, value: -2, do: {set: loads.motor.value=0.5}}
initial: {hinges: {axle: {rate: [0.5]}, root: {rate: [0.8]}}}
time: {end: 4, output: 0.05}
integrator: {name: dopri5, rtol: 1.0e-6, atol: 1.0e-8}
)");
}

/// From its first output to the checkpoint, which is made where little is left of the run.
TEST(Checkpoints, restore_the_processor_time_that_was_spent_before) {
  const test::Made made(R"(format: withy/1
bodies: {boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 4}}}
hinges: {root: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
initial: {hinges: {root: {rate: [0.8]}}}
time: {end: 1, output: 1}
integrator: {name: rk4, step: 1.0e-4}
)");
  double first = 0, saved_at = 0;
  std::size_t asked = 0;
  std::optional<Checkpoint> saved;
  RunOptions options;
  options.end = 1;
  options.output = 1;
  options.checkpoint_due = [&] {
    if (++asked != 9900) return false;
    saved_at = thread_cpu_seconds();
    return true;
  };
  options.checkpoint = [&](const Checkpoint& c) { saved = c; };
  const auto run = [&] {
    return simulate(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, options,
                    [&](const State&) { first = first > 0 ? first : thread_cpu_seconds(); });
  };
  static_cast<void>(run());
  ASSERT_TRUE(saved);
  options.resume = &*saved;
  EXPECT_GT(run().cpu_seconds, saved_at - first);
}

}  // namespace
}  // namespace withy
