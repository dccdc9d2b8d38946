/// \file
/// What its user can do about a run that ended badly.
#pragma once

#include <string>

#include "withy/study/prepared.hpp"

namespace withy::study {

/// A sentence that begins with "What to do:", for the message of a run that diverged, came to a singular mass matrix or
/// to steps below the resolution of time, is inaccurate or too stiff for its integrator; empty for all others.
std::string remedy_text(const Prepared& prepared, const RunSummary& summary);

/// The `min_step` that the scene gives its integrator, where that and not the resolution of time is the least step at a
/// time [s]; null where it is not.
const Value* least_step(const Scene& scene, double time);

}  // namespace withy::study
