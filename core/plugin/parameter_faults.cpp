#include "withy/core/plugin/parameter_faults.hpp"

#include <algorithm>
#include <cmath>

namespace withy {
namespace {

using Kind = ParameterSpec::Kind;

bool holds_nothing(const ParameterSpec& spec) {
  if ((spec.minimum && std::isnan(*spec.minimum)) || (spec.maximum && std::isnan(*spec.maximum))) return true;
  if (!spec.minimum || !spec.maximum) return false;
  return spec.exclusive_minimum ? *spec.minimum >= *spec.maximum : *spec.minimum > *spec.maximum;
}

bool is_within(double x, const ParameterSpec& spec) {
  if (!std::isfinite(x)) return false;
  if (spec.minimum && (spec.exclusive_minimum ? x <= *spec.minimum : x < *spec.minimum)) return false;
  return !spec.maximum || x <= *spec.maximum;
}

/// A number, or a text with a unit, which only the reader can tell.
std::string number_fault(const Value& value, const ParameterSpec& spec) {
  if (value.kind() == Value::Kind::text && spec.kind != Kind::integer) return {};
  if (value.kind() != Value::Kind::number) return "is of another kind";
  if (!is_within(value.number(), spec)) return "is not within its range";
  const bool whole = spec.kind != Kind::integer || std::floor(value.number()) == value.number();
  return whole ? "" : "is no whole number";
}

std::string list_fault(const Value& value, const ParameterSpec& spec) {
  if (value.kind() != Value::Kind::list) return "is of another kind";
  if (spec.kind != Kind::vector) return {};
  if (spec.count != 0 && value.items().size() != spec.count) return "has another count of numbers";
  for (const Value& item : value.items())
    if (std::string fault = number_fault(item, spec); !fault.empty()) return "has a number that " + fault;
  return {};
}

std::string text_fault(const Value& value, const ParameterSpec& spec) {
  using enum ParameterSpec::Refers;
  const bool plugin = spec.refers == mode_family || spec.refers == formulation || spec.refers == motion;
  if (plugin && value.kind() == Value::Kind::map) return {};
  if (!spec.unit.empty() && (value.kind() == Value::Kind::number || value.kind() == Value::Kind::text)) return {};
  if (value.kind() != Value::Kind::text) return "is of another kind";
  const bool chosen = std::find(spec.choices.begin(), spec.choices.end(), value.text()) != spec.choices.end();
  return spec.choices.empty() || spec.refers != nothing || chosen ? "" : "is none of its choices";
}

/// What is wrong with a default, as a predicate; empty where nothing is.
std::string default_fault(const Value& value, const ParameterSpec& spec) {
  const auto of_kind = [&](Value::Kind kind) -> std::string {
    return value.kind() == kind ? "" : "is of another kind";
  };
  switch (spec.kind) {
    case Kind::number:
      return !spec.columns.empty() && value.kind() == Value::Kind::list ? "" : number_fault(value, spec);
    case Kind::integer:
      return number_fault(value, spec);
    case Kind::boolean:
      return of_kind(Value::Kind::boolean);
    case Kind::text:
      return text_fault(value, spec);
    case Kind::vector:
      return value.kind() == Value::Kind::map ? "" : list_fault(value, spec);  // an orientation may be a map
    case Kind::table:
    case Kind::matrix:
      return list_fault(value, spec);
    case Kind::map:
    case Kind::named:
      return of_kind(Value::Kind::map);
    case Kind::texts:
      return value.kind() == Value::Kind::list ? "" : text_fault(value, spec);
  }
  return "is of a kind that there is not";
}

/// What is wrong with one parameter, as a predicate; empty where nothing is.
std::string spec_fault(const ParameterSpec& spec) {
  const bool rows = spec.kind == Kind::table || (spec.kind == Kind::number && !spec.columns.empty());
  if (rows && (spec.columns.empty() || spec.count != spec.columns.size())) return "is a table without columns";
  if (holds_nothing(spec)) return "has a range that holds no number";
  if (spec.role == ParameterSpec::Role::modes && spec.kind != Kind::integer)
    return "is to be a number of modes and is no integer";
  if (spec.role == ParameterSpec::Role::bending_family && spec.kind != Kind::text)
    return "is to be a family of modes and is no text";
  if (!spec.fallback) return {};
  const std::string fault = default_fault(*spec.fallback, spec);
  return fault.empty() ? "" : "has a default that " + fault;
}

std::string faults_within(const std::vector<ParameterSpec>& parameters, const std::string& path) {
  // With every start of a program: no text is made where nothing is wrong.
  for (auto spec = parameters.begin(); spec != parameters.end(); ++spec) {
    const auto named = [&](const std::string& fault) { return "parameter '" + path + spec->key + "' " + fault; };
    if (spec->key.empty()) return named("has no key");
    if (std::any_of(parameters.begin(), spec, [&](const ParameterSpec& other) { return other.key == spec->key; }))
      return named("stands twice");
    if (const std::string fault = spec_fault(*spec); !fault.empty()) return named(fault);
    if (spec->members.empty()) continue;
    if (std::string fault = faults_within(spec->members, path + spec->key + "."); !fault.empty()) return fault;
  }
  return {};
}

}  // namespace

std::string parameter_fault(const std::vector<ParameterSpec>& parameters) { return faults_within(parameters, ""); }

}  // namespace withy
