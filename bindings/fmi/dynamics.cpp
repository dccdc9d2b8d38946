#include "withy/bindings/fmi/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "withy/core/model/held_numbers.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/plugin/just_before.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/run_times.hpp"

namespace withy::fmi {
namespace {

/// How far [rad, m, …] beyond its zero a switching function is where the indicator of it is zero: hosts halt at zeros
/// to rounding, on either side, and the functions have to have changed their signs there.
constexpr double beyond_zero = 1e-11;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The scene's initial state at another time: what motions prescribe is where it then is.
State initial_at(const study::Prepared& prepared, double t) {
  State state = prepared.scene.initial;
  if (t == state.time) return state;
  state.time = t;
  prepared.model().prescribe(state);
  return state;
}

std::vector<bool> driven_states(const Model& model, std::size_t states) {
  std::vector<bool> driven(states, false);
  const Layout& layout = model.layout();
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    if (!model.driven(h)) continue;
    const Slot& slot = layout.hinges[h];
    for (std::size_t i = 0; i < slot.positions; ++i) driven[slot.position + i] = true;
    for (std::size_t i = 0; i < slot.speeds; ++i) driven[layout.positions + slot.speed + i] = true;
  }
  return driven;
}

double rounding(double t) { return 1e-12 * std::max(1.0, std::abs(t)); }

/// Which events of the scene watch a number, among EventActions::watched.
std::vector<std::size_t> watching(const Scene& scene) {
  std::vector<std::size_t> all(scene.events.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const EventBook book(*scene.model);
  for (std::size_t i = 0; book.any() && i < book.plan().events.size(); ++i)
    if (book.plan().events[i].when == ActingEvent::When::passes) all.push_back(scene.events.size() + i);
  return all;
}

int sign(double x) { return (x > 0) - (x < 0); }

}  // namespace

Dynamics::Dynamics(std::shared_ptr<const study::Prepared> prepared, double t)
    : prepared_(std::move(prepared)),
      equations_(*prepared_->equations),
      states_(prepared_->model().layout().moving()),
      quaternions_(prepared_->model().layout().positions != prepared_->model().layout().speeds),
      state_(initial_at(*prepared_, t)),
      seen_(state_),
      work_(equations_.make_work()),
      table_(prepared_->model(), equations_, prepared_->scene.outputs),
      driven_(driven_states(prepared_->model(), states_)),
      y_dot_(state_.y.size()),
      jacobian_(states_ * states_),
      clocks_(prepared_->model(), equations_),
      events_(prepared_->model(), equations_, prepared_->scene.events),
      looked_for_(watching(prepared_->scene)),
      zeros_(prepared_->model(), prepared_->scene.events, state_),
      jumps_(discontinuities(prepared_->model())),
      signs_(indicator_count(prepared_->scene)),
      values_(signs_.size()) {
  begin();
}

State Dynamics::initial() const { return initial_at(*prepared_, state_.time); }

void Dynamics::changed() {
  seen_is_now_ = derivatives_are_now_ = jacobian_is_now_ = false;
  row_ = nullptr;
}

void Dynamics::set_time(double t) {
  if (t == state_.time) return;
  state_.time = t;
  changed();
}

void Dynamics::set_moving(std::span<const double> y) {
  std::copy(y.begin(), y.end(), state_.y.begin());
  changed();
}

void Dynamics::set_state(std::size_t index, double value) {
  state_.y[index] = value;
  changed();
}

void Dynamics::begin_loads(std::span<const std::size_t> states) {
  if (states.empty()) return;
  State begun = seen();
  model().begin_continuous(begun);
  for (const std::size_t i : states) state_.y[i] = begun.y[i];
  changed();
}

void Dynamics::show(const State& state) {
  state_ = state;
  jump_ = infinity;
  changed();
}

bool Dynamics::is_reached(std::size_t load) const {
  const HostedMotion* motion = hosted_motion(*model().loads()[load].load);
  return motion != nullptr && !motion->jumps();
}

double Dynamics::input(std::size_t load) const {
  const LoadNode& node = model().loads()[load];
  return node.load->input()->value(state_.time, node.discrete(std::span(state_.y)));
}

void Dynamics::set_input(std::size_t load, double value) {
  const LoadNode& node = model().loads()[load];
  if (is_reached(load)) return;
  node.load->input()->set(state_.time, state_.time, value, node.discrete(std::span(state_.y)));
  changed();
}

/// The state with its quaternions scaled to unit length and, where the next jump has not been dealt with, a time before
/// it.
const State& Dynamics::seen() {
  if (!quaternions_ && state_.time < jump_) return state_;
  if (!seen_is_now_) {
    seen_ = state_;
    if (quaternions_) equations_.normalize(seen_.y);
    seen_.time = std::min(state_.time, just_before(jump_, -infinity));
    seen_is_now_ = true;
  }
  return seen_;
}

Evaluation Dynamics::evaluate(const State& state) { return equations_.derivatives(state.time, state.y, y_dot_, work_); }

std::span<const double> Dynamics::derivatives() {
  if (!derivatives_are_now_) {
    const Evaluation evaluation = evaluate(seen());
    if (!evaluation.ok())
      throw Discarded("t = " + brief(state_.time) + " s: " +
                      (evaluation.outcome == Evaluation::Outcome::singular ? "the mass matrix cannot be solved"
                                                                           : "the derivatives are not finite") +
                      (evaluation.body < 0
                           ? std::string()
                           : " at body '" + model().bodies()[static_cast<std::size_t>(evaluation.body)].name + "'"));
    derivatives_are_now_ = true;
  }
  return std::span(y_dot_).first(states_);
}

double Dynamics::output(std::size_t column) {
  if (row_ == nullptr) row_ = &table_.row(seen());
  const double value = (*row_)[column];
  if (!std::isfinite(value))
    throw Discarded("t = " + brief(state_.time) + " s: output '" + table_.columns()[column].name + "' is not finite");
  return value;
}

std::span<const double> Dynamics::event_indicators() {
  read_switches();
  for (std::size_t f = 0; f < signs_.size(); ++f) values_[f] += beyond_zero * signs_[f];
  return values_;
}

void Dynamics::read_switches() {
  const State& state = seen();
  const Layout& layout = model().layout();
  const std::span<const double> y(state.y);
  std::size_t at = 0;
  for (const LoadSlot& slot : layout.discrete_slots) {
    const DiscretePart& part = *model().loads()[slot.load].load->discrete();
    if (part.switches() > 0)
      part.switching(state.time, y.first(layout.positions), y.subspan(layout.positions, layout.speeds),
                     y.subspan(slot.first, slot.count), std::span(values_).subspan(at, part.switches()));
    at += part.switches();
  }
  for (const std::size_t event : looked_for_) values_[at++] = events_.watched()[event].function(state.time, y);
  // What does not look has passed nothing when it looks again.
  for (std::size_t f = 0; f < signs_.size(); ++f)
    if (is_over(f)) signs_[f] = 0;
}

/// Whether an indicator is that of an event that has happened, once or for now.
bool Dynamics::is_over(std::size_t indicator) const {
  const std::size_t switches = signs_.size() - looked_for_.size();
  if (indicator < switches) return false;
  const std::size_t event = looked_for_[indicator - switches];
  return events_.acts(event) && events_.over(event, state_);
}

/// What is due at the state's time has been dealt with: the next instant. A host lands up to rounding of its own.
double Dynamics::next_instant() {
  const auto jump = std::upper_bound(jumps_.begin(), jumps_.end(), state_.time + rounding(state_.time));
  jump_ = jump == jumps_.end() ? infinity : *jump;
  seen_is_now_ = false;
  event_due_ = events_.next(state_);
  return std::min({jump_, clocks_.next(), event_due_});
}

State Dynamics::start() const {
  State state = state_;
  for (const LoadNode& load : model().loads()) {
    if (load.load->input() != nullptr) continue;
    const std::span<const double> first = load.discrete(std::span(prepared_->scene.initial.y));
    std::copy(first.begin(), first.end(), load.discrete(std::span(state.y)).begin());
  }
  if (const auto begun = place_of_begun(model())) state.y[*begun] = prepared_->scene.initial.y[*begun];
  return state;
}

EventUpdate Dynamics::begin() {
  state_ = start();
  clocks_.begin(state_);
  const double next = next_instant();
  changed();
  read_switches();
  std::transform(values_.begin(), values_.end(), signs_.begin(), sign);
  return {false, false, next};
}

/// Acts on the indicators that have changed their signs. \returns whether a load has switched
bool Dynamics::switch_where_passed(EventUpdate& update) {
  bool switched = false;
  std::vector<std::size_t> happened;
  read_switches();
  for (std::size_t f = 0; f < signs_.size(); ++f) {
    const int now = sign(values_[f]);
    if (now == 0 || now == signs_[f]) continue;
    const bool passed = signs_[f] != 0;  // else it began on its zero
    signs_[f] = now;
    if (!passed) continue;
    if (const auto load = zeros_.switching(f)) {
      clocks_.renew(state_, load->first, {load->second, now});
      switched = true;
      changed();
    } else {
      const std::size_t index = looked_for_[f + looked_for_.size() - signs_.size()];
      const RunEvent& event = events_.watched()[index];
      if (event.direction != 0 && event.direction != now) continue;
      if (events_.acts(index))
        happened.push_back(index);
      else
        update.terminate = update.terminate || event.stops;
    }
  }
  if (!happened.empty()) happen(happened, update);
  return switched;
}

/// Notes that events happen now, and what comes after them.
void Dynamics::happen(std::span<const std::size_t> events, EventUpdate& update) {
  const EventActions::Done& done = events_.act(state_, events);
  if (done.crowded)
    throw Discarded("t = " + brief(state_.time) + " s: events follow each other without time between them");
  update.terminate = update.terminate || done.stops;
  changed();
}

/// The same of those that happen at a time, whether or not a host lands on it to rounding.
void Dynamics::happen_where_due(EventUpdate& update) {
  const double now = state_.time;
  while (event_due_ <= now + rounding(now)) {
    state_.time = event_due_;
    happen({}, update);
    event_due_ = events_.next(state_);
  }
  state_.time = now;
}

EventUpdate Dynamics::update_discrete() {
  EventUpdate update;
  // A load is told the instant itself, wherever a host lands.
  const double now = state_.time, due = clocks_.next();
  if (due <= now + rounding(now)) {
    state_.time = due;
    clocks_.renew(state_);
    clocks_.go_on_after(std::max(now, due));
    state_.time = now;
    changed();
  }
  happen_where_due(update);
  update.next = next_instant();
  changed();
  update.again = switch_where_passed(update);
  update.next = next_instant();  // of what has happened just now, too
  return update;
}

void Dynamics::remember(Memory& memory) {
  memory(state_.time);
  memory(state_.y);
  memory(signs_);
  double instant = clocks_.next();
  memory(instant);
  memory(jump_);
  memory(event_due_);
  if (!memory.reading()) return;
  // Clocks stand before their next instant, also where the state has passed it without an update.
  if (std::isfinite(instant)) clocks_.go_on_with(instant);
  changed();
}

}  // namespace withy::fmi
