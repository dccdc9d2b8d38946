/// \file
/// Loads that act in a narrow part of a turn, as the shadow of a tower does.
#pragma once

#include <string>

#include "withy/core/analysis/turn.hpp"
#include "withy/study/configuration.hpp"

namespace withy::study {

/// Looks at the efforts of all loads at 719 angles, where the fourteen of `check_turn` show nothing: what of these
/// changes makes the check `steady` or `constant` no longer. What acts in less than half a degree may be missed.
/// \returns the load's name; empty where there is none, or nothing turns
std::string meet_narrow_loads(const Configuration& configuration, const State& steady, TurnCheck& check);

/// How many equal instants of the period it takes to show what loads do in it: 15, 31, … 1023. \throws
/// std::domain_error naming a load of which these do not
std::size_t instants_of_loads(const Configuration& configuration, const State& steady, const Turning& turning);

}  // namespace withy::study
