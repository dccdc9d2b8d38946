#include "withy/scene/event_triggers.hpp"

#include <fmt/format.h>

#include <set>
#include <string>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/model/limit_sensor.hpp"
#include "withy/scene/names.hpp"

namespace withy {
namespace {

std::optional<Watched> hinge_number(const Model& model, const Value& event, const Checker& checker) {
  const std::string path = event.place().path;
  const std::string& hinge = event.text_at("hinge");
  const int number = model.hinge(hinge);
  if (number < 0) {
    std::vector<std::string> names;
    for (const HingeNode& h : model.hinges()) names.push_back(h.name);
    checker.key_error(path + "/hinge", fmt::format("no hinge {}{}", in_quotes(hinge), checker.suggest(hinge, names)));
    return {};
  }
  const Slot& slot = model.layout().hinges[static_cast<std::size_t>(number)];
  const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[static_cast<std::size_t>(number)].hinge);
  const std::size_t component = event.count_at("component");
  if (component >= rates.size()) {
    checker.key_error(path, fmt::format("hinge '{}' has {} rates; there is no component {} (they count from 0)", hinge,
                                        rates.size(), component));
    return {};
  }
  if (event.text_at("of") == "rate")
    return Watched{static_cast<int>(model.layout().positions + slot.speed + component), 0,
                   rates[component].angular ? "rad/s" : "m/s"};
  if (!rates[component].coordinate) {
    checker.key_error(
        path, fmt::format("rate {} of hinge '{}' is the derivative of no coordinate; need of: rate", component, hinge));
    return {};
  }
  return Watched{static_cast<int>(slot.position + *rates[component].coordinate), 0,
                 rates[component].angular ? "rad" : "m"};
}

std::optional<Watched> signal(const Model& model, const std::vector<SensorNode>& outputs, const Value& event,
                              const Checker& checker) {
  const std::string& name = event.text_at("signal");
  std::vector<std::string> known;
  std::size_t column = 0;
  for (const SensorNode& node : outputs) {
    for (const Column& c : columns_of(node)) {
      if (c.name == name) return Watched{-1, column, c.unit};
      known.push_back(c.name);
      ++column;
    }
  }
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = model.layout().hinges[h];
    const auto find = [&](const std::vector<Column>& columns, std::size_t first) -> std::optional<Watched> {
      for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i].name == name) return Watched{static_cast<int>(first + i), 0, columns[i].unit};
        known.push_back(columns[i].name);
      }
      return {};
    };
    if (const auto at = find(coordinate_columns(model.hinges()[h]), slot.position)) return at;
    if (const auto at = find(rate_columns(model.hinges()[h]), model.layout().positions + slot.speed)) return at;
  }
  checker.key_error(event.place().path + "/signal", fmt::format("no number of an output or a hinge {}{}",
                                                                in_quotes(name), checker.suggest(name, known)));
  return {};
}

}  // namespace

std::optional<Watched> watched(const Model& model, const std::vector<SensorNode>& outputs, const Value& event,
                               const Checker& checker) {
  int triggers = 0;
  for (const char* key : {"hinge", "signal", "limit", "at", "after"}) triggers += event.has(key) ? 1 : 0;
  if (triggers != 1) {
    checker.key_error(event.place().path,
                      fmt::format("says {} when it happens; need one of: hinge, signal, limit, at, after",
                                  triggers == 0 ? "nothing of" : "more than one thing of"));
    return {};
  }
  if (event.has("hinge")) return hinge_number(model, event, checker);
  if (event.has("signal")) return signal(model, outputs, event, checker);
  return Watched{};
}

void refuse_circles(const Value& events, const Checker& checker) {
  std::set<std::string> told;
  for (const auto& [first, event] : events.members()) {
    std::string circle = in_quotes(first);
    std::set<std::string> passed;
    const Value* at = &event;
    while (at != nullptr && at->has("after") && passed.insert(at->text_at("after")).second) {
      circle += " after " + in_quotes(at->text_at("after"));
      at = events.find(at->text_at("after"));
    }
    // What only leads into a circle waits for it, and is no part of what is wrong.
    if (!passed.contains(first) || told.contains(first)) continue;
    told.insert(passed.begin(), passed.end());
    checker.key_error(event.place().path + "/after", circle + ": none of these can happen first");
  }
}

std::shared_ptr<const BoundSensor> limit_of(const Model& model, const Value& event, const Checker& checker) {
  const std::string& name = event.text_at("limit");
  std::vector<std::string> names;
  for (std::size_t i = 0; i < model.loads().size(); ++i) {
    names.push_back(model.loads()[i].name);
    if (names.back() != name) continue;
    std::shared_ptr<const BoundSensor> sensor = limit_sensor(model, i);
    if (sensor == nullptr)
      checker.key_error(event.place().path + "/limit",
                        fmt::format("load '{}' tells of no limit; need a controller, an actuator or a wheel with one, "
                                    "or a hinge-limit",
                                    name));
    return sensor;
  }
  checker.key_error(event.place().path + "/limit",
                    fmt::format("no load {}{}", in_quotes(name), checker.suggest(name, names)));
  return nullptr;
}

}  // namespace withy
