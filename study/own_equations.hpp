/// \file
/// Whether a formulation's equations are those of its terms.
#pragma once

#include "withy/core/plugin/state.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// Small motions, steady states and what follows from them go by the terms that a formulation says it keeps
/// (Formulation::terms), not by the equations that it compiles. Compares the accelerations of both beside a state,
/// where all moves and is bent, of the tree without loads, motions and constraints; where either has none there, or the
/// formulation does not compile that tree, they are not compared.
/// \throws InputError where they differ by more than rounding.
void check_own_equations(const Prepared& prepared, const State& state);

}  // namespace withy::study
