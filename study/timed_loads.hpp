/// \file
/// Loads that change with time themselves.
#pragma once

#include <string>
#include <vector>

#include "withy/study/configuration.hpp"

namespace withy::study {

/// Loads whose efforts on what is free are others at other times up to the end of the run with everything as it is: a
/// sine, a table, axes that turn. Nothing that is balanced now stays so.
std::vector<std::string> timed_loads(const Configuration& configuration, const State& state);
/// Whether the equations of small motions about the state are others soon after, too: a controller's reference and a
/// force that only time changes leave them as they are, and growth and decay are what they say.
/// \param now those at the state
bool small_motions_change(const Configuration& configuration, const State& state, const Tangents& now);

}  // namespace withy::study
