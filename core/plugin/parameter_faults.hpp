/// \file
/// Whether what plugins say of their parameters can be.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/parameters.hpp"

namespace withy {

/// Why no scene can be right, or the reader cannot go by it: a key that is missing or stands twice, a table without
/// columns, a range that holds nothing, a role of another kind of parameter, a default of another kind or outside of
/// the range or the choices. Units and the names that defaults refer to are the scene's to know. Members are looked at
/// as well. Empty where all can be.
/// \returns a clause that names the parameter by its path: "parameter 'a.b' has …"
std::string parameter_fault(const std::vector<ParameterSpec>& parameters);

}  // namespace withy
