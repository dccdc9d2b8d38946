#include "withy/results/json_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "withy/scene/units.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

const char* kind_text(ParameterSpec::Kind kind) {
  switch (kind) {
    case ParameterSpec::Kind::number:
      return "number";
    case ParameterSpec::Kind::integer:
      return "integer";
    case ParameterSpec::Kind::boolean:
      return "boolean";
    case ParameterSpec::Kind::text:
      return "text";
    case ParameterSpec::Kind::vector:
      return "vector";
    case ParameterSpec::Kind::table:
      return "table";
    case ParameterSpec::Kind::map:
      return "map";
    case ParameterSpec::Kind::named:
      return "named maps";
    case ParameterSpec::Kind::matrix:
      return "matrix";
    case ParameterSpec::Kind::texts:
      return "texts";
  }
  return "";
}

}  // namespace

std::string json_text(const Json& json) {
  // File names need not be UTF-8; JSON has to be.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string json_line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string plain_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.is_number_float() ? fmt::format("{}", value.get<double>()) : value.dump();
}

Json parameter_json(const ParameterSpec& p) {
  Json j{{"key", p.key}, {"kind", kind_text(p.kind)}};
  if (!p.unit.empty() && p.unit != any_unit) j["unit"] = unit_at_hinge(p.unit, false);
  if (unit_at_hinge(p.unit, true) != unit_at_hinge(p.unit, false)) j["unit_sliding"] = unit_at_hinge(p.unit, true);
  j["meaning"] = p.meaning;
  j["required"] = p.required;
  if (p.fallback) j["default"] = value_json(*p.fallback);
  if (p.minimum) j[p.exclusive_minimum ? "above" : "least"] = *p.minimum;
  if (p.maximum) j["most"] = *p.maximum;
  if (!p.choices.empty()) j["choices"] = p.choices;
  if (p.count > 0) j["count"] = p.count;
  for (const std::string& column : p.columns) j["columns"].push_back(unit_at_hinge(column, false));
  for (const ParameterSpec& member : p.members) j["members"].push_back(parameter_json(member));
  return j;
}

}  // namespace withy
