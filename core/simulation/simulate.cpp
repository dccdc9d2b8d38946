#include "withy/core/simulation/simulate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "withy/core/simulation/changing_equations.hpp"
#include "withy/core/simulation/creep_watch.hpp"
#include "withy/core/simulation/end_notes.hpp"
#include "withy/core/simulation/event_actions.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/loop_following.hpp"
#include "withy/core/simulation/loop_watch.hpp"
#include "withy/core/simulation/monitor.hpp"
#include "withy/core/simulation/motion_gap.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/core/simulation/step_watch.hpp"
#include "withy/core/simulation/stepping.hpp"
#include "withy/core/simulation/stop.hpp"

namespace withy {
namespace {

/// What a run makes of its steps: checks, outputs, its summary.
class Run final : public SteppingObserver {
 public:
  Run(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator, const State& initial,
      const RunOptions& options, const std::function<void(const State&)>& output, StepWatch* watch, Attention attention,
      RunSummary& summary)
      : model_(model),
        equations_(equations),
        options_(options),
        output_(output),
        watch_(watch),
        summary_(summary),
        hand_overs_(options.changing != nullptr ? options.changing->hand_overs() : std::vector<double>()),
        actions_(model, equations, options.events),
        loop_(model, equations, start_stepper(integrator, equations, begun(model, equations, initial)),
              {options.end, options.output, actions_.watched(), hand_overs_, &actions_}),
        monitor_(model, equations, loop_.state(), options.deflection_limit, options.end - initial.time, options.seen,
                 summary, attention),
        loops_(equations, loop_.state()),
        motion_gap_(model),
        halves_(initial.time),
        creep_(equations, initial, options.own_energy) {
    if (attention == Attention::whole) validity_.emplace(model, equations, options.beyond, summary.validity);
    if (options.own_energy) monitor_.use_own_energy(loop_.state());
    if (std::isfinite(options.drift_limit)) monitor_.trust(options.drift_limit);
    if (options.resume != nullptr) {
      restore(*options.resume);
      return;
    }
    begin_watches();
    output_at(loop_.state());
    if (validity_) validity_->observe(loop_.state(), 0, loop_.state().time, nullptr);
  }

  Stop to_end() {
    SteppingEnd end = loop_.run(*this);
    while (options_.past_stops && end.cause == SteppingEnd::Cause::event) end = loop_.run(*this);
    if (end.cause == SteppingEnd::Cause::stopped) return stop_;
    // Not every step is audited.
    const bool ended = end.cause == SteppingEnd::Cause::reached || end.cause == SteppingEnd::Cause::event;
    if (const std::string number = ended ? nonfinite_number(model_.layout(), loop_.state()) : ""; !number.empty())
      return {RunStatus::diverged, "the state is not finite: " + number, false};
    return stop_of(end, model_, equations_, loop_.state(), loop_.stepper());
  }

  /// The last state is an output, however the run ended.
  void finish(RunStatus status) {
    const State& state = loop_.state();
    if (state.time > emitted_) {
      output_at(state);
    } else {
      monitor_.show(state);
    }
    monitor_.finish(state);
    const bool completed = status == RunStatus::completed;
    if (validity_) validity_->finish(completed ? state : monitor_.trusted(), status != RunStatus::singular);
  }

  [[nodiscard]] const Stepper& stepper() const { return loop_.stepper(); }
  [[nodiscard]] const EquationsOfMotion& equations() const { return equations_; }
  [[nodiscard]] Monitor& monitor() { return monitor_; }
  [[nodiscard]] const Monitor& monitor() const { return monitor_; }
  [[nodiscard]] const MotionGap& motion_gap() const { return motion_gap_; }
  /// Names of the events that have ended the run.
  [[nodiscard]] const std::vector<std::string>& stopped_by() const { return stopped_by_; }

  bool before_step(const Stepper& stepper) override {
    const bool interrupted = options_.interrupted && options_.interrupted();
    if (options_.checkpoint && (interrupted || (options_.checkpoint_due && options_.checkpoint_due()))) save();
    if (interrupted) {
      stop_ = {RunStatus::interrupted, "interrupted", false};
    } else if (halves_.made(stepper) >= options_.most_steps) {
      stop_ = {RunStatus::interrupted, "stopped after the " + std::to_string(options_.most_steps) + " steps allowed",
               false};
    } else if (options_.most_seconds > 0 && seconds() > options_.most_seconds) {
      stop_ = {RunStatus::interrupted, "stopped after the " + brief(options_.most_seconds) + " s allowed", false};
    } else if (const std::optional<TwoHalves> halves = halves_.look(stepper)) {
      look_at_pace(*halves, stepper.state());
    }
    return stop_.status == RunStatus::completed;
  }
  bool output(const State& state) override {
    output_at(state);
    return true;
  }
  void landed(const State& state) override {
    if (!std::binary_search(hand_overs_.begin(), hand_overs_.end(), state.time)) return;
    if (validity_) validity_->settle();
    monitor_.rebase_energy(state, [&] { options_.changing->go_over(state.time); });
  }
  bool after_step(const Stepper& stepper, bool /*outputs*/) override {
    const State& state = stepper.state();
    const std::string fault = loops_.fault(stepper);
    if (!fault.empty()) monitor_.distrust();
    monitor_.audit_steps(state, stepper.statistics());
    monitor_.observe(stepper);
    motion_gap_.look(state);
    if (watch_ != nullptr) watch_->observe(stepper);
    monitor_.audit_mass_matrix(state, stepper.statistics().determinant_sign);
    const bool seen = audited(stepper.statistics().accepted);
    if (seen) monitor_.audit_energy(state);
    if (validity_)
      validity_->observe(state, loop_.step_evaluations(), monitor_.trusted().time, seen ? &monitor_.seen() : nullptr);
    // Accelerations have a pole where det M vanishes: what lies behind it is no motion of the model.
    if (!fault.empty()) {
      stop_ = {RunStatus::singular, fault, false};
    } else if (monitor_.sign_change()) {
      stop_ = {RunStatus::singular, "the determinant of the mass matrix changed its sign"};
    } else if (!monitor_.excess().empty()) {
      stop_ = {RunStatus::diverged, monitor_.excess()};
      summary_.past_deflection = monitor_.past_deflection();
    }
    return stop_.status == RunStatus::completed;
  }
  void passed(const EventTime& event) override {
    summary_.events.push_back(event);
    const auto of_that_name = [&](const RunEvent& e) { return e.name == event.name; };
    const auto watched = actions_.watched();
    const auto stated = std::find_if(watched.begin(), watched.end(), of_that_name);
    if (stated != watched.end() && stated->stops && !options_.past_stops) stopped_by_.push_back(event.name);
  }
  void acted(const State& before, const State& after) override { monitor_.pass_event(before, after); }
  void switched() override { ++summary_.switchings; }
  void jumped() override {
    monitor_.pass_instant();
    begin_watches();
  }
  void restarted() override { begin_watches(); }

 private:
  void begin_watches() {
    monitor_.begin_efforts(loop_.state());
    if (watch_ != nullptr) watch_->begin_at(loop_.state());
    if (validity_) validity_->begin_at(loop_.state());
  }
  /// Energy is looked at after each of the first steps, then after every fourth, whatever the output interval.
  static bool audited(std::size_t accepted) {
    constexpr std::size_t first = 256, interval = 4;
    return accepted <= first || accepted % interval == 0;
  }
  static constexpr std::size_t first_look = std::size_t{1} << 18U, look_at_later = std::size_t{1} << 24U;
  /// Whether the steps allowed are too few for the end at the mean of those made: looked at after 2¹⁸ of them, a second
  /// or so, and each time that they have doubled. After 2²⁴ at the mean of the later half: what moved at first and is
  /// held since, as by dry friction, crawls from there on. A phase that passes is shorter.
  [[nodiscard]] bool out_of_reach(const TwoHalves& steps) const { return steps_needed(steps) > 1; }
  /// The steps that lead to the end at that pace, in those allowed; 0 before they are looked at.
  [[nodiscard]] double steps_needed(const TwoHalves& steps) const {
    if (steps.made < first_look) return 0;
    const bool later = steps.made >= look_at_later;
    const auto made = static_cast<double>(later ? steps.later : steps.made);
    const double gained = steps.now - (later ? steps.middle : steps.begun);
    return (options_.end - steps.now) / gained * (made / static_cast<double>(options_.most_steps));
  }
  void look_at_pace(const TwoHalves& steps, const State& state) {
    if (std::string fault = creep_.fault(steps, state); !fault.empty()) {
      stop_ = {RunStatus::singular, std::move(fault)};
    } else if (options_.too_stiff && out_of_reach(steps)) {
      if (std::string why = options_.too_stiff(state); !why.empty())
        stop_ = {RunStatus::too_stiff, std::move(why), false};
    }
    // No phase that passes needs so many, and their cause may lie beyond the range of numbers.
    const double hopeless = steps.made < look_at_later ? 1e6 : 1e3;
    const double needed = steps_needed(steps), allowed = static_cast<double>(options_.most_steps);
    if (stop_.status == RunStatus::completed && options_.too_stiff && needed > hopeless)
      stop_ = {RunStatus::too_stiff,
               "at the pace of its steps so far the run would need " + brief(needed * allowed) + " of them where " +
                   brief(allowed) + " are allowed, and what is so fast cannot be told",
               false};
  }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  }

  void output_at(const State& state) {
    monitor_.show(state);
    motion_gap_.look(state);
    emitted_ = state.time;
    if (output_) output_(state);
  }

  void save() {
    Memory memory;
    remember(memory);
    options_.checkpoint({loop_.state(), loop_.stepper_memory(), memory.numbers()});
  }
  void restore(const Checkpoint& checkpoint) {
    if (options_.changing != nullptr) options_.changing->go_over(checkpoint.state.time);
    loop_.resume(checkpoint.state, checkpoint.stepper);
    Memory memory(checkpoint.watches);
    remember(memory);
    memory.finish();
  }
  void remember(Memory& memory) {
    monitor_.remember(memory);
    if (validity_) validity_->remember(memory);
    loop_.remember(memory);
    loops_.remember(memory);
    motion_gap_.remember(memory);
    if (watch_ != nullptr) watch_->remember(memory);
    if (options_.changing != nullptr) options_.changing->remember(memory);
    if (options_.remember) options_.remember(memory);
    memory(emitted_);
    halves_.remember(memory);
    double spent = summary_.cpu_seconds + thread_cpu_seconds() - cpu_began_;
    memory(spent);
    if (memory.reading()) summary_.cpu_seconds = spent;
    memory(summary_.switchings);
    std::size_t count = summary_.events.size();
    memory(count);
    summary_.events.resize(count);
    for (EventTime& e : summary_.events) {
      const auto named = [&](const RunEvent& event) { return event.name == e.name; };
      const auto watched = actions_.watched();
      auto index = std::find_if(watched.begin(), watched.end(), named) - watched.begin();
      memory(index);
      if (memory.reading()) {
        if (index >= std::ssize(watched))
          throw std::invalid_argument("what was saved names an event that there is not");
        e.name = watched[static_cast<std::size_t>(index)].name;
      }
      memory(e.time);
      memory(e.direction);
    }
  }

  const Model& model_;
  const EquationsOfMotion& equations_;
  const RunOptions& options_;
  const std::function<void(const State&)>& output_;
  StepWatch* watch_;  ///< null: there is none
  RunSummary& summary_;
  std::vector<double> hand_overs_;  ///< increasing
  EventActions actions_;
  Stepping loop_;
  Monitor monitor_;
  std::optional<ValidityWatch> validity_;  ///< nothing where nobody asks
  LoopWatch loops_;
  MotionGap motion_gap_;
  LaterHalf halves_;
  CreepWatch creep_;
  double emitted_ = 0;  ///< time of the last output
  Stop stop_;           ///< why this observer has ended the stepping
  std::vector<std::string> stopped_by_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  double cpu_began_ = thread_cpu_seconds();
};

/// The last state that can be trusted takes the place of the last one.
void go_back(Monitor& monitor, RunSummary& summary) {
  if (monitor.trusted().time >= summary.final.time) return;
  summary.final = monitor.trusted();
  monitor.forget_untrusted_peaks();
  summary.message +=
      " The last state that can be trusted, the final one of the results, is that at t = " + brief(summary.final.time) +
      " s; peaks are of the motion up to there.";
}

/// Looks at the mass matrix at the end of a run, and why a run that ended badly did.
MassMatrixHistory look_at_mass_matrix(const Run& run, const Model& model, const EquationsOfMotion& equations,
                                      const State& initial, const Stop& stop, bool own_energy, RunSummary& summary) {
  MassMatrixHistory history;
  if (equations.layout().speeds > largest_examined) return history;
  const std::optional<SignChange>& change = run.monitor().sign_change();
  if (change || stop.status != RunStatus::completed) {
    history = examine(equations, initial, summary.final, change);
    if (own_energy) compare_inertia(history);
    summary.conditioning = history.end;
  } else {
    history.last = equations.system(summary.final.time, summary.final.y);
    summary.conditioning = conditioning(history.last);
  }
  // Where a run has diverged nothing vibrates as it did on the way there.
  const State& trusted = run.monitor().trusted();
  const bool unsolved = stop.status == RunStatus::singular && tried_as_given(run.stepper()),
             gone = unsolved || stop.status == RunStatus::diverged;
  summary.fastest_mode = fastest_mode(model, gone ? equations.system(trusted.time, trusted.y) : history.last,
                                      closing_rows(equations, gone ? trusted.y : summary.final.y));
  // Next to a zero of det M vibrations are fast whatever the steps: those that are too long were so at the start.
  if (unsolved)
    summary.fastest_mode =
        std::min(summary.fastest_mode, fastest_mode(model, history.first, closing_rows(equations, initial.y)));
  return history;
}

/// Where steps that are given threw the state off, M cannot be solved there for no fault of its own; and of a state
/// that is nowhere near the model's it tells nothing.
void blame_steps(const Run& run, bool too_long, const MassMatrixHistory& history, double deflection_limit,
                 const RunSummary& summary, Stop& stop) {
  constexpr double nowhere_near = 1e3;  // of the deflections that a run goes on with
  const bool thrown = too_long && stop.status == RunStatus::singular && tried_as_given(run.stepper());
  if (thrown) stop.status = RunStatus::diverged;
  const auto beyond = [&](const auto& ratio) { return ratio.second > nowhere_near * deflection_limit; };
  const bool absurd = summary.past_deflection &&
                      std::any_of(summary.peak_deflection_ratio.begin(), summary.peak_deflection_ratio.end(), beyond);
  if ((thrown || absurd) && history.lost_definiteness()) stop.physical = false;
}

std::string message_of_completed(const Run& run, const Model& model, const RunSummary& summary) {
  std::string text;
  const auto add = [&text](const std::string& sentence) { text += (text.empty() ? "" : " ") + sentence; };
  if (const std::vector<std::string>& names = run.stopped_by(); !names.empty()) {
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "'" : ", '") + name + "'";
    add((names.size() > 1 ? "The events " : "The event ") + list +
        " ended the run at t = " + brief(summary.final.time) + " s.");
  }
  if (const std::string missed = note_on_missed_events(model, summary.final); !missed.empty()) add(missed);
  if (!summary.suspected_jumps.empty()) add(note_on_jumps(model, summary.suspected_jumps));
  for (const std::string& remark : remarks_of(run.stepper())) add("The integrator: " + remark + ".");
  if (const std::string given = note_on_given_steps(run.stepper(), summary.energy_scale); !given.empty()) add(given);
  if (const std::string closing = closing_text(run.equations(), run.stepper()); !closing.empty()) add(closing);
  return text;
}

}  // namespace

RunSummary simulate(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator,
                    const State& initial, const RunOptions& options, const std::function<void(const State&)>& output) {
  return simulate(model, equations, integrator, initial, options, output, nullptr);
}

RunSummary simulate(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator,
                    const State& initial, const RunOptions& options, const std::function<void(const State&)>& output,
                    StepWatch* watch, Attention attention) {
  if (!(options.end >= initial.time)) throw std::invalid_argument("the end lies before the initial time");
  if (!(options.output > 0)) throw std::invalid_argument("the output interval is not positive");
  const double began = thread_cpu_seconds();
  RunSummary summary;
  if (options.changing != nullptr) options.changing->go_over(initial.time);
  Run run(model, equations, integrator, initial, options, output, watch, attention, summary);
  Stop stop = run.to_end();
  run.finish(stop.status);
  summary.final = run.stepper().state();
  summary.reached = summary.final.time;
  summary.steps = run.stepper().statistics();
  MassMatrixHistory history;
  if (attention == Attention::whole || stop.status != RunStatus::completed || !surely_balanced(summary, options))
    history = look_at_mass_matrix(run, model, equations, initial, stop, options.own_energy, summary);
  const bool examined = equations.layout().speeds <= largest_examined;
  const double mean_step =
      (summary.reached - initial.time) / static_cast<double>(std::max<std::size_t>(summary.steps.accepted, 1));
  if (stop.status == RunStatus::completed) {
    summary.ended_by_event = !run.stopped_by().empty() && summary.reached < options.end;
    summary.message = message_of_completed(run, model, summary);
    const std::string imbalanced = run.monitor().greatest_speed() > options.least_speed
                                       ? imbalance(summary, options, integrator, mean_step)
                                       : std::string();
    run.motion_gap().tell(summary);
    for (const std::string& fault : {imbalanced, run.motion_gap().text()}) {
      if (fault.empty()) continue;
      stop.status = RunStatus::inaccurate;
      summary.message = fault + (summary.message.empty() ? "" : " ") + summary.message;
    }
  } else {
    summary.suspected_jumps.clear();  // the rejections before a bad end are that end
    const std::string too_long = steps_too_long(summary, integrator, mean_step);
    blame_steps(run, !too_long.empty(), history, options.deflection_limit, summary, stop);
    summary.message = explain(stop, summary.final.time, examined ? &history : nullptr, model.layout());
    if (stop.status == RunStatus::diverged)
      summary.message = too_long + summary.message + note_on_impulses(model, run.stepper().state());
  }
  if (stop.status != RunStatus::completed && stop.status != RunStatus::interrupted) go_back(run.monitor(), summary);
  summary.status = stop.status;
  summary.cpu_seconds += thread_cpu_seconds() - began;
  return summary;
}

}  // namespace withy
