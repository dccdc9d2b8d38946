/// \file
/// The fastest small motion of a tree whose loops are closed, with everything that acts on it.
#pragma once

#include "withy/core/analysis/fastest_pole.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

/// As fastest_pole, of the motions about a state that keep the loops closed, by differences along these: what
/// multipliers do as loops turn is in it. No cause is told; `of_load` where the pole is notably beyond the fastest
/// vibration of modes alone, or where a load has states of its own.
/// \param equations of closed loops (ClosedLoops)
/// \param resting speeds that stay as they are beside the driven ones; empty: none
/// \throws std::domain_error where the state cannot be evaluated, or anything is not finite.
FastestPole fastest_pole_of_loops(const Model& model, const EquationsOfMotion& equations, const State& state,
                                  const Held& resting = {});

}  // namespace withy
