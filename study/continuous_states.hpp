/// \file
/// What analyses that know of displacements alone say to loads with differential equations of their own.
#pragma once

#include "withy/study/prepared.hpp"

namespace withy::study {

/// \param analysis as "modes"
/// \throws InputError where a load has continuous states.
void refuse_continuous_states(const Prepared& prepared, const char* analysis);

}  // namespace withy::study
