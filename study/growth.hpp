/// \file
/// What grows in a run that ended badly, and why.
#pragma once

#include <string>

#include "withy/study/prepared.hpp"

namespace withy::study {

/// The small motion about the last trusted state that grows fastest, and that about the start, the coordinate and the
/// force that the growth is by, and what the run's indicators say of that body: turning past its fundamental frequency,
/// or loaded past buckling. Empty where nothing grows within the time of the run, the mass matrix was the reason, or
/// the model is too large.
std::string growth_text(const Prepared& prepared, const RunSummary& summary);

}  // namespace withy::study
