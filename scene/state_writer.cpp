#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "withy/core/model/held_numbers.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/scene/events_done.hpp"
#include "withy/scene/scene.hpp"
#include "withy/scene/value_json.hpp"

namespace withy {
namespace {

Value list_of(std::span<const double> numbers) {
  Value list = Value::list({});
  for (const double x : numbers) list.items().emplace_back(x);
  return list;
}

/// The continuous states of loads, load after load.
Value continuous_of(const Model& model, const State& state) {
  Value all = Value::map({});
  for (const LoadSlot& slot : model.layout().continuous_slots) {
    if (slot.count == 0) continue;
    const LoadNode& load = model.loads()[slot.load];
    Value own = Value::map({});
    for (std::size_t i = 0; i < slot.count; ++i)
      own.members().emplace_back(load.continuous->name(i), Value(state.y[slot.first + i]));
    all.members().emplace_back(load.name, std::move(own));
  }
  return all;
}

/// The inputs that a host has set, at the state.
Value inputs_of(const Model& model, const State& state) {
  Value inputs = Value::map({});
  for (const LoadNode& load : model.loads()) {
    const InputPort* input = load.load->input();
    const auto discrete = load.discrete(std::span(state.y));
    if (const HostedMotion* motion = hosted_motion(*load.load); motion != nullptr && !motion->jumps()) continue;
    if (input != nullptr && input->is_set(discrete))
      inputs.members().emplace_back(load.name, Value(input->value(state.time, discrete)));
  }
  return inputs;
}

/// What loads hold between instants, of a state of a run.
Value held_of(const Model& model, const State& state) {
  Value all = Value::map({});
  const auto begun = place_of_begun(model);
  if (!begun || state.y[*begun] == 0) return all;
  for (const LoadNode& load : model.loads())
    if (const auto held = held_numbers(load, std::span(state.y)); !held.empty())
      all.members().emplace_back(load.name, list_of(held));
  return all;
}

void add_events_done(const EventsDone& done, Value& all) {
  Value locked = Value::list({}), settings = Value::map({}), events = Value::map({});
  for (const std::string& name : done.locked) locked.items().emplace_back(name);
  for (const auto& [name, setting] : done.settings) settings.members().emplace_back(name, Value(setting));
  for (const auto& [name, numbers] : done.events) {
    Value own = Value::map({});
    for (const auto& [key, value] : numbers) own.members().emplace_back(key, Value(value));
    events.members().emplace_back(name, std::move(own));
  }
  all.set("locked", std::move(locked));
  all.set("settings", std::move(settings));
  all.set("events", std::move(events));
}

}  // namespace

Value state_value(const Model& model, const State& state) {
  const Layout& layout = model.layout();
  const auto part = [&](std::size_t first, std::size_t count) {
    return list_of(std::span(state.y).subspan(first, count));
  };
  Value hinges = Value::map({}), bodies = Value::map({});
  for (const Slot& s : layout.hinges) {
    if (s.positions == 0) continue;
    hinges.members().emplace_back(s.name, Value::map({{"position", part(s.position, s.positions)},
                                                      {"rate", part(layout.positions + s.speed, s.speeds)}}));
  }
  for (const Slot& s : layout.bodies) {
    bodies.members().emplace_back(s.name, Value::map({{"modes", part(s.position, s.positions)},
                                                      {"rates", part(layout.positions + s.speed, s.speeds)}}));
  }
  Value all = Value::map({{"time", Value(state.time)},
                          {"hinges", std::move(hinges)},
                          {"bodies", std::move(bodies)},
                          {"work", Value(state.y.back())}});
  if (Value loads = continuous_of(model, state); !loads.members().empty()) all.set("loads", std::move(loads));
  if (Value held = held_of(model, state); !held.members().empty()) all.set("held", std::move(held));
  if (Value inputs = inputs_of(model, state); !inputs.members().empty()) all.set("inputs", std::move(inputs));
  if (const auto done = events_done(model, state)) add_events_done(*done, all);
  return all;
}

std::string write_state(const Model& model, const State& state) { return value_json(state_value(model, state)).dump(); }

}  // namespace withy
