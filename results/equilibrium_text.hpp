/// \file
/// A steady state as JSON and in words.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/study/equilibrium.hpp"

namespace withy {

/// Outcome, efforts, state, deflections, whether it stays, its distance from the next model up.
nlohmann::ordered_json equilibrium_json(const study::Configuration& configuration, const study::Equilibrium& found);
/// Hinges with their coordinates, rates and efforts; deflections of tips. Where there is such a state.
std::string equilibrium_text(const study::Configuration& configuration, const study::Equilibrium& found);

}  // namespace withy
