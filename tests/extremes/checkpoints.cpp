/// \file
/// Runs saved at a hundred random steps and resumed, with every integrator: bit by bit the run that went on.
#include <algorithm>
#include <optional>
#include <random>
#include <set>

#include "campaign.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::extremes {
namespace {

/// A sampled controller, a load that jumps, a quaternion, modes and events: all that a run remembers.
const std::string busy = R"(format: withy/1
time: {end: 2, output: 0.05}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 2}, damping_ratio: 0.01}
  turret: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
  ball: {type: spherical, parent: boom.tip, child: turret}
loads:
  control: {type: pd-controller, law: quintic, duration: 1.5, sample: 0.03, hinges: {axle: {to: 1, stiffness: 5, damping: 1}}}
  push: {type: hinge-effort, hinge: ball, component: 2, law: steps, table: [[0.2, 0.05], [0.9, 0]]}
events:
  half: {hinge: axle, value: 0.5}
  back: {hinge: axle, of: rate, direction: down}
)";

struct Ran {
  RunSummary summary;
  std::vector<State> outputs;
  std::size_t asked = 0;  ///< times between steps at which the run could be saved
  std::optional<Checkpoint> checkpoint;
  std::size_t outputs_before = 0;  ///< the checkpoint
};

/// Runs; `save_after` counts the steps after which it is saved.
Ran run(const Made& made, std::size_t save_after, const Checkpoint* resume) {
  Ran r;
  RunOptions options;
  options.end = 2;
  options.output = made.scene.output;
  options.events = made.scene.events;
  options.resume = resume;
  options.checkpoint_due = [&] { return ++r.asked == save_after; };
  options.checkpoint = [&](const Checkpoint& c) {
    r.checkpoint = c;
    r.outputs_before = r.outputs.size();
  };
  r.summary = simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options,
                       [&](const State& s) { r.outputs.push_back(s); });
  return r;
}

/// Empty where a run that was resumed agrees bit by bit, from the checkpoint on, with another.
std::string differences(const Ran& resumed, std::size_t outputs_before, const Ran& other) {
  const RunSummary &a = resumed.summary, &b = other.summary;
  std::string text;
  if (a.status != RunStatus::completed)
    return fmt::format("{} at {:.3g} s: {}; ", name(a.status), a.final.time, a.message);
  if (a.final.time != b.final.time || a.final.y != b.final.y) text += "final state; ";
  bool same = resumed.outputs.size() + outputs_before == other.outputs.size();
  for (std::size_t i = 0; same && i < resumed.outputs.size(); ++i)
    same = resumed.outputs[i].y == other.outputs[i + outputs_before].y;
  if (!same) text += "outputs; ";
  if (a.steps.accepted != b.steps.accepted || a.steps.rejected != b.steps.rejected ||
      a.steps.evaluations != b.steps.evaluations || a.steps.smallest_step != b.steps.smallest_step)
    text += "statistics; ";
  if (a.peak_effort != b.peak_effort || a.peak_deflection != b.peak_deflection || a.energy_drift != b.energy_drift ||
      a.suspected_jumps != b.suspected_jumps)
    text += "what the run saw; ";
  same = a.events.size() == b.events.size();
  for (std::size_t i = 0; same && i < a.events.size(); ++i) same = a.events[i].time == b.events[i].time;
  if (!same) text += "events; ";
  return text;
}

}  // namespace

void checkpoints(Campaign& campaign) {
  const std::size_t count = campaign.quick() ? 5 : 100;
  for (const std::string& id : ids<Integrator>()) {
    const std::string tolerance = with_tolerance(id, 1e-7);
    const Made made(busy, "quadratic", {"integrator=" + (tolerance.empty() ? equal_steps(id, 0.005) : tolerance)});
    const Ran whole = run(made, 0, nullptr);
    if (const std::string twice = differences(run(made, 0, nullptr), 0, whole); !twice.empty()) {
      campaign.row(id + ", a run made twice", "the first", "bitwise", twice, false);
      continue;
    }
    std::set<std::size_t> steps;
    std::mt19937 random(21);
    std::uniform_int_distribution<std::size_t> any(1, whole.asked);
    while (steps.size() < std::min(count, whole.asked)) steps.insert(any(random));
    std::string bad;
    for (const std::size_t step : steps) {
      const Ran through = run(made, step, nullptr);
      if (const std::string d = differences(through, 0, whole); !d.empty())
        bad += fmt::format("saved at step {}: {}", step, d);
      if (!through.checkpoint) {
        bad += fmt::format("step {}: no checkpoint; ", step);
        continue;
      }
      const Ran resumed = run(made, 0, &*through.checkpoint);
      if (const std::string d = differences(resumed, through.outputs_before, whole); !d.empty())
        bad += fmt::format("resumed at step {} of {}: {}", step, whole.asked, d);
    }
    campaign.row(fmt::format("{}, saved at {} random steps of {} and resumed", id, steps.size(), whole.asked),
                 "the uninterrupted run", "bitwise: state, outputs, history, statistics, events",
                 bad.empty() ? "bitwise" : bad.substr(0, 200), bad.empty() && steps.size() == count);
  }
}

}  // namespace withy::extremes
