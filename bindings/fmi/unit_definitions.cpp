#include "withy/bindings/fmi/unit_definitions.hpp"

#include <set>
#include <stdexcept>

#include "withy/scene/units.hpp"

namespace withy::fmi {

void write_units(Xml& xml, const Variables& variables) {
  std::set<std::string> units;
  for (const Variable& v : variables.all)
    if (!v.unit.empty()) units.insert(v.unit);
  xml.open("UnitDefinitions");
  for (const std::string& name : units) {
    const UnitReading reading = read_unit(name);
    if (!reading.unit) throw std::logic_error("unit '" + name + "': " + reading.problem);
    const auto& [metre, kilogram, second, radian] = reading.unit->dimension;
    Xml::Attributes base;
    const auto add = [&](const char* key, int exponent) {
      if (exponent != 0) base.emplace_back(key, std::to_string(exponent));
    };
    add("kg", kilogram);
    add("m", metre);
    add("s", second);
    add("rad", radian);
    if (reading.unit->to_si(1) != 1) base.emplace_back("factor", number_text(reading.unit->to_si(1)));
    xml.open("Unit", {{"name", name}}).empty("BaseUnit", base).close();
  }
  xml.close();
}

}  // namespace withy::fmi
