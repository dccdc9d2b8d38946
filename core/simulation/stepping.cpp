#include "withy/core/simulation/stepping.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/given_steps.hpp"
#include "withy/core/plugin/plugin_call.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/same_instant.hpp"

namespace withy {

using Cause = SteppingEnd::Cause;

namespace {

bool has_given_steps(const Stepper& stepper) { return dynamic_cast<const GivenSteps*>(&stepper) != nullptr; }

}  // namespace

Stepping::Stepping(const Model& model, const EquationsOfMotion& equations, std::unique_ptr<Stepper> stepper,
                   const SteppingOptions& options)
    : stepper_(std::move(stepper)),
      clocks_(model, equations),
      jumps_(discontinuities(model)),
      zeros_(model, options.events, stepper_->state(),
             options.looks_over > 0 ? stepper_->state().time + options.looks_over : options.end,
             !has_given_steps(*stepper_)),
      actions_(options.actions),
      times_(stepper_->state().time, options.output, options.end),
      model_(model),
      courses_(model, stepper_->state().time, has_given_steps(*stepper_) ? stepper_->state().time : options.end),
      start_(stepper_->state().time),
      looks_over_(has_given_steps(*stepper_) || !TimeCourses::are_in(model) ? 0 : options.looks_over),
      looked_until_(looks_over_ > 0 ? start_ : std::numeric_limits<double>::infinity()),
      end_(options.end),
      sample_(stepper_->state()),
      shown_(sample_.y.size() == model.layout().size() ? model.layout().moving() : 0),
      check_inside_(sample_, shown_) {
  if (dynamic_cast<const ClosedLoops*>(&equations) != nullptr &&
      dynamic_cast<const ClosingStepper*>(stepper_.get()) == nullptr)
    throw std::invalid_argument(
        "the integrator cannot run closed loops (constraints): it does not close them at the end of each step, so that "
        "they would come apart. Use dopri5, dop853, rk4, rk4-adaptive, gauss or radau");
  clocks_.go_on_after(state().time);
  jumps_.insert(jumps_.end(), options.hand_overs.begin(), options.hand_overs.end());
  std::sort(jumps_.begin(), jumps_.end());
  jumps_.erase(std::unique(jumps_.begin(), jumps_.end()), jumps_.end());
}

SteppingEnd Stepping::run(SteppingObserver& observer) {
  FloatingPointGuard arithmetic;
  arithmetic_ = &arithmetic;
  observer_ = &observer;
  ended_ = {};
  if (!sound(state())) return ended_;
  if (actions_ != nullptr && same_instant(actions_->next(state()), state().time) && !act({})) return ended_;
  while (state().time < end_) {
    const auto jump = std::upper_bound(jumps_.begin(), jumps_.end(), state().time);
    const bool jumps = jump != jumps_.end() && *jump <= end_;
    const double landing = jumps ? *jump : end_;
    while (state().time < landing) {
      if (!to(std::min(landing, next_instant()), true)) return ended_;
      if (clocks_.due(state().time)) {
        if (!renew_clocks()) return ended_;
        if (!happened_.empty() && !act(std::vector<std::size_t>(happened_))) return ended_;
      }
      if (actions_ != nullptr && same_instant(actions_->next(state()), state().time) && !act({})) return ended_;
    }
    if (!jumps) continue;
    observer_->landed(state());
    plugin_call<IntegratorError>("does not begin anew", [&] { stepper_->restart(); });
    observer_->restarted();
  }
  return ended_;
}

bool Stepping::end(Cause cause) {
  ended_.cause = cause;
  return false;
}

double Stepping::next_instant() const {
  const double sample = clocks_.next(), event = actions_ == nullptr ? sample : actions_->next(state());
  return same_instant(sample, event) ? sample : std::min(sample, event);
}

/// Events happen at the present state, and others may be due: what they ask for is done. What passes its value because
/// of that happens at the same time.
bool Stepping::act(std::span<const std::size_t> happened) {
  happened_.assign(happened.begin(), happened.end());
  for (int round = 0;; ++round) {
    acted_on_ = sample_ = state();
    const EventActions::Done& done = actions_->act(sample_, happened_);
    for (const auto& [event, moved] : done.acted)
      observer_->passed({actions_->watched()[event].name, sample_.time, direction_of(event)});
    if (!done.evaluation.ok()) {
      ended_.step = {StepResult::Outcome::singular, done.evaluation.body};
      return end(Cause::failed);
    }
    if (done.crowded || round > most_zeros_at_once) return end(Cause::crowded);
    jump_to(sample_);
    observer_->acted(acted_on_, state());
    observer_->jumped();
    if (done.stops) return end(Cause::event);
    const std::vector<EventActions::Acted> acted = done.acted;
    if (!leap(acted)) return false;
    if (happened_.empty()) return true;
  }
}

/// Deals with what events have made pass its value. What an event's own actions do to its own number is no passage that
/// it waits for: it would act again and again.
bool Stepping::leap(const std::vector<EventActions::Acted>& acted) {
  handled_ = zeros_.leap(state());
  happened_.clear();
  sample_ = state();
  bool stops = false;
  const auto by_itself = [&](const Zero& zero) {
    return std::any_of(acted.begin(), acted.end(), [&](const EventActions::Acted& a) {
      return a.watched == zeros_.index(zero) && zeros_.is_due_to(a.moved, zero);
    });
  };
  for (const Zero& zero : handled_) {
    if (const auto load = zeros_.switching(zero.function)) {
      if (clocks_.renew(sample_, load->first, {load->second, zero.direction})) observer_->switched();
    } else if (const std::size_t event = zeros_.index(zero); !actions_->acts(event)) {
      note(zero);
      stops = stops || zeros_.event(zero.function).stops;
    } else if (!actions_->over(event, sample_) && !by_itself(zero)) {
      happened_.push_back(event);
    }
  }
  if (!handled_.empty()) jump_to(sample_);
  return !stops || end(Cause::event);
}

/// In which an event passes its value now; 0 where it acts for another reason.
int Stepping::direction_of(std::size_t event) const {
  if (std::find(happened_.begin(), happened_.end(), event) == happened_.end()) return 0;
  for (const Zero& zero : handled_)
    if (!zeros_.switching(zero.function) && zeros_.index(zero) == event) return zero.direction;
  return 0;
}

/// Whether a step is cut at a zero.
bool Stepping::changes_the_run(const Zero& zero) const {
  if (zeros_.acts(zero)) return true;
  return actions_ != nullptr && !zeros_.switching(zero.function) && actions_->acts(zeros_.index(zero));
}

/// Looks at formulas from the present time on, where they have been looked at up to there: wherever a simulation has
/// gone on from, at the same times.
void Stepping::look_ahead() {
  if (state().time < looked_until_) return;
  double count = std::floor((state().time - start_) / looks_over_);
  const auto end_of = [&](double k) { return start_ + (k + 1) * looks_over_; };
  while (end_of(count) <= state().time) ++count;
  courses_ = TimeCourses(model_, start_ + count * looks_over_, end_of(count));
  looked_until_ = end_of(count);
}

/// Whether no load has failed; the stepping has ended else.
bool Stepping::sound(const State& state) {
  ended_.reason = observer_->failure(clocks_, state);
  return ended_.reason.empty() || end(Cause::failed);
}

/// Renews discrete states by the clock. An event happens where a number that it watches jumps past its value with them.
bool Stepping::renew_clocks() {
  sample_ = state();
  observer_->renew(clocks_, sample_);
  if (!sound(sample_)) return false;
  clocks_.go_on_after(sample_.time);
  jump_to(sample_);
  handled_ = zeros_.leap(sample_);
  observer_->jumped();
  happened_.clear();
  for (const Zero& zero : handled_) {
    if (actions_ == nullptr || zeros_.switching(zero.function) || !actions_->acts(zeros_.index(zero))) continue;
    if (!actions_->over(zeros_.index(zero), sample_)) happened_.push_back(zeros_.index(zero));
  }
  return true;
}

/// One step. An integrator that stays where it is would be asked for ever, one that goes too far would pass what is to
/// happen there.
void Stepping::step_to(double limit) {
  const double from = state().time;
  const std::size_t made = stepper_->statistics().evaluations;
  ended_.step = plugin_call<IntegratorError>("does not step", [&] { return stepper_->step(limit); });
  step_evaluations_ += stepper_->statistics().evaluations - made;
  check_step(from, limit);
  if (ended_.step.outcome == StepResult::Outcome::ok && crawls(from, limit))
    ended_.step = {StepResult::Outcome::step_underflow};
}

void Stepping::check_step(double from, double limit) const {
  using enum StepResult::Outcome;
  if (state().y.size() != sample_.y.size())
    throw IntegratorError("does not step: it leaves " + std::to_string(state().y.size()) +
                          " numbers in the state where " + std::to_string(sample_.y.size()) + " are due");
  const StepResult::Outcome outcome = ended_.step.outcome;
  if (outcome != ok && outcome != nonfinite && outcome != singular && outcome != step_underflow)
    throw IntegratorError("does not step: it ends with an outcome that there is not, " +
                          std::to_string(static_cast<int>(outcome)));
  if (outcome != ok || (state().time > from && state().time <= limit)) return;
  throw IntegratorError(false_end(from, limit, state().time));
}

/// Whether step after step gains less than time resolves where it is to come to: none of them is an error, and all
/// together come nowhere.
bool Stepping::crawls(double from, double limit) {
  constexpr int many = 1 << 20;  // who looks at the pace knows more by then
  const double there = std::isfinite(limit) ? std::max(std::abs(from), std::abs(limit)) : std::abs(from);
  const bool below = state().time - from < std::numeric_limits<double>::epsilon() * there;
  steps_below_resolution_ = below ? steps_below_resolution_ + 1 : 0;
  return steps_below_resolution_ > many;
}

void Stepping::jump_to(const State& state) {
  plugin_call<IntegratorError>("does not go to another state", [&] { stepper_->jump(state); });
  if (const std::string why = false_jump(state, stepper_->state()); !why.empty()) throw IntegratorError(why);
}

/// Steps to a time; false where stepping ends before. Not watching: a step taken back is made again to end at a zero,
/// and nothing comes between.
bool Stepping::to(double limit, bool watching) {
  while (state().time < limit) {
    if (watching) {
      if (!observer_->before_step(*stepper_)) return end(Cause::stopped);
      if (!zeros_.empty()) before_ = state();
    }
    look_ahead();
    check_inside_.begin(state());
    step_to(std::min({limit, looked_until_, courses_.latest_end(state().time), end_beyond_kink()}));
    check_arithmetic();
    if (ended_.step.outcome != StepResult::Outcome::ok) return sound(state()) && end(Cause::failed);
    if (watching && !zeros_.empty()) {
      handled_ = zeros_.find(*stepper_, before_, [this](const Zero& z) { return changes_the_run(z); });
      if (!handled_.empty()) check_inside_(*stepper_);
      const bool cut = std::any_of(handled_.begin(), handled_.end(), [&](const Zero& z) { return changes_the_run(z); });
      if (!act_on_zeros()) return false;
      if (cut && next_instant() < limit) return true;  // an event has made another due
      if (cut) continue;
    }
    if (!after_step() || !sound(state())) return false;
  }
  return true;
}

/// A load, motion, formulation or integrator may round otherwise from its first call on: what it and all others have
/// computed since is not what the same input gives elsewhere.
void Stepping::check_arithmetic() {
  if (!has_changed_arithmetic()) return arithmetic_->check("a plugin of this scene");
  const std::string changed = take_changed_arithmetic();
  arithmetic_->restore();
  throw PluginError("a plugin of this scene changes " + changed + " for the whole program: no result can be trusted");
}

bool Stepping::after_step() {
  const double time = state().time;
  const bool outputs = times_.due(time);
  if (outputs && times_.next() < time) check_inside_(*stepper_);
  for (; times_.due(time); times_.pass()) {
    sample_.time = times_.next();
    interpolate_step(*stepper_, sample_.time, sample_.y);
    if (!sample_is_known()) return end(Cause::unknown_inside);
    sample_.time = from_jump_on(jumps_, sample_.time);
    if (!observer_->output(sample_)) return end(Cause::stopped);
  }
  return observer_->after_step(*stepper_, outputs) || end(Cause::stopped);
}

/// Whether an output within the last step is finite, or is not because the step itself has ended so.
bool Stepping::sample_is_known() const {
  const auto finite = [this](const State& s) {
    double nothing = 0;  // or NaN
    for (std::size_t i = 0; i < shown_; ++i) nothing += 0.0 * s.y[i];
    return nothing == 0;
  };
  return finite(sample_) || !finite(state());
}

void Stepping::note(const Zero& zero) {
  const RunEvent& event = zeros_.event(zero.function);
  observer_->passed({event.name, zero.time, zero.direction});
}

/// How far apart zeros of one step may be and still be at one time: what interpolation and root finding leave.
double Stepping::coincidence(const Zero& zero) const {
  return 64 * std::numeric_limits<double>::epsilon() * std::abs(zero.time) + 1e-9 * (state().time - before_.time);
}

/// Deals with the zeros of the last step; false where stepping ends. Where one of them changes the run the step is cut
/// there.
bool Stepping::act_on_zeros() {
  const auto acts = [&](const Zero& z) { return changes_the_run(z); };
  const auto first = std::find_if(handled_.begin(), handled_.end(), acts);
  if (first == handled_.end()) {
    for (const Zero& zero : handled_) note(zero);
    zeros_.pass();
    return true;
  }
  const double apart = coincidence(*first), at = first->time;
  if (zeros_.is_kink(first->function)) {
    const auto back =
        std::find_if(first + 1, handled_.end(), [&](const Zero& z) { return z.function == first->function; });
    beyond_kink_ = at + ((back != handled_.end() ? back->time : state().time) - at) / 4;
  }
  const auto at_once = [&](const Zero& z) { return z.time >= at - apart; };
  const auto beyond = [&](const Zero& z) { return z.time > at + apart; };
  // Those beyond the cut are found again, or never happen.
  handled_.erase(std::find_if(first, handled_.end(), beyond), handled_.end());
  const auto here = std::find_if(handled_.begin(), handled_.end(), at_once);
  std::for_each(handled_.begin(), here, [&](const Zero& z) { note(z); });
  return cut_at(at, static_cast<std::size_t>(here - handled_.begin()));
}

/// The step after a kink has its stages beyond it, and not past the way back again.
double Stepping::end_beyond_kink() const {
  return state().time < beyond_kink_ ? beyond_kink_ : std::numeric_limits<double>::infinity();
}

/// Takes the last step back, steps to the time of a zero and does there what is to be done: of the zeros handled the
/// first `noted` have been told already.
bool Stepping::cut_at(double time, std::size_t noted) {
  if (time - last_zero_ <= 16 * std::numeric_limits<double>::epsilon() * std::abs(time)) {
    if (++zeros_at_once_ > most_zeros_at_once) return end(Cause::crowded);
  } else {
    zeros_at_once_ = 0;
  }
  last_zero_ = time;
  jump_to(before_);
  if (!to(time, false)) return false;
  const std::vector<Zero>& others = zeros_.land(before_, state(), handled_);
  handled_.insert(handled_.end(), others.begin(), others.end());
  sample_ = state();
  bool stops = false;
  happened_.clear();
  for (std::size_t i = noted; i < handled_.size(); ++i) {
    Zero& zero = handled_[i];
    zero.time = std::min(zero.time, sample_.time);
    if (const auto load = zeros_.switching(zero.function)) {
      if (clocks_.renew(sample_, load->first, {load->second, zero.direction})) observer_->switched();
    } else if (zeros_.is_kink(zero.function)) {
      continue;  // the next step begins at it
    } else if (actions_ != nullptr && actions_->acts(zeros_.index(zero))) {
      happened_.push_back(zeros_.index(zero));
    } else {
      note(zero);
      stops = stops || zeros_.event(zero.function).stops;
    }
  }
  jump_to(sample_);
  observer_->jumped();
  if (!happened_.empty() && !act(std::vector<std::size_t>(happened_))) return false;
  return !stops || end(Cause::event);
}

void Stepping::resume(const State& state, std::span<const double> memory) {
  if (const std::string why = clocks_.refusal(state); !why.empty()) throw std::invalid_argument(why);
  clocks_.forget();
  plugin_call("the integrator does not go on from what was saved", [&] { stepper_->resume(state, memory); });
  clocks_.go_on_after(state.time);
}

std::vector<double> Stepping::stepper_memory() const {
  return plugin_call<IntegratorError>("does not say what it remembers", [&] { return stepper_->memory(); });
}

void Stepping::remember(Memory& memory) {
  zeros_.remember(memory);
  times_.remember(memory);
  memory(last_zero_);
  memory(beyond_kink_);
  memory(zeros_at_once_);
  memory(step_evaluations_);
  // Formulas are looked at in windows from the start on, whoever goes on.
  memory(start_);
  memory(looks_over_);
  if (memory.reading()) looked_until_ = looks_over_ > 0 ? state().time : std::numeric_limits<double>::infinity();
  // Where an event has ended the run what the clocks have to do at that instant is still to come.
  bool due = clocks_.due(state().time);
  memory(due);
  if (memory.reading() && due) clocks_.go_on_with(state().time);
}

}  // namespace withy
