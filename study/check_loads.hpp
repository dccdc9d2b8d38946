/// \file
/// Whether the loads of a scene are right about themselves.
#pragma once

#include "withy/core/plugin/state.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// Refuses a load that is wrong about its derivatives near a state, whose discrete states are set (false_derivative).
/// Loads whose laws are not the engine's own are not asked. \throws SceneError with the load's place
void check_load_derivatives(const Prepared& prepared, const State& state);

/// The same at the start of a run; and a load that has no numbers there where it switches, or for its discrete states.
/// \throws SceneError with the load's place
void check_loads(const Prepared& prepared);

}  // namespace withy::study
