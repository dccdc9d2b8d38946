/// \file
/// Effective masses of modes as JSON and as a table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/study/effective_mass.hpp"

namespace withy {

/// `total`, `sum` along the world's axes, and of each mode `hertz`, `mass`, `participation`.
nlohmann::ordered_json effective_mass_json(const study::EffectiveMasses& masses);
/// A row a mode, in shares of the total; those that move less than a thousandth along every axis are left out.
std::string effective_mass_text(const study::EffectiveMasses& masses);

}  // namespace withy
