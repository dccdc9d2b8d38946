#include "withy/core/simulation/session.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/integrator_call.hpp"

namespace withy {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

const InputPort& port_of(const Model& model, std::size_t load) { return *model.loads()[load].load->input(); }

}  // namespace

Session::Session(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator,
                 const State& initial, SessionOptions options)
    : model_(model),
      equations_(equations),
      options_(std::move(options)),
      initial_(begun(model, equations, initial)),
      actions_(model, equations, options_.events),
      loop_(model, equations, start_stepper(integrator, equations, initial_),
            {.end = initial.time,
             .output = infinity,
             .events = actions_.watched(),
             .actions = &actions_,
             .looks_over = options_.looks_over}),
      monitor_(model, equations, loop_.state(), options_.deflection_limit, infinity, nullptr, summary_),
      loops_(equations, loop_.state()),
      halves_(initial_.time),
      creep_(equations, initial_, options_.own_energy),
      with_inputs_(loop_.state()) {
  for (std::size_t l = 0; l < model.loads().size(); ++l)
    if (model.loads()[l].load->input() != nullptr) {
      const HostedMotion* motion = hosted_motion(*model.loads()[l].load);
      settings_.push_back({.load = l, .rests = motion != nullptr && !motion->jumps()});
    }
}

const Session::Setting& Session::setting(std::size_t load) const {
  const auto found = std::find_if(settings_.begin(), settings_.end(), [&](const Setting& s) { return s.load == load; });
  if (found == settings_.end()) throw std::out_of_range("the load is no input");
  return *found;
}

double Session::input(std::size_t load) const {
  const Setting& s = setting(load);
  if (s.waiting) return s.value;
  return port_of(model_, load).value(state().time, model_.loads()[load].discrete(std::span(state().y)));
}

void Session::set_input(std::size_t load, double value) {
  if (!std::isfinite(value))
    throw std::invalid_argument("input '" + model_.loads()[load].name + "': got " + brief(value) +
                                "; need a finite number");
  auto& s = const_cast<Setting&>(setting(load));
  s.waiting = true;
  s.value = value;
}

/// Copies the state for what is to be set in it; whether lines end at its time.
bool Session::end_lines() {
  const double now = state().time;
  bool ended = false;
  with_inputs_ = state();
  for (const Setting& s : settings_) {
    if (s.reached != now) continue;
    ended = true;
    const auto held = model_.loads()[s.load].discrete(std::span(with_inputs_.y));
    if (s.rests && !s.waiting) port_of(model_, s.load).set(now, now, 0, held);
  }
  return ended;
}

/// Puts what is waiting into the state, for a step to t. Values that stay what they are change nothing.
void Session::apply_settings(double t) {
  const double now = state().time;
  bool changed = end_lines();
  for (Setting& s : settings_) {
    if (!s.waiting) continue;
    s.waiting = false;
    const InputPort& port = port_of(model_, s.load);
    const LoadNode& load = model_.loads()[s.load];
    const auto held = load.discrete(std::span(state().y));
    if (!s.rests && port.is_set(held) && port.value(now, held) == s.value && port.value(t, held) == s.value) continue;
    changed = true;
    port.set(now, t, s.value, load.discrete(std::span(with_inputs_.y)));
    if (port.interpolates()) s.reached = t;
  }
  if (changed) loop_.replace(with_inputs_);
}

SessionEnd Session::advance(double t, bool halt) {
  if (!std::isfinite(t)) throw std::invalid_argument("the time " + brief(t) + " s is no time; need a finite number");
  if (t < state().time)
    throw std::invalid_argument("the time " + brief(t) + " s lies before the present one, " + brief(state().time) +
                                " s");
  events_.clear();
  if (ended_) return *ended_;
  halts_ = halt;
  if (t == state().time) return {RunStatus::completed, {}, true};
  apply_settings(t);
  while (true) {
    // Lines that began in an advance which was halted end on the way.
    double next = t;
    for (const Setting& s : settings_)
      if (s.reached > state().time) next = std::min(next, s.reached);
    SessionEnd end = go(next);
    if (end.halted) end.reached = state().time == t;  // it may have been the end of a line alone
    if (!end.reached || end.halted || next == t) return end;
    end_lines();
    loop_.replace(with_inputs_);
  }
}

SessionEnd Session::go(double t) {
  loop_.move_end(t);
  while (true) {
    stop_ = {};
    const SteppingEnd end = loop_.run(*this);
    if (end.cause == SteppingEnd::Cause::reached) return {RunStatus::completed, {}, true};
    if (end.cause == SteppingEnd::Cause::event) {
      if (halts_) return {RunStatus::completed, {}, state().time == t, true};
      continue;
    }
    if (end.cause != SteppingEnd::Cause::stopped) stop_ = stop_of(end, model_, equations_, state(), stepper());
    return bad_end(stop_);
  }
}

SessionEnd Session::bad_end(Stop stop) {
  if (stop.status == RunStatus::interrupted) return {stop.status, "interrupted", false};
  const bool examined = model_.layout().speeds <= largest_examined;
  MassMatrixHistory history =
      examined ? examine(equations_, initial_, state(), monitor_.sign_change()) : MassMatrixHistory{};
  if (examined && options_.own_energy) compare_inertia(history);
  std::string message = explain(stop, state().time, examined ? &history : nullptr, model_.layout());
  ended_ = {stop.status, std::move(message), false};
  return *ended_;
}

bool Session::before_step(const Stepper& stepper) {
  if (options_.interrupted && options_.interrupted()) {
    stop_ = {RunStatus::interrupted, "interrupted", false};
  } else if (const std::optional<TwoHalves> halves = halves_.look(stepper)) {
    if (std::string why = creep_.fault(*halves, stepper.state()); !why.empty())
      stop_ = {RunStatus::singular, std::move(why)};
  }
  return stop_.status == RunStatus::completed;
}

bool Session::output(const State& /*state*/) { return true; }

bool Session::after_step(const Stepper& stepper, bool /*outputs*/) {
  monitor_.observe(stepper);
  monitor_.audit_mass_matrix(stepper.state(), stepper.statistics().determinant_sign);
  if (const std::string fault = loops_.fault(stepper); !fault.empty()) {
    stop_ = {RunStatus::singular, fault, false};
  } else if (monitor_.sign_change()) {
    stop_ = {RunStatus::singular, "the determinant of the mass matrix changed its sign"};
  } else if (!monitor_.excess().empty()) {
    stop_ = {RunStatus::diverged, monitor_.excess()};
  } else if (const std::string number = nonfinite_number(model_.layout(), stepper.state()); !number.empty()) {
    stop_ = {RunStatus::diverged, "the state is not finite: " + number, false};
  }
  return stop_.status == RunStatus::completed;
}

void Session::passed(const EventTime& event) { events_.push_back(event); }

void Session::acted(const State& before, const State& after) { monitor_.pass_event(before, after); }

void Session::remember(Memory& memory) {
  monitor_.remember(memory);
  loop_.remember(memory);
  loops_.remember(memory);
  halves_.remember(memory);
  for (Setting& s : settings_) {
    memory(s.waiting);
    memory(s.value);
    memory(s.reached);
  }
}

Checkpoint Session::snapshot() {
  if (ended_) throw std::logic_error("the simulation has come to its end: from there nothing goes on");
  Memory memory;
  remember(memory);
  return {state(), loop_.stepper_memory(), memory.numbers()};
}

void Session::go_on_from(const Checkpoint& snapshot) {
  if (snapshot.state.y.size() != equations_.size())
    throw std::invalid_argument("the snapshot is of another scene: its state has " +
                                std::to_string(snapshot.state.y.size()) + " numbers, this one's " +
                                std::to_string(equations_.size()));
  loop_.resume(snapshot.state, snapshot.stepper);
  Memory memory(snapshot.watches);
  remember(memory);
  memory.finish();
  events_.clear();
}

void Session::restore(const Checkpoint& snapshot) {
  const std::optional<SessionEnd> ended = std::exchange(ended_, std::nullopt);
  const Checkpoint before = this->snapshot();
  try {
    go_on_from(snapshot);
    monitor_.forget_bad_end();
  } catch (...) {
    go_on_from(before);
    ended_ = ended;
    throw;
  }
}

}  // namespace withy
