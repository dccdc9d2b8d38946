#include "withy/core/simulation/simulate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "withy/core/simulation/monitor.hpp"
#include "withy/core/simulation/run_times.hpp"

namespace withy {
namespace {

/// Why stepping ended before the end.
struct Stop {
  RunStatus status = RunStatus::completed;
  std::string reason;    ///< a clause without its full stop
  bool physical = true;  ///< the equations are the reason, not the caller
};

Stop stop_of(const StepResult& result, const Model& model, const EquationsOfMotion& equations, const State& state,
             const StepStatistics& steps) {
  const std::string body =
      result.body >= 0 ? " at body '" + model.bodies()[static_cast<std::size_t>(result.body)].name + "'" : "";
  switch (result.outcome) {
    case StepResult::Outcome::nonfinite: {
      const std::string culprit = describe_nonfinite(model, equations, state, steps.largest_step);
      return {RunStatus::diverged, "the derivatives are not finite, however small the step" + body +
                                       (culprit.empty() ? culprit : ": " + culprit)};
    }
    case StepResult::Outcome::singular:
      return {RunStatus::singular, "the mass matrix cannot be solved, however small the step" + body};
    case StepResult::Outcome::step_underflow:
      return {RunStatus::step_underflow, "the accuracy asked for needs steps below the resolution of time"};
    case StepResult::Outcome::ok:
      break;
  }
  return {};
}

/// The loop itself: what happens between two accepted steps.
class Run {
 public:
  Run(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator, const State& initial,
      const RunOptions& options, const std::function<void(const State&)>& output, RunSummary& summary)
      : model_(model),
        equations_(equations),
        options_(options),
        output_(output),
        stepper_(integrator.start(equations, initial)),
        monitor_(model, equations, stepper_->state(), options.deflection_limit, summary),
        validity_(model, equations, options.beyond, summary.validity),
        times_(initial.time, options.output, options.end),
        sample_(stepper_->state()) {
    emit(stepper_->state());
    monitor_.observe(stepper_->state(), true);
    validity_.observe(stepper_->state(), 0);
  }

  Stop to_end(double start) {
    const auto began = std::chrono::steady_clock::now();
    for (const double limit : landings(model_, start, options_.end)) {
      while (stepper_->state().time < limit) {
        if (options_.interrupted && options_.interrupted()) return {RunStatus::interrupted, "interrupted", false};
        if (stepper_->statistics().accepted >= options_.most_steps)
          return {RunStatus::interrupted,
                  std::string("stopped after the ") + std::to_string(options_.most_steps) + " steps allowed", false};
        if (options_.most_seconds > 0 &&
            std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() > options_.most_seconds)
          return {RunStatus::interrupted,
                  std::string("stopped after the ") + brief(options_.most_seconds) + " s allowed", false};
        const StepResult result = stepper_->step(limit);
        if (result.outcome != StepResult::Outcome::ok)
          return stop_of(result, model_, equations_, stepper_->state(), stepper_->statistics());
        if (Stop stop = after_step(); stop.status != RunStatus::completed) return stop;
      }
      stepper_->restart();
    }
    return {};
  }

  /// The last state is an output, however the run ended.
  void finish(RunStatus status) {
    const State& state = stepper_->state();
    monitor_.observe(state, true);
    if (state.time > emitted_) emit(state);
    monitor_.audit_energy(state);
    validity_.finish(state, stepper_->statistics().evaluations, status == RunStatus::completed);
  }

  [[nodiscard]] const Stepper& stepper() const { return *stepper_; }
  [[nodiscard]] const Monitor& monitor() const { return monitor_; }

 private:
  Stop after_step() {
    const State& state = stepper_->state();
    monitor_.audit_steps(state, stepper_->statistics());
    if (times_.due(state.time)) {
      for (; times_.due(state.time); times_.pass()) {
        sample_.time = times_.next();
        stepper_->interpolate(sample_.time, sample_.y);
        monitor_.observe(sample_, true);
        emit(sample_);
      }
      monitor_.audit_energy(state);
    }
    monitor_.observe(state, false);
    validity_.observe(state, stepper_->statistics().evaluations);
    monitor_.audit_mass_matrix(state, stepper_->statistics().determinant_sign);
    // Accelerations have a pole where det M vanishes: what lies behind it is no motion of the model.
    if (monitor_.sign_change()) return {RunStatus::singular, "the determinant of the mass matrix changed its sign"};
    if (!monitor_.excess().empty()) return {RunStatus::diverged, monitor_.excess()};
    return {};
  }

  void emit(const State& state) {
    emitted_ = state.time;
    if (output_) output_(state);
  }

  const Model& model_;
  const EquationsOfMotion& equations_;
  const RunOptions& options_;
  const std::function<void(const State&)>& output_;
  std::unique_ptr<Stepper> stepper_;
  Monitor monitor_;
  ValidityWatch validity_;
  OutputTimes times_;
  State sample_;
  double emitted_ = 0;  ///< time of the last output
};

std::string note_on_jumps(const std::vector<double>& times) {
  std::string text = "Steps were rejected again and again near t =";
  for (const double t : times) text.append(" ").append(brief(t));
  return text + " s: does a load jump there without declaring it?";
}

}  // namespace

std::string_view name(RunStatus status) {
  switch (status) {
    case RunStatus::completed:
      return "completed";
    case RunStatus::diverged:
      return "diverged";
    case RunStatus::singular:
      return "singular";
    case RunStatus::step_underflow:
      return "step-underflow";
    case RunStatus::interrupted:
      return "interrupted";
  }
  return "unknown";
}

RunSummary simulate(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator,
                    const State& initial, const RunOptions& options, const std::function<void(const State&)>& output) {
  if (!(options.end >= initial.time)) throw std::invalid_argument("the end lies before the initial time");
  if (!(options.output > 0)) throw std::invalid_argument("the output interval is not positive");
  const double began = thread_cpu_seconds();
  RunSummary summary;
  Run run(model, equations, integrator, initial, options, output, summary);
  Stop stop = run.to_end(initial.time);
  run.finish(stop.status);
  summary.final = run.stepper().state();
  summary.steps = run.stepper().statistics();
  const bool examined = equations.layout().speeds <= largest_examined;
  const std::optional<SignChange>& change = run.monitor().sign_change();
  MassMatrixHistory history;
  if (examined && (change || stop.status != RunStatus::completed)) {
    history = examine(equations, initial, summary.final, change);
    summary.conditioning = history.end;
  } else if (examined) {
    history.last = equations.system(summary.final.time, summary.final.y);
    summary.conditioning = conditioning(history.last);
  }
  if (examined) summary.fastest_mode = fastest_mode(model, history.last);
  if (stop.status == RunStatus::completed) {
    if (!summary.suspected_jumps.empty())
      summary.message += (summary.message.empty() ? "" : " ") + note_on_jumps(summary.suspected_jumps);
  } else {
    summary.suspected_jumps.clear();  // the rejections before a bad end are that end
    // Steps that collapse where M loses rank collapse because of it.
    if (stop.status == RunStatus::step_underflow && examined && history.lost_definiteness())
      stop.status = RunStatus::singular;
    summary.message = std::string("t = ") + brief(summary.final.time) + " s: " + stop.reason + ".";
    if (stop.physical)
      summary.message +=
          examined ? " " + describe(history, model.layout()) : " The mass matrix, with so many rows, was not examined.";
  }
  summary.status = stop.status;
  summary.cpu_seconds = thread_cpu_seconds() - began;
  return summary;
}

}  // namespace withy
