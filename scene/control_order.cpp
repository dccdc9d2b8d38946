#include "withy/scene/control_order.hpp"

#include <algorithm>
#include <cctype>

#include "withy/core/model/bound_sensor.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/model/signal_source.hpp"
#include "withy/core/plugin/sampled_part.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/make.hpp"
#include "withy/scene/names.hpp"

namespace withy {
namespace {

/// Adds the loads among the words of a text; a word ends before a dot.
void add_words(const std::string& text, const std::set<std::string>& loads, std::set<std::string>& found) {
  const auto of_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-'; };
  for (auto at = text.begin(); at != text.end();) {
    const auto end = std::find_if_not(at, text.end(), of_word);
    if (const std::string word(at, end); loads.contains(word)) found.insert(word);
    at = end == text.end() ? end : std::next(end);
  }
}

/// "a -> b -> a", beginning at a load that waits for others.
std::string circle(const std::list<PendingLoad>& waiting) {
  std::vector<std::string> way{waiting.front().name};
  for (;;) {
    const auto at =
        std::find_if(waiting.begin(), waiting.end(), [&](const PendingLoad& l) { return l.name == way.back(); });
    const auto next = std::find_if(at->needs.begin(), at->needs.end(), [&](const std::string& need) {
      return std::any_of(waiting.begin(), waiting.end(), [&](const PendingLoad& l) { return l.name == need; });
    });
    const auto before = std::find(way.begin(), way.end(), *next);
    if (before != way.end()) {
      std::string text;
      for (auto name = before; name != way.end(); ++name) text += *name + " -> ";
      return text + *next;
    }
    way.push_back(*next);
  }
}

/// The outputs in their order, without a sensor where it cannot be bound yet.
std::shared_ptr<const std::vector<SensorNode>> measurable(const Value& outputs, const Model& model,
                                                          const Document& document, const SceneNames& names,
                                                          Registry& registry) {
  auto all = std::make_shared<std::vector<SensorNode>>();
  std::vector<SensorNode> bound;
  for (const auto& [name, given] : outputs.members()) {
    Diagnostics unheard;  // what is wrong is reported where outputs are read
    Checker checker(document, registry, unheard);
    checker.know(&names);
    std::shared_ptr<const BoundSensor> sensor;
    try {
      Made<Sensor> made;
      const auto value = check_plugin_map(given, "type", grammar::sensor_members(), checker, made);
      const auto object = value ? make_object(*made.plugin, *value, checker) : nullptr;
      if (object != nullptr) sensor = bind_sensor(*object, model, bound);
    } catch (const std::invalid_argument&) {
      sensor = nullptr;
    }
    all->push_back({name, sensor});
    if (sensor != nullptr) bound.push_back(all->back());
  }
  return all;
}

std::string problem_of(const UnknownSignal& e) {
  const std::string guess = nearest(e.name, e.known);
  return guess.empty() ? e.what() : fmt::format("no signal '{}'; did you mean '{}'?", e.name, guess);
}

/// Where a load names a signal: an element of `of`, or a formula; null where that cannot be seen.
const Value* naming(const Value& value, const std::string& signal) {
  if (value.kind() == Value::Kind::text) return value.text().find(signal) != std::string::npos ? &value : nullptr;
  for (const Value& item : value.items())
    if (const Value* found = naming(item, signal)) return found;
  return nullptr;
}

bool measures(const Value& load) {
  const Value* type = load.find("type");
  return load.has("of") || load.has("schedule") ||
         (type != nullptr && type->kind() == Value::Kind::text && type->text() == "expression");
}

}  // namespace

void name_signals(const Document& document, Model* model, SceneNames& names, Registry& registry) {
  const Value none = Value::map({});
  const auto map_of = [&](const char* key) -> const Value& {
    const Value* given = document.root.find(key);
    return given == nullptr || given->kind() != Value::Kind::map ? none : *given;
  };
  const std::vector<Value::Member>& loads = map_of("loads").members();
  for (const auto& [name, given] : loads) names.loads.add(name);
  if (model == nullptr) {  // no hinge's columns are known: any number behind the name of one is taken
    for (const std::string& hinge : names.hinges.names()) names.signals.add(hinge);
  } else {
    for (const HingeNode& hinge : model->hinges()) {
      for (const Column& c : coordinate_columns(hinge)) names.signals.add(c.name);
      for (const Column& c : rate_columns(hinge)) names.signals.add(c.name);
    }
  }
  for (const char* key : {"outputs", "loads"})
    for (const auto& [name, given] : map_of(key).members()) names.signals.add(name);
  if (model != nullptr &&
      std::any_of(loads.begin(), loads.end(), [](const Value::Member& load) { return measures(load.second); }))
    model->set_measured(measurable(map_of("outputs"), *model, document, names, registry));
}

void give_outputs(Model& model, const std::vector<SensorNode>& outputs, const Checker& checker) {
  if (model.measured() == nullptr) return;
  model.set_measured(std::make_shared<const std::vector<SensorNode>>(outputs));
  for (const LoadNode& node : model.loads()) {
    const auto* sampled = dynamic_cast<const SampledPart*>(node.load->discrete());
    try {
      for (const std::string& name : sampled == nullptr ? std::vector<std::string>{} : sampled->measures())
        static_cast<void>(find_signal(model, name));
    } catch (const UnknownSignal& e) {
      checker.key_error("/loads/" + node.name, problem_of(e));
    }
  }
}

void UnboundLoads::add(const std::string& name, const Value& load) {
  Unbound unbound{name, load, {}, {}};
  try {
    throw;
  } catch (const UnknownSignal& e) {
    unbound.problem = problem_of(e);
    for (const char* key : {"of", "value", "schedule"})
      if (const Value* given = load.find(key))
        if (const Value* at = naming(*given, e.name); at != nullptr && unbound.place.line == 0)
          unbound.place = at->place();
  } catch (const std::invalid_argument& e) {
    unbound.problem = e.what();
  }
  names_.insert(name);
  loads_.push_back(std::move(unbound));
}

bool UnboundLoads::concern(const std::string& name, const Value& output) {
  if (!mentions(output, names_)) return false;
  names_.insert(name);
  return true;
}

void UnboundLoads::report(const Checker& checker, std::set<std::string>& refused) {
  for (const Unbound& l : loads_) {
    if (!mentions(l.load, refused)) {
      if (l.place.line > 0)
        checker.diagnostics().error(l.place, l.problem);
      else
        checker.key_error("/loads/" + l.name, l.problem);
    }
    refused.insert(l.name);
  }
}

std::set<std::string> needed_loads(const Value& load, const std::set<std::string>& loads) {
  std::set<std::string> found;
  for (const char* key : {"of", "to"}) {
    const Value* given = load.find(key);
    if (given == nullptr || given->kind() != Value::Kind::list) continue;
    for (const Value& item : given->items()) {
      const std::string name = item.text().substr(0, item.text().find('.'));
      if (loads.contains(name)) found.insert(name);
    }
  }
  for (const char* key : {"value", "schedule"})
    if (const Value* text = load.find(key); text != nullptr && text->kind() == Value::Kind::text)
      add_words(text->text(), loads, found);
  return found;
}

std::list<PendingLoad> in_order_of_need(std::list<PendingLoad> loads, const Checker& checker) {
  std::list<PendingLoad> ordered;
  std::set<std::string> done;
  const auto there = [&](const std::string& need) {
    return done.contains(need) ||
           std::any_of(loads.begin(), loads.end(), [&](const PendingLoad& l) { return l.name == need; });
  };
  while (!loads.empty()) {
    const auto ready = std::find_if(loads.begin(), loads.end(), [&](const PendingLoad& l) {
      return std::all_of(l.needs.begin(), l.needs.end(), [&](const std::string& need) { return done.contains(need); });
    });
    if (ready != loads.end()) {
      done.insert(ready->name);
      ordered.splice(ordered.end(), loads, ready);
      continue;
    }
    const auto hopeless = std::find_if(loads.begin(), loads.end(), [&](const PendingLoad& l) {
      return !std::all_of(l.needs.begin(), l.needs.end(), there);
    });
    if (hopeless != loads.end()) {
      loads.erase(hopeless);
      continue;
    }
    checker.key_error(
        "/loads/" + loads.front().name,
        fmt::format("the loop {} is algebraic: each of these loads needs what another one gives", circle(loads)));
    break;
  }
  return ordered;
}

}  // namespace withy
