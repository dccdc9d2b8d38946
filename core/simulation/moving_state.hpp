/// \file
/// A state in which everything moves, for measurements: one at rest flatters evaluations.
#pragma once

#include "withy/core/model/model.hpp"

namespace withy {

/// `state` with every hinge displaced by up to 0.3 rad or m and moving at up to 1 rad/s or m/s, every mode displaced by
/// up to 1e-3 and moving at up to 1e-2 of its units. The same model gives the same state. Driven hinges are where their
/// motions have them.
State moving_state(const Model& model, State state);

}  // namespace withy
