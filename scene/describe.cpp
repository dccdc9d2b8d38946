#include "withy/scene/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "withy/scene/names.hpp"
#include "withy/scene/orientation.hpp"
#include "withy/scene/units.hpp"

namespace withy {
namespace {

std::string bracketed(const std::string& unit) {
  return unit.empty() || unit == "1" ? "" : " [" + unit_text(unit) + "]";
}

std::string range(const ParameterSpec& spec) {
  std::string text;
  if (spec.minimum) text += fmt::format(" {} {}", spec.exclusive_minimum ? ">" : ">=", *spec.minimum);
  if (spec.maximum) text += fmt::format("{} <= {}", spec.minimum ? " and" : "", *spec.maximum);
  return text;
}

std::string list_of_units(const std::vector<std::string>& units) {
  std::string text;
  for (const std::string& u : units) text += (text.empty() ? "" : ", ") + unit_text(u);
  return text;
}

}  // namespace

const char* referent(ParameterSpec::Refers what) {
  using enum ParameterSpec::Refers;
  switch (what) {
    case body:
      return "body";
    case hinge:
      return "hinge";
    case frame:
      return "frame";
    case load:
      return "load";
    case mode_family:
      return "mode family";
    case strain_kinematics:
      return "strain kinematics";
    case formulation:
      return "formulation";
    case motion:
      return "motion";
    case signal:
      return "signal";
    case input:
      return "load of type input";
    case nothing:
      break;
  }
  return "";
}

std::string unit_text(const std::string& unit) {
  if (unit == any_unit) return "the unit of what is compared";
  const std::string turning = unit_at_hinge(unit, false), sliding = unit_at_hinge(unit, true);
  return turning == sliding ? turning : fmt::format("{}, or {} of what slides", turning, sliding);
}

std::string expectation(const ParameterSpec& spec) {
  using enum ParameterSpec::Kind;
  switch (spec.kind) {
    case number:
      return "finite" + range(spec) + bracketed(spec.unit) +
             (spec.columns.empty() ? "" : fmt::format(", or a list of rows [{}]", list_of_units(spec.columns)));
    case integer:
      return "whole number" + range(spec);
    case boolean:
      return "true or false";
    case text:
      if (!spec.choices.empty() && spec.refers != ParameterSpec::Refers::nothing)
        return fmt::format("the name of a {}, or one of: {}", referent(spec.refers), listed(spec.choices));
      if (!spec.choices.empty()) return "one of: " + listed(spec.choices);
      if (!spec.unit.empty()) return "a name, or a number" + range(spec) + bracketed(spec.unit);
      if (spec.refers == ParameterSpec::Refers::mode_family) {
        return "the name of a mode family, or a map with its name and options";
      }
      if (spec.refers == ParameterSpec::Refers::formulation) {
        return "the name of a formulation, or a map with its kinematics and truncation";
      }
      if (spec.refers == ParameterSpec::Refers::motion) {
        return "the type of a motion, or a map with its type and options";
      }
      if (spec.refers != ParameterSpec::Refers::nothing) return fmt::format("the name of a {}", referent(spec.refers));
      return "text";
    case vector: {
      const std::string item = range(spec).empty() ? "" : ", each" + range(spec);
      if (is_orientation(spec))
        return "a unit quaternion [w, x, y, z], {axis: [x, y, z], angle: a} or {xyz: [a, b, c]}";
      if (spec.count == 0) return "a list of finite numbers" + item + bracketed(spec.unit);
      return fmt::format("a list of {} finite numbers{}{}", spec.count, item, bracketed(spec.unit));
    }
    case table:
      return fmt::format("a list of rows of {} finite numbers [{}], the first column increasing", spec.count,
                         list_of_units(spec.columns));
    case map:
      return "a map with " + listed(keys_of(spec.members));
    case named:
      return "a map of names, each with " + listed(keys_of(spec.members));
    case matrix:
      return "a list of rows of finite numbers, all of one length" + bracketed(spec.unit);
    case texts:
      return spec.refers == ParameterSpec::Refers::nothing
                 ? "a text, or a list of them"
                 : fmt::format("the name of a {}, or a list of names", referent(spec.refers));
  }
  return {};
}

std::string shown(const Value& value) {
  switch (value.kind()) {
    case Value::Kind::null:
      return "nothing";
    case Value::Kind::boolean:
      return value.boolean() ? "true" : "false";
    case Value::Kind::number:
      return std::isnan(value.number()) ? "nan" : fmt::format("{}", value.number());
    case Value::Kind::text:
      return in_quotes(value.text());
    case Value::Kind::list:
      return fmt::format("a list of {}", value.items().size());
    case Value::Kind::map:
      return "a map";
  }
  return {};
}

std::vector<std::string> keys_of(const Value& map) {
  std::vector<std::string> keys;
  for (const Value::Member& m : map.members()) keys.push_back(m.first);
  return keys;
}

std::vector<std::string> keys_of(const std::vector<ParameterSpec>& members) {
  std::vector<std::string> keys;
  for (const ParameterSpec& m : members) keys.push_back(m.key);
  return keys;
}

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string guess = nearest(name, candidates);
  if (!guess.empty()) return fmt::format("; did you mean '{}'?", guess);
  return candidates.empty() ? "; there is none" : "; known: " + listed(candidates);
}

std::string unknown_names(const std::vector<std::string>& names, const std::vector<std::string>& candidates) {
  if (names.size() == 1) return fmt::format("no '{}'{}", names[0], suggestion(names[0], candidates));
  std::string text, known;
  for (const std::string& name : names) {
    const std::string guess = nearest(name, candidates);
    text += fmt::format("{}no '{}'", text.empty() ? "" : ", ", name);
    if (!guess.empty())
      text += fmt::format(" (did you mean '{}'?)", guess);
    else
      known = suggestion(name, candidates);
  }
  return text + known;
}

Value placed(Value value, const Place& place) {
  value.set_place(place);
  if (value.kind() == Value::Kind::list) {
    std::vector<Value>& items = value.items();
    for (std::size_t i = 0; i < items.size(); ++i)
      items[i] = placed(std::move(items[i]), {place.line, place.column, fmt::format("{}/{}", place.path, i)});
  } else if (value.kind() == Value::Kind::map) {
    for (auto& [key, member] : value.members())
      member = placed(std::move(member), {place.line, place.column, place.path + "/" + key});
  }
  return value;
}

std::string axis_as_list(const Value& value) {
  if (value.kind() != Value::Kind::text) return "";
  std::string_view text = value.text();
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  constexpr std::string_view axes = "xyz";
  if (text.size() != 1 || axes.find(text) == std::string_view::npos) return "";
  std::array<int, 3> list{};
  list.at(axes.find(text)) = negative ? -1 : 1;
  return fmt::format(", as [{}]", fmt::join(list, ", "));
}

std::string known_elsewhere(const std::string& name, const std::vector<std::string>& ids) {
  static const std::map<std::string, std::string, std::less<>> methods = {
      {"rk45", "dopri5"}, {"RK45", "dopri5"}, {"ode45", "dopri5"}, {"DOP853", "dop853"}, {"ode15s", "cvode"},
      {"BDF", "cvode"},   {"bdf", "cvode"},   {"Radau", "radau"},  {"ode23tb", "radau"}};
  const auto method = methods.find(name);
  if (method != methods.end() && std::find(ids.begin(), ids.end(), method->second) != ids.end()) return method->second;
  return nearest(name, ids);
}

}  // namespace withy
