/// \file
/// What analyses that know of displacements alone say to loads that have states of their own.
#pragma once

#include "withy/study/prepared.hpp"

namespace withy::study {

/// \param analysis as "modes"
/// \throws InputError where a load has continuous states or is sampled.
void refuse_states_of_loads(const Prepared& prepared, const char* analysis);

}  // namespace withy::study
