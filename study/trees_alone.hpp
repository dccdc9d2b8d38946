/// \file
/// What knows trees alone: analyses that would leave closed loops out.
#pragma once

#include "withy/study/prepared.hpp"

namespace withy::study {

/// \throws InputError where the scene has constraints, which the analysis, named as "'withy modes'", knows nothing of.
void refuse_loops(const Prepared& prepared, const char* analysis);

}  // namespace withy::study
