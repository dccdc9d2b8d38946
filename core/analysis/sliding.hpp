/// \file
/// States about which hinges slide along a line, which no turn brings back.
#pragma once

#include "withy/core/analysis/steady_state.hpp"

namespace withy {

/// Whether hinges slide at the state, as a motion or who holds them has it.
bool slides(const TangentDynamics& dynamics, const State& state);

/// Whether a balance is one further along too, where the hinges go on with their rates: what a derivative at the state
/// does not tell where it is just at its least or greatest there, as that of a spring that a hinge slides past. True
/// where nothing slides.
bool slides_steadily(const TangentDynamics& dynamics, const State& state, const Held& held);

}  // namespace withy
