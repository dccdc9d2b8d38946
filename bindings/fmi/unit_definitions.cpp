#include "withy/bindings/fmi/unit_definitions.hpp"

#include <optional>
#include <set>
#include <string>

#include "withy/scene/units.hpp"

namespace withy::fmi {

namespace {

using Attributes = Xml::Attributes;

/// What a unit is in those of the SI; nothing where it is text that a scene has for one (of an `expression`).
std::optional<Attributes> base_of(const std::string& name) {
  // Scenes are written without electrical units; motors show what they are at with them.
  if (name == "V") return Attributes{{"kg", "1"}, {"m", "2"}, {"s", "-3"}, {"A", "-1"}};
  if (name == "A") return Attributes{{"A", "1"}};
  const UnitReading reading = read_unit(name);
  if (!reading.unit) return {};
  const auto& [metre, kilogram, second, radian] = reading.unit->dimension;
  Attributes base;
  const auto add = [&](const char* key, int exponent) {
    if (exponent != 0) base.emplace_back(key, std::to_string(exponent));
  };
  add("kg", kilogram);
  add("m", metre);
  add("s", second);
  add("rad", radian);
  if (reading.unit->to_si(1) != 1) base.emplace_back("factor", number_text(reading.unit->to_si(1)));
  return base;
}

}  // namespace

void write_units(Xml& xml, const Variables& variables) {
  std::set<std::string> units;
  for (const Variable& v : variables.all)
    if (!v.unit.empty()) units.insert(v.unit);
  xml.open("UnitDefinitions");
  for (const std::string& name : units) {
    xml.open("Unit", {{"name", name}});
    if (const auto base = base_of(name)) xml.empty("BaseUnit", *base);
    xml.close();
  }
  xml.close();
}

}  // namespace withy::fmi
