#include "withy/study/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "withy/core/simulation/instants.hpp"
#include "withy/study/growth.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

RunOptions options_of(const Prepared& prepared, const Control& control) {
  RunOptions options = run_options(prepared.scene);
  options.interrupted = control.interrupted;
  return options;
}

/// Whether the wall time between checkpoints has passed since the last one was written: a disk that takes longer than
/// this to write one does not stop the run. It is asked at each step; the clock is read about every millisecond.
class Timer {
 public:
  explicit Timer(double seconds) : interval_(seconds), last_(Clock::now()), read_(last_) {}
  [[nodiscard]] bool due() {
    if (++asked_ < enough_) return false;
    const Clock::time_point now = Clock::now();
    const bool brief = now - read_ < std::chrono::milliseconds(1);
    enough_ = brief ? std::min(2 * enough_, 1024) : std::max(enough_ / 2, 1);
    asked_ = 0;
    read_ = now;
    return now - last_ >= interval_;
  }
  void restart() { last_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  std::chrono::duration<double> interval_;
  Clock::time_point last_, read_;
  int asked_ = 0, enough_ = 1;
};

/// The run of formulation `auto`.
EscalatedRun run_escalating(const Prepared& prepared, const RunSettings& settings) {
  const Scene& scene = prepared.scene;
  for (const LoadNode& load : scene.model->loads())
    if (load.load->discrete() != nullptr && load.load->input() == nullptr)
      throw InputError(scene.file + ": /formulation: got 'auto', which changes the equations along a run; load '" +
                       load.name + "' has discrete states, which do not go over: name a formulation");
  if (settings.checkpoint_seconds > 0 || settings.resume != nullptr)
    throw InputError(scene.file + ": /formulation: a run of 'auto' keeps no checkpoints; name a formulation");
  const RunOptions options = options_of(prepared, settings.control);
  return simulate_escalating(*scene.model, prepared.rungs, *scene.integrator, scene.initial, options,
                             [&](const State& state, std::size_t rung) {
                               settings.control.tell(state.time, options.end);
                               if (settings.output) settings.output(state, rung);
                             });
}

/// The run of any other formulation.
RunSummary run_plainly(const Prepared& prepared, const RunSettings& settings, const EquationsOfMotion* beyond) {
  const Scene& scene = prepared.scene;
  RunOptions options = options_of(prepared, settings.control);
  options.beyond = beyond;
  Timer timer(settings.checkpoint_seconds);
  if (settings.checkpoint)
    options.checkpoint = [&](const Checkpoint& checkpoint) {
      settings.checkpoint(checkpoint);
      timer.restart();
    };
  options.resume = settings.resume;
  options.seen = settings.seen;
  if (settings.checkpoint_seconds > 0) options.checkpoint_due = [&] { return timer.due(); };
  return withy::simulate(*scene.model, *prepared.equations, *scene.integrator, scene.initial, options,
                         [&](const State& state) {
                           settings.control.tell(state.time, options.end);
                           if (settings.output) settings.output(state, 0);
                         });
}

/// What the last stretch of a run of `auto` may be compared with.
std::optional<Beyond> beyond_last(const Prepared& prepared, const EscalatedRun& run, Registry& registry) {
  const std::size_t last = run.stretches.back().rung;
  if (last + 1 >= prepared.rungs.size() || !flexible(prepared.model())) return {};
  Beyond beyond = compile_throughout(prepared, registry, prepared.rungs[last + 1].name);
  beyond.highest = !next_rung(registry, beyond.formulation);
  return beyond;
}

bool wanted(Estimate estimate, const Beyond& beyond) {
  return estimate == Estimate::always || (estimate == Estimate::automatic && !beyond.highest);
}

}  // namespace

CertifiedRun run(const Prepared& prepared, Registry& registry, const RunSettings& settings) {
  CertifiedRun result;
  std::optional<Beyond> beyond;
  std::optional<EscalatedRun> escalated;
  const EquationsOfMotion* used = prepared.equations.get();
  if (prepared.escalates()) {
    escalated = run_escalating(prepared, settings);
    result.summary = escalated->summary;
    if (settings.look_beyond) beyond = beyond_last(prepared, *escalated, registry);
    // A run that changed its formulation on the way has no estimate.
    const Stretch& last = escalated->stretches.back();
    used = last.start > prepared.scene.initial.time ? nullptr : prepared.rungs[last.rung].equations;
  } else {
    if (settings.look_beyond) beyond = next_model_up(prepared, registry);
    result.summary = run_plainly(prepared, settings, beyond ? beyond->equations.get() : nullptr);
  }
  result.summary.message += growth_text(prepared, result.summary);
  std::optional<ErrorEstimate> estimate;
  if (beyond && used != nullptr && wanted(settings.estimate, *beyond) && !has_switches(prepared.model()) &&
      result.summary.status != RunStatus::interrupted)
    estimate = estimate_error(prepared.scene, *used, *beyond, result.summary, registry, settings.control.interrupted);
  result.certificate = certify(
      prepared, {&result.summary, beyond ? &*beyond : nullptr, escalated ? &*escalated : nullptr, std::move(estimate)},
      registry);
  return result;
}

std::string outcome_text(const RunSummary& summary) {
  if (summary.status == RunStatus::completed) return "completed";
  return fmt::format("{} at {:.4g} s", name(summary.status), summary.reached);
}

RunSummary simulate(const Prepared& prepared, const std::function<void(const State&)>& output, const Control& control) {
  RunSettings settings;
  settings.control = control;
  settings.output = [&](const State& state, std::size_t) {
    if (output) output(state);
  };
  if (prepared.escalates()) return run_escalating(prepared, settings).summary;
  return run_plainly(prepared, settings, nullptr);
}

}  // namespace withy::study
