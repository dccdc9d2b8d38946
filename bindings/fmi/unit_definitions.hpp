/// \file
/// Units of variables by the base units of the SI.
#pragma once

#include "withy/bindings/fmi/variables.hpp"
#include "withy/bindings/fmi/xml.hpp"

namespace withy::fmi {

/// UnitDefinitions of every unit that a variable has; the same in both versions.
void write_units(Xml& xml, const Variables& variables);

}  // namespace withy::fmi
