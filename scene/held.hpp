/// \file
/// What loads hold between instants, as a written state has it.
#pragma once

#include "withy/core/model/model.hpp"
#include "withy/scene/check.hpp"

namespace withy {

/// Reads `held` of a state: of every load that holds numbers their list, as it was written. A run from the state on
/// goes on with them. \returns false where there is a problem, which the checker's diagnostics then have.
bool read_held(const Value& value, const Model& model, const Checker& checker, State& state);

}  // namespace withy
