#include "withy/core/simulation/instants.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "withy/core/model/event_plan.hpp"
#include "withy/core/model/held_numbers.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/same_instant.hpp"

namespace withy {
namespace {

const DiscretePart& part_of(const Model& model, const LoadSlot& slot) {
  return *model.loads()[slot.load].load->discrete();
}

}  // namespace

bool has_switches(const Model& model) {
  if (EventBook(model).any()) return true;
  const auto& slots = model.layout().discrete_slots;
  return std::any_of(slots.begin(), slots.end(),
                     [&](const LoadSlot& slot) { return part_of(model, slot).switches() > 0; });
}

State begun(const Model& model, const EquationsOfMotion& equations, State state) {
  Clocks(model, equations).begin(state);
  return state;
}

Clocks::Clocks(const Model& model, const EquationsOfMotion& equations) : model_(model), renewal_(model, equations) {
  for (const LoadSlot& slot : model.layout().discrete_slots)
    if (const double period = part_of(model, slot).period(); period > 0) clocks_.push_back({slot, period, 0});
}

void Clocks::begin(State& state) {
  if (const auto begun = place_of_begun(model_); !begun || state.y[*begun] == 0) {
    renewal_.at(state);
    for (const LoadSlot& slot : model_.layout().discrete_slots) renewal_(state, slot, {.begins = true});
    if (begun) state.y[*begun] = 1;
  }
  go_on_after(state.time);
}

void Clocks::go_on_after(double time) { set_next(time, false); }

void Clocks::go_on_with(double time) { set_next(time, true); }

void Clocks::set_next(double time, bool with_time) {
  constexpr double counted = 0x1p50;  // beyond, an index and the next are the same instant
  const auto has_been = [&](double instant) { return same_instant(instant, time) ? !with_time : instant < time; };
  for (Clock& clock : clocks_) {
    clock.index = std::floor(time / clock.period);
    if (!(std::abs(clock.index) < counted))
      throw std::invalid_argument("at t = " + brief(time) + " s the period of load '" +
                                  model_.loads()[clock.slot.load].name + "', " + brief(clock.period) +
                                  " s, is below the resolution of time");
    // The quotient is rounded; an instant is the product.
    clock.index -= 1;
    while (has_been(clock.index * clock.period)) clock.index += 1;
  }
}

double Clocks::next() const {
  double first = std::numeric_limits<double>::infinity();
  for (const Clock& clock : clocks_) first = std::min(first, clock.index * clock.period);
  return first;
}

bool Clocks::due(double time) const {
  const double first = next();
  return first <= time || same_instant(first, time);
}

void Clocks::renew(State& state, Renewal& renewal) {
  renewal.at(state);
  const double now = state.time;
  for (const Clock& clock : clocks_) {
    const double instant = clock.index * clock.period;
    if (!same_instant(instant, now)) continue;
    state.time = instant;  // what a load is told does not depend on the clocks of others
    renewal(state, clock.slot, {});
  }
  state.time = now;
}

bool Clocks::renew(State& state, const LoadSlot& slot, const Crossing& crossing) {
  const auto own = std::span(state.y).subspan(slot.first, slot.count);
  before_.assign(own.begin(), own.end());
  renewal_.at(state);
  renewal_(state, slot, crossing);
  return !std::equal(own.begin(), own.end(), before_.begin());
}

}  // namespace withy
