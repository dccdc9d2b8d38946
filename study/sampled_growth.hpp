/// \file
/// Whether what ended a run is a loop of sampled loads that is unstable.
#pragma once

#include <string>

#include "withy/study/prepared.hpp"

namespace withy::study {

/// What grows from sample to sample about the steady state near the scene's start, how fast it grows where the loads
/// hold what they hold there, and what to do. Empty where no load is sampled, nothing grows within the time of the run,
/// the run did not diverge, or there is no such state.
std::string sampled_growth_text(const Prepared& prepared, const RunSummary& summary);

}  // namespace withy::study
