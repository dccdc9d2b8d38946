#include "withy/core/simulation/simulate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "withy/core/simulation/instants.hpp"
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
        summary_(summary),
        clocks_(model),
        stepper_(integrator.start(equations, begun(initial))),
        monitor_(model, equations, stepper_->state(), options.deflection_limit, summary),
        validity_(model, equations, options.beyond, summary.validity),
        zeros_(model, options.events, stepper_->state()),
        times_(initial.time, options.output, options.end),
        sample_(stepper_->state()) {
    if (options.resume != nullptr) {
      take_up(*options.resume);
      return;
    }
    emit(stepper_->state());
    monitor_.observe(stepper_->state(), true);
    validity_.observe(stepper_->state(), 0);
  }

  Stop to_end() {
    const double start = time();
    for (const double landing : landings(model_, start, options_.end)) {
      while (time() < landing) {
        const double limit = std::min(landing, clocks_.next());
        if (Stop stop = to(limit, true); stop.status != RunStatus::completed || stopped_) return stop;
        if (time() < clocks_.next()) continue;
        sample_ = stepper_->state();
        clocks_.renew(sample_);
        clocks_.go_on_after(sample_.time);
        stepper_->jump(sample_);
        zeros_.begin_at(sample_);
        monitor_.pass_instant();
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
  /// Whether an event has ended the run.
  [[nodiscard]] bool stopped() const { return stopped_; }

 private:
  [[nodiscard]] double time() const { return stepper_->state().time; }

  State begun(State state) {
    clocks_.begin(state);
    return state;
  }

  /// Steps to a time, or to an event on the way that stops the run; from a switch passed on the way the steps go on.
  /// Not watching: a step taken back is made again to end at a zero, and nothing comes between.
  Stop to(double limit, bool watching) {
    while (time() < limit && !stopped_) {
      if (watching) {
        if (Stop stop = ended_by_caller(); stop.status != RunStatus::completed) return stop;
        if (!zeros_.empty()) before_ = stepper_->state();
      }
      const StepResult result = stepper_->step(limit);
      if (result.outcome != StepResult::Outcome::ok)
        return stop_of(result, model_, equations_, stepper_->state(), stepper_->statistics());
      if (watching && !zeros_.empty()) {
        const std::optional<ZeroWatch::Zero> zero = look_for_zeros();
        if (zero) {
          if (Stop stop = act_at(*zero); stop.status != RunStatus::completed) return stop;
          continue;
        }
      }
      if (Stop stop = after_step(); stop.status != RunStatus::completed) return stop;
    }
    return {};
  }

  Stop ended_by_caller() {
    const bool interrupted = options_.interrupted && options_.interrupted();
    if (options_.checkpoint && (interrupted || (options_.put_down && options_.put_down()))) put_down();
    if (interrupted) return {RunStatus::interrupted, "interrupted", false};
    if (stepper_->statistics().accepted >= options_.most_steps)
      return {RunStatus::interrupted,
              std::string("stopped after the ") + std::to_string(options_.most_steps) + " steps allowed", false};
    if (options_.most_seconds > 0 &&
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count() > options_.most_seconds)
      return {RunStatus::interrupted, std::string("stopped after the ") + brief(options_.most_seconds) + " s allowed",
              false};
    return {};
  }

  /// Notes the events passed in the last step up to the first zero that changes the run, which is returned.
  std::optional<ZeroWatch::Zero> look_for_zeros() {
    for (const ZeroWatch::Zero& zero : zeros_.find(*stepper_, before_.time)) {
      if (zeros_.switching(zero.function) || zeros_.event(zero.function).stops) return zero;
      note(zero);
      zeros_.pass(zero);
    }
    return {};
  }

  /// Takes the last step back, steps to the zero and does what is to be done there.
  Stop act_at(const ZeroWatch::Zero& zero) {
    if (zero.time - last_zero_ <= 16 * std::numeric_limits<double>::epsilon() * std::abs(zero.time)) {
      if (++zeros_at_once_ > most_zeros_at_once)
        return {RunStatus::step_underflow, "switches follow each other without time between them"};
    } else {
      zeros_at_once_ = 0;
    }
    last_zero_ = zero.time;
    stepper_->jump(before_);
    if (Stop stop = to(zero.time, false); stop.status != RunStatus::completed) return stop;
    std::vector<ZeroWatch::Zero> passed{zero};
    const std::vector<ZeroWatch::Zero>& others = zeros_.land(stepper_->state(), zero);
    passed.insert(passed.end(), others.begin(), others.end());
    sample_ = stepper_->state();
    for (const ZeroWatch::Zero& z : passed) {
      if (const auto load = zeros_.switching(z.function)) {
        clocks_.renew(sample_, load->first, {load->second, z.direction});
        ++summary_.switchings;
      } else {
        note(z);
        stopped_ = stopped_ || zeros_.event(z.function).stops;
      }
    }
    stepper_->jump(sample_);
    monitor_.pass_instant();
    return {};
  }

  void note(const ZeroWatch::Zero& zero) {
    summary_.events.push_back({zeros_.event(zero.function).name, zero.time, zero.direction});
  }

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

  void put_down() {
    Memory memory;
    remember(memory);
    options_.checkpoint({stepper_->state(), stepper_->memory(), memory.numbers()});
  }
  void take_up(const Checkpoint& checkpoint) {
    stepper_->resume(checkpoint.state, checkpoint.stepper);
    Memory memory(checkpoint.watches);
    remember(memory);
    memory.finish();
    clocks_.go_on_after(checkpoint.state.time);
  }
  void remember(Memory& memory) {
    monitor_.remember(memory);
    validity_.remember(memory);
    zeros_.remember(memory);
    times_.remember(memory);
    memory(emitted_);
    memory(last_zero_);
    memory(zeros_at_once_);
    memory(summary_.switchings);
    std::size_t count = summary_.events.size();
    memory(count);
    summary_.events.resize(count);
    for (EventTime& e : summary_.events) {
      const auto named = [&](const RunEvent& event) { return event.name == e.name; };
      auto index = std::find_if(options_.events.begin(), options_.events.end(), named) - options_.events.begin();
      memory(index);
      if (memory.reading()) e.name = options_.events.at(static_cast<std::size_t>(index)).name;
      memory(e.time);
      memory(e.direction);
    }
  }

  static constexpr int most_zeros_at_once = 20;

  const Model& model_;
  const EquationsOfMotion& equations_;
  const RunOptions& options_;
  const std::function<void(const State&)>& output_;
  RunSummary& summary_;
  Clocks clocks_;
  std::unique_ptr<Stepper> stepper_;
  Monitor monitor_;
  ValidityWatch validity_;
  ZeroWatch zeros_;
  OutputTimes times_;
  State sample_;
  State before_;          ///< where the last step began; kept only where zeros are watched
  double emitted_ = 0;    ///< time of the last output
  bool stopped_ = false;  ///< by an event
  double last_zero_ = -std::numeric_limits<double>::infinity();  ///< time of the last one that changed the run
  int zeros_at_once_ = 0;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
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
  Stop stop = run.to_end();
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
    if (run.stopped())
      summary.message = std::string("The event '") + summary.events.back().name +
                        "' ended the run at t = " + brief(summary.final.time) + " s.";
    if (!summary.suspected_jumps.empty())
      summary.message += (summary.message.empty() ? "" : " ") + note_on_jumps(summary.suspected_jumps);
    for (const std::string& remark : run.stepper().remarks())
      summary.message += (summary.message.empty() ? "The integrator: " : " The integrator: ") + remark + ".";
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
