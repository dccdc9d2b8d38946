#include "withy/scene/state.hpp"

#include <fmt/format.h>

#include <cmath>
#include <unordered_map>
#include <vector>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/scene/constraints.hpp"
#include "withy/scene/events_done.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/held.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/orientation.hpp"
#include "withy/scene/scene.hpp"
#include "withy/scene/state_as_given.hpp"

namespace withy {
namespace {

constexpr double unit_tolerance = 1e-6;
// Quaternions of a running simulation are unit to a few roundings; those stay, so that a restart has the same bits.
constexpr double rounding = 1e-14;

/// Units of a hinge's coordinates or rates; "1" for a coordinate that is no integral of a rate.
std::vector<std::string> hinge_units(const Hinge& hinge, bool rates) {
  std::vector<std::string> units(rates ? hinge.speeds() : hinge.coordinates(), "1");
  std::size_t index = 0;
  for (const HingeRate& rate : hinge_rates(hinge)) {
    if (rates) units[index++] = rate.angular ? "rad/s" : "m/s";
    if (!rates && rate.coordinate) units[*rate.coordinate] = rate.angular ? "rad" : "m";
  }
  return units;
}

bool has_quaternion(const Hinge& hinge) {
  const auto kernel = hinge.kernel();
  return kernel && (kernel->kind == HingeKernel::Kind::spherical || kernel->kind == HingeKernel::Kind::free);
}

class StateReader {
 public:
  StateReader(const Model& model, const Checker& checker, State& state)
      : model_(model), checker_(checker), state_(state) {}

  bool read(const Value& value) {
    if (!map_with(value,
                  {"hinges", "bodies", "loads", "held", "inputs", "locked", "settings", "events", "time", "work"}))
      return false;
    scalar(value, number("time", "s", ""), state_.time);
    model_.prescribe(state_);  // what the state does not say of driven hinges, their motions do
    if (const Value* hinges = value.find("hinges")) read_hinges(*hinges);
    if (const Value* bodies = value.find("bodies")) read_bodies(*bodies);
    if (const Value* loads = value.find("loads")) read_loads(*loads);
    if (const Value* held = value.find("held")) good_ = read_held(*held, model_, checker_, state_) && good_;
    if (const Value* inputs = value.find("inputs")) read_inputs(*inputs);
    scalar(value, number("work", "J", ""), state_.y.back());
    good_ = read_events_done(value, model_, checker_, state_) && good_;
    return good_;
  }

 private:
  bool map_with(const Value& value, const std::vector<std::string>& keys) {
    if (!checker_.is_map(value, "a map with " + listed(keys))) return good_ = false;
    for (const auto& [key, member] : value.members()) {
      if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      key_error(member, fmt::format("unknown key {}{}", in_quotes(key), suggestion(key, keys)));
    }
    return true;
  }

  void key_error(const Value& member, std::string message) {
    checker_.key_error(member.place().path, std::move(message));
    good_ = false;
  }

  void scalar(const Value& map, const ParameterSpec& spec, double& target) {
    const Value* given = map.find(spec.key);
    if (given == nullptr) return;
    const auto checked = checker_.check(*given, spec);
    if (!checked) {
      good_ = false;
      return;
    }
    target = checked->number();
  }

  /// Reads the list under `key`, or where it is one number the number, into the numbers of y from `first` on; null
  /// where there is none that is right.
  const Value* list(const Value& map, const char* key, std::size_t first, const std::vector<std::string>& units) {
    return numbers(map.find(key), first, units, "");
  }
  /// \param what they are; may be empty
  const Value* numbers(const Value* given, std::size_t first, const std::vector<std::string>& units, const char* what) {
    if (given == nullptr) return nullptr;
    if (units.size() == 1 && given->kind() != Value::Kind::list) {  // a number alone is a list of one
      const auto x = checker_.check(*given, number("", units[0], ""));
      if (x) state_.y[first] = x->number();
      good_ = good_ && x.has_value();
      return x ? given : nullptr;
    }
    if (given->kind() != Value::Kind::list || given->items().size() != units.size()) {
      checker_.diagnostics().error(
          given->place(), fmt::format("got {}; need {}{}", shown(*given),
                                      units.size() == 1 ? "one finite number"
                                                        : fmt::format("a list of {} finite numbers", units.size()),
                                      what));
      good_ = false;
      return nullptr;
    }
    bool all = true;
    for (std::size_t i = 0; i < units.size(); ++i) {
      const auto x = checker_.check(given->items()[i], number("", units[i], ""));
      if (x) state_.y[first + i] = x->number();
      all = all && x.has_value();
    }
    good_ = good_ && all;
    return all ? given : nullptr;
  }

  void read_hinges(const Value& value) {
    if (!checker_.is_map(value, "a map of hinge names")) {
      good_ = false;
      return;
    }
    std::vector<std::string> names;
    for (const HingeNode& h : model_.hinges()) names.push_back(h.name);
    for (const auto& [name, member] : value.members()) {
      const int index = model_.hinge(name);
      if (index < 0) {
        key_error(member, fmt::format("no hinge {}{}", in_quotes(name), checker_.suggest(name, names)));
        continue;
      }
      if (!map_with(member, {"position", "rate"})) continue;
      const Hinge& hinge = *model_.hinges()[static_cast<std::size_t>(index)].hinge;
      const Slot& slot = model_.layout().hinges[static_cast<std::size_t>(index)];
      const Value* given = member.find("position");
      std::optional<Value> coordinates;
      if (given != nullptr && given->kind() == Value::Kind::map && has_quaternion(hinge)) {
        coordinates = coordinates_of(*given, hinge);
        good_ = good_ && coordinates.has_value();
        given = coordinates ? &*coordinates : nullptr;
      }
      const char* what = !has_quaternion(hinge) ? ""
                         : slot.positions == 4
                             ? ", a unit quaternion w, x, y, z; or a map as {xyz: [a, b, c]}"
                             : ", a unit quaternion w, x, y, z and x, y, z [m]; or a map with position, orientation";
      const Value* position = numbers(given, slot.position, hinge_units(hinge, false), what);
      if (position != nullptr && has_quaternion(hinge)) {
        const std::span<double> q(state_.y.data() + slot.position, 4);
        if (!accept_quaternion(q, position->place(), checker_.diagnostics())) good_ = false;
      }
      list(member, "rate", model_.layout().positions + slot.speed, hinge_units(hinge, true));
    }
  }

  /// The coordinates that a map says: an orientation of a spherical hinge, orientation and position of a free one.
  [[nodiscard]] std::optional<Value> coordinates_of(const Value& map, const Hinge& hinge) const {
    if (hinge.kernel()->kind == HingeKernel::Kind::spherical) return read_orientation(map, checker_);
    const auto pose = checker_.check_members(map, grammar::pose_members());
    if (!pose) return {};
    Value all = Value::list({}, map.place());
    for (const char* key : {"orientation", "position"})
      for (const Value& x : pose->at(key).items()) all.items().push_back(x);
    return all;
  }

  void read_bodies(const Value& value) {
    if (!checker_.is_map(value, "a map of names of flexible bodies")) {
      good_ = false;
      return;
    }
    std::vector<std::string> names;
    std::unordered_map<std::string_view, const Slot*> slots;
    for (const Slot& s : model_.layout().bodies) {
      names.push_back(s.name);
      slots.emplace(s.name, &s);
    }
    for (const auto& [name, member] : value.members()) {
      const auto found = slots.find(name);
      const Slot* slot = found == slots.end() ? nullptr : found->second;
      if (slot == nullptr) {
        const std::size_t segments = model_.segments(name).size();
        key_error(
            member,
            segments > 1   ? fmt::format("body '{0}' is in segments; name each, '{0}.1' to '{0}.{1}'", name, segments)
            : segments > 0 ? fmt::format("body '{}' is rigid: it has no modes", name)
                           : fmt::format("no flexible body {}{}", in_quotes(name), checker_.suggest(name, names)));
        continue;
      }
      if (!map_with(member, {"modes", "rates"})) continue;
      const std::vector<std::string> units(slot->positions, "1");
      list(member, "modes", slot->position, units);
      list(member, "rates", model_.layout().positions + slot->speed, units);
    }
  }

  void read_loads(const Value& value) {
    if (!checker_.is_map(value, "a map of names of loads that have continuous states")) {
      good_ = false;
      return;
    }
    std::vector<std::string> names;
    std::vector<LoadSlot> slots = model_.layout().continuous_slots;
    std::erase_if(slots, [](const LoadSlot& slot) { return slot.count == 0; });
    for (const LoadSlot& slot : slots) names.push_back(model_.loads()[slot.load].name);
    for (const auto& [name, member] : value.members()) {
      const auto at = std::find(names.begin(), names.end(), name);
      if (at == names.end()) {
        key_error(member,
                  fmt::format("no load with continuous states {}{}", in_quotes(name), checker_.suggest(name, names)));
        continue;
      }
      const LoadSlot& slot = slots[static_cast<std::size_t>(at - names.begin())];
      const ContinuousPart& part = *model_.loads()[slot.load].continuous;
      std::vector<std::string> keys;
      for (std::size_t i = 0; i < slot.count; ++i) keys.push_back(part.name(i));
      if (!map_with(member, keys)) continue;
      for (std::size_t i = 0; i < slot.count; ++i) scalar(member, number(keys[i], "1", ""), state_.y[slot.first + i]);
    }
  }

  void read_inputs(const Value& value) {
    if (!checker_.is_map(value, "a map of names of loads of type input")) {
      good_ = false;
      return;
    }
    std::vector<std::string> names;
    for (const LoadNode& load : model_.loads())
      if (load.load->input() != nullptr) names.push_back(load.name);
    for (const auto& [name, member] : value.members()) {
      const auto named = [&, &wanted = name](const LoadNode& load) {
        return load.name == wanted && load.load->input() != nullptr;
      };
      const auto load = std::find_if(model_.loads().begin(), model_.loads().end(), named);
      if (load == model_.loads().end()) {
        key_error(member, fmt::format("no load of type 'input' {}{}", in_quotes(name), checker_.suggest(name, names)));
        continue;
      }
      if (const HostedMotion* motion = hosted_motion(*load->load); motion != nullptr && !motion->jumps()) {
        key_error(member, "is of a motion, which begins where its hinge is; leave it out");
        continue;
      }
      double given = 0;
      scalar(value, number(name, load->load->input()->unit(), ""), given);
      load->load->input()->set(state_.time, state_.time, given, load->discrete(std::span(state_.y)));
    }
  }

  const Model& model_;
  const Checker& checker_;
  State& state_;
  bool good_ = true;
};

/// Which numbers of y are continuous states of loads that a state names. \param given null: nothing
std::vector<bool> named_by(const Value* given, const Model& model) {
  std::vector<bool> named(model.layout().size());
  const Value* loads = given == nullptr ? nullptr : given->find("loads");
  if (loads == nullptr) return named;
  for (const LoadSlot& slot : model.layout().continuous_slots) {
    const LoadNode& load = model.loads()[slot.load];
    const Value* states = loads->find(load.name);
    for (std::size_t i = 0; states != nullptr && i < slot.count; ++i)
      named[slot.first + i] = states->has(load.continuous->name(i));
  }
  return named;
}

/// The same of a state without its scene: those that are not as they would begin there.
std::vector<bool> set_in(const State& start, const Model& model) {
  State begun = start;
  model.begin_continuous(begun);
  std::vector<bool> set(start.y.size());
  for (std::size_t i = 0; i < set.size(); ++i) set[i] = start.y[i] != begun.y[i];
  return set;
}

/// Loads' own states that `given` does not name begin where the state read has them begin, but for those of `stay`.
/// \param stay one a number of y
void begin_loads_anew(const Value& given, const Model& model, const Checker& checker, const std::vector<bool>& stay,
                      State& state) {
  if (model.layout().continuous == 0) return;
  State anew = state;
  model.begin_continuous(anew);
  for (const LoadSlot& slot : model.layout().continuous_slots)
    for (std::size_t at = slot.first; at < slot.first + slot.count; ++at)
      if (!stay[at]) state.y[at] = anew.y[at];
  if (const Value* loads = given.find("loads"))
    set_state(Value::map({{"loads", *loads}}, given.place()), model, checker, state);
  for (const LoadSlot& slot : model.layout().continuous_slots)
    for (std::size_t i = 0; i < slot.count; ++i)
      if (!std::isfinite(state.y[slot.first + i]))
        checker.diagnostics().error(
            given.place(), fmt::format("load '{}': its state '{}' begins with no finite number here; say it "
                                       "under 'loads'",
                                       model.loads()[slot.load].name, model.loads()[slot.load].continuous->name(i)));
}

/// \param stay as begin_loads_anew
StateAsGiven state_of(std::string_view text, const std::string& file, const Model& model, const State& start,
                      const std::vector<bool>& stay) {
  Diagnostics diagnostics;
  Document document;
  StateAsGiven read(start);
  if (read_document(text, {}, document, diagnostics)) {
    Registry none;
    // A run.json says with which state its run ended.
    const Value& root = document.root;
    const Value* final = root.kind() == Value::Kind::map && root.has("status") ? root.find("final") : nullptr;
    const Value& given = final != nullptr ? *final : root;
    const Checker checker(document, none, diagnostics);
    if (set_state(given, model, checker, read.state)) {
      begin_loads_anew(given, model, checker, stay, read.state);
      read.named = given_state(&given, model);
      read.begun = named_by(&given, model);
      const Layout& layout = model.layout();
      const std::size_t first = layout.positions + layout.speeds;
      for (std::size_t at = first; at < first + layout.continuous; ++at) read.begun[at] = !stay[at] && !read.begun[at];
    }
  }
  if (!diagnostics.ok()) throw SceneError(file, diagnostics.errors());
  return read;
}

}  // namespace

bool accept_quaternion(std::span<double> q, const Place& place, Diagnostics& diagnostics) {
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (!(std::abs(norm - 1) <= unit_tolerance)) {
    diagnostics.error(place, fmt::format("got a quaternion of norm {}; need norm 1 within {}", norm, unit_tolerance));
    return false;
  }
  if (std::abs(norm - 1) > rounding) {
    for (std::size_t i = 0; i < 4; ++i) q[i] /= norm;
  }
  return true;
}

bool set_state(const Value& value, const Model& model, const Checker& checker, State& state) {
  return StateReader(model, checker, state).read(value);
}

State parse_state(std::string_view text, const std::string& file, const Model& model, const State& start) {
  return state_of(text, file, model, start, set_in(start, model)).state;
}

StateAsGiven parse_state_as_given(std::string_view text, const std::string& file, const Scene& scene) {
  return state_of(text, file, *scene.model, scene.initial, named_by(scene.source.find("initial"), *scene.model));
}

State parse_state(std::string_view text, const std::string& file, const Scene& scene) {
  return parse_state_as_given(text, file, scene).state;
}

State read_state(const std::string& file, const Model& model, const State& start) {
  return parse_state(read_bytes(file), file, model, start);
}

StateAsGiven read_state_as_given(const std::string& file, const Scene& scene) {
  return parse_state_as_given(read_bytes(file), file, scene);
}

State read_state(const std::string& file, const Scene& scene) { return read_state_as_given(file, scene).state; }

}  // namespace withy
