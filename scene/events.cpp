#include "withy/scene/events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/switched_load.hpp"
#include "withy/scene/event_triggers.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/make.hpp"
#include "withy/scene/names.hpp"

namespace withy {
namespace {

using Kind = EventAction::Kind;
using When = ActingEvent::When;

/// The items of a list of texts; none where it is not there.
std::vector<Value> items_of(const Value& map, const char* key) {
  const Value* given = map.find(key);
  return given == nullptr ? std::vector<Value>{} : given->items();
}

int direction_of(const Value& event) {
  const std::string& direction = event.text_at("direction");
  return direction == "up" ? 1 : (direction == "down" ? -1 : 0);
}

std::size_t column_count(const std::vector<SensorNode>& sensors) {
  std::size_t count = 0;
  for (const SensorNode& node : sensors) count += node.sensor->columns().size();
  return count;
}

std::string where(const std::string& event) { return "/events/" + event; }

/// "loads.motor.amplitude=5" in its parts; nothing where it is not of that form.
struct Setting {
  std::string load, key, text;
};
std::optional<Setting> setting_of(const std::string& text) {
  constexpr std::string_view root = "loads.";
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || !text.starts_with(root)) return {};
  const std::string path = text.substr(root.size(), equals - root.size());
  const std::size_t dot = path.find('.');
  if (dot == 0 || dot == std::string::npos || dot + 1 == path.size()) return {};
  const std::string key = path.substr(dot + 1);
  return Setting{path.substr(0, dot), key.substr(0, key.find_last_not_of(' ') + 1), text.substr(equals + 1)};
}

/// Puts a value at a path within a load, by members of maps and items of lists.
/// \returns what is wrong with the path; empty where nothing is
std::string put_setting(Value& form, std::string key, const Value& value) {
  Value* target = &form;
  for (;;) {
    const std::size_t dot = std::min(key.find('.'), key.size());
    const std::string next = key.substr(0, dot);
    Value* found = nullptr;
    if (target->kind() == Value::Kind::list) {
      const std::size_t count = target->items().size();
      const auto index = list_index(next, count);
      if (!index) return fmt::format("got index {}; need 0 to {}", in_quotes(next), static_cast<long>(count) - 1);
      found = &target->items()[*index];
    } else {
      const auto at = std::find_if(target->members().begin(), target->members().end(),
                                   [&](const Value::Member& m) { return m.first == next; });
      if (at != target->members().end()) found = &at->second;
    }
    if (found == nullptr) {
      target->set(key, value);
      return {};
    }
    if (dot == key.size()) {
      *found = value;
      return {};
    }
    target = found;
    key.erase(0, dot + 1);
  }
}

}  // namespace

SceneEvents::SceneEvents(Value events, const Document& document, const Checker& checker)
    : events_(std::move(events)), document_(document), checker_(checker) {
  for (const auto& [name, event] : events_.members())
    if (const Value* after = event.find("after")) followed_.insert(after->text());
}

bool SceneEvents::acts(const std::string& name, const Value& event, const Watched& number) const {
  return !event.at("do").members().empty() || number.element < 0 || event.number_at("delay") > 0 ||
         event.at("repeat").boolean() || followed_.contains(name);
}

void SceneEvents::loosen(Value& hinges) {
  std::set<std::string> released;
  for (const auto& [name, event] : events_.members())
    for (const Value& body : items_of(event.at("do"), "release")) released.insert(body.text());
  if (released.empty()) return;
  for (auto& [name, hinge] : hinges.members()) {
    const Value *child = hinge.find("child"), *type = hinge.find("type");
    if (child == nullptr || type == nullptr || type->kind() != Value::Kind::text || type->text() != "weld") continue;
    if (child->kind() != Value::Kind::text || !released.contains(child->text().substr(0, child->text().find('.'))))
      continue;
    hinge.set("type", Value(std::string("free"), type->place()));
    held_.push_back(name);
  }
}

void SceneEvents::fasten(Value& hinges) const {
  if (held_.empty()) return;
  for (auto& [name, hinge] : hinges.members())
    if (std::find(held_.begin(), held_.end(), name) != held_.end()) hinge.set("type", Value(std::string("weld")));
}

void SceneEvents::expect_locks(Model& model) const {
  std::vector<std::string> names = held_;
  for (const auto& [name, event] : events_.members())
    for (const char* key : {"lock", "unlock"})
      for (const Value& item : items_of(event.at("do"), key)) names.push_back(item.text());
  for (const std::string& name : names)
    if (const int hinge = model.hinge(name); hinge >= 0) model.expect_lock(static_cast<std::size_t>(hinge));
}

std::optional<double> SceneEvents::passed_value(const std::string& event, const Watched& number) const {
  const Value* written = document_.root.at("events").at(event).find("value");
  if (written == nullptr || written->kind() != Value::Kind::text) return events_.at(event).number_at("value");
  const auto value = checker_.check(*written, withy::number("value", number.unit.empty() ? "1" : number.unit, ""));
  return value ? std::optional(value->number()) : std::nullopt;
}

/// What a load is given in the scene with what an event sets of it.
Value SceneEvents::changed(const std::string& event, const std::string& load, const Value& given, bool& changes,
                           Diagnostics& diagnostics) const {
  Value form = given;
  for (const Value& item : items_of(events_.at(event).at("do"), "set")) {
    const std::optional<Setting> setting = setting_of(item.text());
    if (!setting || setting->load != load) continue;
    Document read;
    Place place = {item.place().line, 0, given.place().path + "/" + setting->key};
    std::replace(place.path.begin(), place.path.end(), '.', '/');
    if (read_document(setting->text, {place.line, place.path}, read, diagnostics))
      if (const std::string why = put_setting(form, setting->key, read.root); !why.empty())
        diagnostics.error(place, why);
    changes = true;
  }
  return form;
}

/// The load with what an event sets of it; null where it sets nothing, or after it is reported.
std::shared_ptr<const Load> SceneEvents::form_of(const std::string& event, const std::string& load,
                                                 const Value& given) const {
  Diagnostics problems;
  const Checker checker(checker_, problems);
  bool changes = false;
  const Value form = changed(event, load, given, changes, problems);
  std::shared_ptr<const Load> object;
  if (changes) {
    Made<Load> made;
    const auto checked = check_plugin_map(form, "type", grammar::load_members(), checker, made);
    if (checked) object = make_object(*made.plugin, *checked, checker);
  }
  tell_of_settings(event, load, given, problems.errors());
  return problems.ok() ? object : nullptr;
}

/// Reports what is wrong with a load as an event sets it, at the setting.
void SceneEvents::tell_of_settings(const std::string& event, const std::string& load, const Value& given,
                                   const std::vector<Diagnostic>& problems) const {
  for (const Diagnostic& problem : problems) {
    Place place;
    for (const Value& item : items_of(events_.at(event).at("do"), "set")) {
      const std::optional<Setting> setting = setting_of(item.text());
      if (!setting || setting->load != load) continue;
      std::string path = given.place().path + "/" + setting->key;
      std::replace(path.begin(), path.end(), '.', '/');
      if (place.path.empty() || problem.place.path.starts_with(path)) place = item.place();
    }
    place.path = where(event) + "/do/set";
    checker_.diagnostics().error(place, fmt::format("of {}: {}", problem.place.path, problem.message));
  }
}

std::shared_ptr<const Load> SceneEvents::with_forms(const std::string& name, std::shared_ptr<const Load> load) {
  const Value* loads = document_.root.find("loads");
  const Value* given = loads == nullptr ? nullptr : loads->find(name);
  bool switched = false;
  std::vector<std::shared_ptr<const Load>> forms;
  forms.push_back(std::move(load));
  for (const auto& [event, value] : events_.members()) {
    const Value& asked = value.at("do");
    for (const char* key : {"switch_on", "switch_off"})
      for (const Value& item : items_of(asked, key)) switched = switched || item.text() == name;
    if (given == nullptr) continue;
    auto object = form_of(event, name, *given);
    if (object == nullptr) continue;
    switched = true;
    forms_[{event, name}] = static_cast<double>(forms.size());
    forms.push_back(std::move(object));
  }
  if (!switched) return std::move(forms.front());
  return std::make_shared<const SwitchedLoad>(std::move(forms));
}

void SceneEvents::add_hinge_actions(const Model& model, const Value& asked, const char* key, Kind kind,
                                    ActingEvent& event) const {
  for (const Value& item : items_of(asked, key)) {
    const int hinge = model.hinge(item.text());
    if (hinge < 0) {
      std::vector<std::string> names;
      for (const HingeNode& h : model.hinges()) names.push_back(h.name);
      checker_.diagnostics().error(
          item.place(), fmt::format("no hinge {}{}", in_quotes(item.text()), checker_.suggest(item.text(), names)));
      continue;
    }
    const auto h = static_cast<std::size_t>(hinge);
    if (model.layout().hinges[h].speeds == 0) {
      checker_.diagnostics().error(item.place(), fmt::format("hinge '{}' does not move", item.text()));
    } else if (model.driven(h)) {
      checker_.diagnostics().error(
          item.place(),
          fmt::format("hinge '{}' is moved by a motion; a hinge that is locked at first has no motion but "
                      "stands under initial: {{locked: …}}",
                      item.text()));
    } else {
      event.actions.push_back({kind, h, 0});
    }
  }
}

void SceneEvents::add_releases(const Model& model, const Value& asked, ActingEvent& event) const {
  for (const Value& item : items_of(asked, "release")) {
    const std::vector<int> body = model.segments(item.text());
    std::string problem;
    if (body.empty()) {
      std::vector<std::string> names;
      for (const BodyNode& b : model.bodies()) names.push_back(b.scene_name());
      problem = fmt::format("no body {}{}", in_quotes(item.text()), checker_.suggest(item.text(), names));
    } else if (const std::string& hinge = model.hinges()[static_cast<std::size_t>(body.front())].name;
               std::find(held_.begin(), held_.end(), hinge) == held_.end()) {
      problem =
          fmt::format("body '{}' hangs on hinge '{}', which is no weld; need a weld to let go", item.text(), hinge);
    }
    if (!problem.empty()) {
      checker_.diagnostics().error(item.place(), problem);
      continue;
    }
    event.actions.push_back({Kind::unlock, static_cast<std::size_t>(body.front()), 0, true});
  }
}

void SceneEvents::add_load_actions(const Model& model, const std::string& name, const Value& asked,
                                   ActingEvent& event) const {
  const auto index_of = [&](const Value& item, const std::string& load) -> std::optional<std::size_t> {
    std::vector<std::string> names;
    for (const LoadNode& node : model.loads()) names.push_back(node.name);
    const auto at = std::find(names.begin(), names.end(), load);
    if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
    checker_.diagnostics().error(item.place(),
                                 fmt::format("no load {}{}", in_quotes(load), checker_.suggest(load, names)));
    return {};
  };
  for (const auto& [key, form] : {std::pair{"switch_on", SwitchedLoad::as_stated}, {"switch_off", SwitchedLoad::off}})
    for (const Value& item : items_of(asked, key))
      if (const auto load = index_of(item, item.text())) event.actions.push_back({Kind::form, *load, form});
  std::set<std::string> set;
  for (const Value& item : items_of(asked, "set")) {
    const std::optional<Setting> setting = setting_of(item.text());
    if (!setting) {
      checker_.diagnostics().error(item.place(),
                                   fmt::format("got {}; need loads.NAME.PARAMETER=VALUE", in_quotes(item.text())));
      continue;
    }
    const auto load = index_of(item, setting->load);
    const auto form = forms_.find({name, setting->load});
    if (load && form != forms_.end() && set.insert(setting->load).second)
      event.actions.push_back({Kind::form, *load, form->second});
  }
}

/// Integrators would not see the loops of a tree whose hinges lock, and let them open.
void SceneEvents::refuse_in_loops(const Model& model, const Value& asked) const {
  const auto loops = loops_of(model);
  if (loops.empty()) return;
  for (const char* key : {"lock", "unlock", "release"})
    for (const Value& item : items_of(asked, key))
      checker_.diagnostics().error(
          item.place(), fmt::format("'{}' is for trees, and this scene closes loops (constraints.{}); there events "
                                    "change loads or end the run",
                                    key, loops.front()->name()));
}

void SceneEvents::add_actions(const Model& model, const std::string& name, const Value& asked,
                              ActingEvent& event) const {
  refuse_in_loops(model, asked);
  add_hinge_actions(model, asked, "unlock", Kind::unlock, event);
  add_releases(model, asked, event);
  add_hinge_actions(model, asked, "lock", Kind::lock, event);
  add_load_actions(model, name, asked, event);
}

std::vector<std::size_t> SceneEvents::locked_at_start(const Model& model) const {
  std::vector<std::string> names = held_;
  const Value* initial = document_.root.find("initial");
  const Value* given = initial == nullptr ? nullptr : initial->find("locked");
  if (given != nullptr) {                       // what is wrong with it is said where the state is read
    if (initial->has("events")) names.clear();  // a state that a run has written: it says all
    for (const Value& item : given->items()) names.push_back(item.text());
  }
  std::set<std::size_t> locked;
  for (const std::string& name : names)
    if (const int hinge = model.hinge(name); hinge >= 0) locked.insert(static_cast<std::size_t>(hinge));
  return {locked.begin(), locked.end()};
}

void SceneEvents::resolve_after(EventPlan& plan) const {
  std::vector<std::string> names;
  for (const ActingEvent& event : plan.events) names.push_back(event.name);
  for (ActingEvent& event : plan.events) {
    if (event.when != When::after) continue;
    const std::string& after = events_.at(event.name).text_at("after");
    const auto at = std::find(names.begin(), names.end(), after);
    if (at == names.end()) {
      checker_.key_error(where(event.name) + "/after",
                         fmt::format("no event {}{}", in_quotes(after), checker_.suggest(after, names)));
    } else {
      event.after = static_cast<std::size_t>(at - names.begin());
    }
  }
}

ActingEvent SceneEvents::acting_event(const Model& model, const std::string& name, const Value& given,
                                      const Watched& number) const {
  ActingEvent event;
  event.name = name;
  event.when = given.has("at") ? When::at : given.has("after") ? When::after : When::passes;
  event.element = number.element;
  event.column = number.column;
  event.direction = direction_of(given);
  if (event.when == When::at) event.time = given.number_at("at");
  event.delay = given.number_at("delay");
  event.stops = given.at("stop").boolean();
  add_actions(model, name, given.at("do"), event);
  // What is only looked for is told every time.
  event.repeats = given.at("repeat").boolean() || (given.at("do").members().empty() && !event.stops);
  return event;
}

void SceneEvents::add_to(Model& model, const std::vector<SensorNode>& outputs, std::vector<RunEvent>& plain) {
  EventPlan plan;
  refuse_circles(events_, checker_);
  bool senses = false;
  std::vector<SensorNode> limits;
  std::vector<std::size_t> at_limits;  // events that watch them, one each
  for (const auto& [name, given] : events_.members()) {
    const std::optional<Watched> number = watched(model, outputs, given, checker_);
    if (!number) continue;
    const std::optional<double> passed = passed_value(name, *number);
    if (!passed) continue;
    if (!acts(name, given, *number)) {
      const auto function = [index = static_cast<std::size_t>(number->element), value = *passed](
                                double, std::span<const double> y) { return y[index] - value; };
      plain.push_back({name, function, direction_of(given), given.at("stop").boolean()});
      continue;
    }
    std::shared_ptr<const BoundSensor> limit;
    if (given.has("limit")) {
      limit = limit_of(model, given, checker_);
      if (limit == nullptr) continue;
    }
    ActingEvent event = acting_event(model, name, given, *number);
    event.value = *passed;
    if (limit != nullptr) {
      event.column = limits.size();
      at_limits.push_back(plan.events.size());
      limits.push_back({name, std::move(limit)});
    } else {
      senses = senses || (event.when == When::passes && event.element < 0);
    }
    plan.events.push_back(std::move(event));
  }
  if (plan.events.empty()) return;
  resolve_after(plan);
  if (senses) plan.sensors = outputs;
  const std::size_t before = column_count(plan.sensors);
  for (const std::size_t event : at_limits) plan.events[event].column += before;
  plan.sensors.insert(plan.sensors.end(), limits.begin(), limits.end());
  try {
    const std::vector<std::size_t> locked = locked_at_start(model);
    plan.find_configurations({locked});
    plan.start = plan.configuration(locked);
  } catch (const std::invalid_argument& e) {
    checker_.key_error("/events", e.what());
    return;
  }
  add_events(model, std::move(plan));
}

}  // namespace withy
