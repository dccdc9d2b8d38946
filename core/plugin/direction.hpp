/// \file
/// Directions in the parameters of plugins.
#pragma once

#include <optional>
#include <string_view>

#include "withy/core/plugin/registry.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy {

/// The unit vector along a parameter, a vector of three numbers and of any length; nothing after it is reported that it
/// has none.
std::optional<Vector3> direction_at(const Value& parameters, std::string_view key, const MakeContext& context);

}  // namespace withy
