/// \file
/// Which scenes the solver of a host can integrate.
#pragma once

#include "withy/study/prepared.hpp"

namespace withy::fmi {

/// \throws study::InputError where FMUs of the scene are for co-simulation alone: it closes loops, or a host sets where
/// a hinge is at the end of a step
void refuse_model_exchange(const study::Prepared& prepared);

}  // namespace withy::fmi
