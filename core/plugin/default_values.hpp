/// \file
/// Parameters of a plugin that a scene names without any.
#pragma once

#include <vector>

#include "withy/core/plugin/parameters.hpp"
#include "withy/core/plugin/value.hpp"

namespace withy {

/// A map of the defaults of those parameters that have one, at a place of a scene.
Value default_values(const std::vector<ParameterSpec>& specs, const Place& place);

}  // namespace withy
