/// \file
/// What formulations are, for tables that name several.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/registry.hpp"

namespace withy {

/// A line for each name, once, in their order: what the formulation keeps and drops. Nothing of names that are no
/// plugin's.
std::string formulation_words(const std::vector<std::string>& names, Registry& registry);

}  // namespace withy
