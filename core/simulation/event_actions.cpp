#include "withy/core/simulation/event_actions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "withy/core/model/switched_load.hpp"
#include "withy/core/plugin/forward_dynamics.hpp"
#include "withy/core/simulation/same_instant.hpp"

namespace withy {

EventActions::EventActions(const Model& model, const EquationsOfMotion& equations, std::span<const RunEvent> plain)
    : model_(model),
      equations_(equations),
      book_(model),
      plain_(plain.size()),
      watched_(plain.begin(), plain.end()),
      work_(book_.any() ? equations.make_work() : Work(0)),
      at_rest_(equations.size()),
      base_(model.layout().speeds) {
  if (!book_.any()) return;
  const EventPlan& plan = book_.plan();
  if (!plan.sensors.empty()) {
    reader_ = std::make_unique<SensorReader>(plan.sensors, equations);
    readings_.resize(reader_->columns().size());
  }
  seen_ = equations.make_observation();
  renewal_ = std::make_unique<Renewal>(model, equations);
  for (std::size_t i = 0; i < plan.events.size(); ++i) {
    const ActingEvent& event = plan.events[i];
    watched_.push_back({event.name,
                        [this, &event, i](double t, std::span<const double> y) {
                          // Zero has no sign: an event that does not look passes nothing, then or when it looks again.
                          return event.when != ActingEvent::When::passes || over_at(i, y)
                                     ? 0.0
                                     : value(event, t, y) - event.value;
                        },
                        event.direction, event.stops,
                        [this, &event, i](std::span<const double> y) {
                          return event.when == ActingEvent::When::passes && !over_at(i, y);
                        }});
  }
}

double EventActions::value(const ActingEvent& event, double t, std::span<const double> y) {
  if (event.element >= 0) return y[static_cast<std::size_t>(event.element)];
  if (read_.time != t || !std::equal(y.begin(), y.end(), read_.y.begin(), read_.y.end())) {
    read_.time = t;
    read_.y.assign(y.begin(), y.end());
    readable_ = reader_->read(read_, readings_);
  }
  // Without finite accelerations there is no number; steps fail there and say why.
  return readable_ ? readings_[event.column] : event.value;
}

bool EventActions::over_at(std::size_t event, std::span<const double> y) const {
  const EventNumbers n = book_.numbers(y, event);
  return n.waiting > 0 || (n.happened > 0 && !book_.plan().events[event].repeats);
}

bool EventActions::over(std::size_t watched, const State& state) const { return over_at(watched - plain_, state.y); }

double EventActions::next(const State& state) const {
  double first = std::numeric_limits<double>::infinity();
  if (!book_.any()) return first;
  for (std::size_t i = 0; i < book_.plan().events.size(); ++i) {
    const EventNumbers n = book_.numbers(state.y, i);
    if (n.waiting > 0 && (n.due >= state.time || same_instant(n.due, state.time))) first = std::min(first, n.due);
  }
  return first;
}

const EventActions::Done& EventActions::act(State& state, std::span<const std::size_t> happened) {
  done_ = {};
  const auto& events = book_.plan().events;
  const auto wait = [&](std::size_t i) {
    EventNumbers n = book_.numbers(state.y, i);
    n.waiting = 1;
    n.due = state.time + events[i].delay;
    book_.set_numbers(state.y, i, n);
  };
  for (const std::size_t w : happened) wait(w - plain_);
  // Each round does what is due, in the order of the file; what waits for one of them may be due in the next.
  const std::size_t most_rounds = events.size() + 1;
  for (std::size_t round = 0;; ++round) {
    const std::size_t before = done_.acted.size();
    for (std::size_t i = 0; i < events.size(); ++i) {
      EventNumbers n = book_.numbers(state.y, i);
      if (n.waiting == 0 || !same_instant(n.due, state.time)) continue;
      if (round == most_rounds) {
        done_.crowded = true;
        return done_;
      }
      n.waiting = n.due = 0;
      n.happened += 1;
      n.last = state.time;
      book_.set_numbers(state.y, i, n);
      double moved = 0;
      if (!perform_and_measure(i, state, moved)) return done_;
      done_.acted.push_back({plain_ + i, moved});
      done_.stops = done_.stops || events[i].stops;
      for (std::size_t k = 0; k < events.size(); ++k)
        if (events[k].when == ActingEvent::When::after && events[k].after == i && !over_at(k, state.y)) wait(k);
    }
    if (done_.acted.size() == before) return done_;
  }
}

/// As `perform`; sets by what that has moved the event's own number.
bool EventActions::perform_and_measure(std::size_t event, State& state, double& moved) {
  const ActingEvent& acting = book_.plan().events[event];
  if (acting.actions.empty() || acting.when != ActingEvent::When::passes || over_at(event, state.y))
    return perform(event, state);
  const double before = value(acting, state.time, state.y);
  if (!perform(event, state)) return false;
  moved = value(acting, state.time, state.y) - before;
  return true;
}

/// Does what an event asks for; false where the mass matrix cannot be solved.
bool EventActions::perform(std::size_t event, State& state) {
  using Kind = EventAction::Kind;
  const EventPlan& plan = book_.plan();
  const ActingEvent& acting = plan.events[event];
  // All at once: the plan knows what is locked when an event has done everything, not what would be in between.
  book_.set_configuration(state.y, plan.configuration(acting.leaves_locked(book_.locked(state.y))));
  bool locks = false;
  for (const EventAction& action : acting.actions) {
    if (action.kind == Kind::form) change_form(state, action);
    locks = locks || action.kind == Kind::lock;
  }
  if (!locks) return true;
  const auto kinetic = [&] {
    seen_->observe(state.y);
    return seen_->energies().kinetic;
  };
  const double before = kinetic();
  done_.evaluation = settle(state);
  if (!done_.evaluation.ok()) return false;
  const double loss = before - kinetic();
  // Impulses do work, too: with it energy and work balance over the event.
  state.y.back() -= loss;
  EventNumbers n = book_.numbers(state.y, event);
  n.loss += loss;
  book_.set_numbers(state.y, event, n);
  return true;
}

void EventActions::change_form(State& state, const EventAction& action) {
  const LoadNode& node = model_.loads()[action.index];
  double& form = state.y[SwitchedLoad::place_of_form(node.slot)];
  const bool was_off = form == SwitchedLoad::off;
  renewal_->at(state);  // what it is to measure is as it was while it was off
  form = action.form;
  if (!was_off || form == SwitchedLoad::off) return;
  // What has stood still begins anew.
  const Layout& layout = model_.layout();
  std::vector<double> scratch(model_.load_scratch());
  (*renewal_)(state, node.slot, {.begins = true});
  std::vector<double> begun(node.continuous_slot.count);
  node.continuous->begin(node.view(state.time, state.y, layout, scratch), begun);
  std::copy(begun.begin(), begun.end(), state.y.begin() + static_cast<std::ptrdiff_t>(node.continuous_slot.first));
}

/// The accelerations, at rest, that come from those of driven speeds and from efforts on the others, without weight
/// and stiffness. They are linear in what is given: it is scaled up until rounding of the rest does not matter.
void EventActions::respond(std::span<const double> y, std::span<const double> driven, std::span<const double> efforts,
                           std::span<double> response) {
  const auto* forward = dynamic_cast<const ForwardDynamics*>(&equations_);
  if (forward == nullptr) throw std::logic_error("events lock hinges of equations without forward dynamics");
  constexpr double scale = 0x1p40;
  std::vector<double> none(base_.size()), scaled(base_.size());
  std::fill(base_.begin(), base_.end(), 0.0);
  responded_ = forward->forward_dynamics(y, none, base_, work_);
  if (!responded_.ok()) return;
  for (std::size_t i = 0; i < base_.size(); ++i) {
    scaled[i] = scale * efforts[i];
    response[i] = scale * driven[i];
  }
  responded_ = forward->forward_dynamics(y, scaled, response, work_);
  for (std::size_t i = 0; i < base_.size(); ++i) response[i] = (response[i] - base_[i]) / scale;
}

/// The speeds after hinges were locked, the state being in its new configuration: M (u⁺ − u⁻) = Sᵀ Λ with S u⁺ = 0.
/// By the recursion of the equations, once for the change and once for what rounding leaves of it.
Evaluation EventActions::settle(State& state) {
  const Layout& layout = model_.layout();
  const std::size_t first = layout.positions, count = layout.speeds;
  const std::span<double> speeds = std::span(state.y).subspan(first, count);
  at_rest_ = state.y;
  std::fill_n(at_rest_.begin() + static_cast<std::ptrdiff_t>(first), count, 0.0);
  std::vector<bool> driven(count, false);
  for (const MotionNode& motion : model_.motions()) {
    const Slot& slot = layout.hinges[static_cast<std::size_t>(motion.hinge)];
    std::fill_n(driven.begin() + static_cast<std::ptrdiff_t>(slot.speed), slot.speeds, true);
  }
  std::vector<double> change(count), none(count), momentum(count), correction(count), given(count);
  for (const std::size_t hinge : book_.locked(state.y)) {
    const Slot& slot = layout.hinges[hinge];
    for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i) {
      driven[i] = true;
      given[i] = -speeds[i];
    }
  }
  respond(at_rest_, given, none, change);
  if (!responded_.ok()) return responded_;
  equations_.mass_times(at_rest_, change, momentum, work_);
  for (std::size_t i = 0; i < count; ++i) momentum[i] = driven[i] ? 0.0 : -momentum[i];
  respond(at_rest_, none, momentum, correction);
  if (!responded_.ok()) return responded_;
  for (std::size_t i = 0; i < count; ++i) {
    if (!driven[i]) speeds[i] += change[i] + correction[i];
    if (!std::isfinite(speeds[i])) return {Evaluation::Outcome::nonfinite};
  }
  for (const std::size_t hinge : book_.locked(state.y))
    std::fill_n(speeds.begin() + static_cast<std::ptrdiff_t>(layout.hinges[hinge].speed), layout.hinges[hinge].speeds,
                0.0);
  return {};
}

}  // namespace withy
