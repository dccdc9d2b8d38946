#include "withy/scene/control_order.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <utility>

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

/// What may be a signal in a formula: `servo`, `elbow.rate`, without the sign before it.
std::vector<std::string> words_of(const std::string& formula) {
  const auto of_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; };
  std::vector<std::string> words;
  for (auto at = formula.begin(); at != formula.end();) {
    const auto end = std::find_if_not(at, formula.end(), of_word);
    if (end != at) words.emplace_back(at, end);
    at = end == formula.end() ? end : std::next(end);
  }
  return words;
}

/// What a checked load names as a signal, and where: under `of` and `schedule`, and in its formula.
std::vector<std::pair<std::string, const Value*>> signals_of(const Value& load) {
  std::vector<std::pair<std::string, const Value*>> all;
  const auto text_at = [&](const char* key) {
    const Value* given = load.find(key);
    return given != nullptr && given->kind() == Value::Kind::text ? given : nullptr;
  };
  if (const Value* of = load.find("of"); of != nullptr && of->kind() == Value::Kind::list)
    for (const Value& item : of->items()) all.emplace_back(item.text(), &item);
  if (const Value* schedule = text_at("schedule")) all.emplace_back(schedule->text(), schedule);
  if (const Value* formula = text_at("value"))
    for (std::string& word : words_of(formula->text())) all.emplace_back(std::move(word), formula);
  return all;
}

bool is_column_of_hinge(const Model& model, const std::string& name) {
  const auto among = [&](const std::vector<Column>& columns) {
    return std::any_of(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
  };
  return std::any_of(model.hinges().begin(), model.hinges().end(), [&](const HingeNode& hinge) {
    return among(coordinate_columns(hinge)) || among(rate_columns(hinge));
  });
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

/// What an input acts with, "N m" or "N"; empty of other loads.
std::string unit_of_input(const Value& load, const SceneNames& names) {
  const auto text = [&](const char* key) {
    const Value* given = load.find(key);
    return given != nullptr && given->kind() == Value::Kind::text ? given->text() : std::string();
  };
  if (text("type") != "input") return {};
  if (text("hinge").empty()) return text("acts") == "torque" ? "N m" : "N";
  const Value* component = load.find("component");
  const double rate = component != nullptr && component->kind() == Value::Kind::number ? component->number() : 0;
  return names.sliding.has(fmt::format("{}.{}", text("hinge"), rate)) ? "N" : "N m";
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
      for (const std::vector<Column>& columns : {coordinate_columns(hinge), rate_columns(hinge)}) {
        for (const Column& c : columns) names.signals.add(c.name), names.units[c.name] = c.unit;
      }
    }
    for (const auto& [name, given] : loads)
      if (const std::string unit = unit_of_input(given, names); !unit.empty()) names.units[name] = unit;
  }
  for (const char* key : {"outputs", "loads"})
    for (const auto& [name, given] : map_of(key).members()) names.signals.add(name);
  if (model != nullptr &&
      std::any_of(loads.begin(), loads.end(), [](const Value::Member& load) { return measures(load.second); }))
    model->set_measured(measurable(map_of("outputs"), *model, document, names, registry));
  if (model != nullptr && model->measured() != nullptr)
    for (const SensorNode& node : *model->measured()) {
      if (node.sensor == nullptr) continue;  // one that waits for loads
      for (const Column& c : columns_of(node)) names.units[c.name] = c.unit;
    }
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

std::set<std::string> needed_loads(const Value& load, const std::set<std::string>& loads, const Model* model) {
  std::set<std::string> found;
  const auto add = [&](const std::string& named) {
    const std::string name = named.substr(0, named.find('.'));
    if (loads.contains(name)) found.insert(name);
  };
  for (const auto& [signal, place] : signals_of(load))
    if (model == nullptr || !is_column_of_hinge(*model, signal)) add(signal);
  if (const Value* to = load.find("to"); to != nullptr && to->kind() == Value::Kind::list)
    for (const Value& item : to->items()) add(item.text());
  return found;
}

namespace {

/// \param two which signals have two meanings \param what they are, and what to do
void refuse_signals(const Value& loads, const Checker& checker, const std::function<bool(const std::string&)>& two,
                    const std::string& what) {
  for (const auto& [load, given] : loads.members()) {
    std::set<std::string> told;
    for (const auto& [signal, value] : signals_of(given)) {
      const bool own = signal.substr(0, signal.find('.')) == load;  // no load measures itself
      if (own || !two(signal) || !told.insert(signal).second) continue;
      checker.diagnostics().error(value->place(), fmt::format("'{}' is {}", signal, what));
    }
  }
}

}  // namespace

void refuse_names_of_two(const Value& loads, const Model& model, const Checker& checker) {
  refuse_signals(
      loads, checker, [&](const std::string& signal) { return is_of_hinge_and_load(model, signal); },
      "a hinge and a load, and either can be measured: give the load another name");
}

void refuse_names_of_load_and_output(const Value& loads, const Model& model, const std::vector<SensorNode>& outputs,
                                     const Checker& checker) {
  std::set<std::string> numbers;
  for (const SensorNode& node : outputs)
    for (const Column& column : columns_of(node)) numbers.insert(column.name);
  refuse_signals(
      loads, checker, [&](const std::string& signal) { return numbers.contains(signal) && is_of_load(model, signal); },
      "a load and an output, and either can be measured: give the output another name");
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
    const std::string first = loads.front().name, way = circle(loads);
    checker.key_error(
        "/loads/" + first,
        fmt::format("the loop {} is algebraic{}", way,
                    way == first + " -> " + first ? "; if an output of that name is meant, give the load another name"
                                                  : ": each of these loads needs what another one gives"));
    break;
  }
  return ordered;
}

}  // namespace withy
