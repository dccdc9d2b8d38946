/// \file
/// What analyses refuse that would leave a part of the scene out.
#pragma once

#include "withy/study/prepared.hpp"

namespace withy::study {

/// Of analyses that know trees alone.
/// \throws InputError where the scene has constraints, which the analysis, named as "'withy modes'", knows nothing of.
void refuse_loops(const Prepared& prepared, const char* analysis);

/// Of analyses that know displacements alone.
/// \param analysis as "modes"
/// \throws InputError where a load has continuous states or is sampled.
void refuse_states_of_loads(const Prepared& prepared, const char* analysis);

}  // namespace withy::study
