/// \file
/// Why runs of two models of a scene have no common steps.
#pragma once

#include <string>

#include "withy/core/model/model.hpp"

namespace withy::study {

/// What of a model with switches (`has_switches`) keeps a run of it from being measured against one of another model,
/// in a clause: an event that acts, a load that switches, or an event that does nothing but is dealt with as those that
/// act are. The last may be left out, and the clause says how.
std::string own_instants(const Model& model);

}  // namespace withy::study
