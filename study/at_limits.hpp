/// \file
/// Loads that are at their limits where small motions are looked at.
#pragma once

#include <string>
#include <vector>

#include "withy/study/configuration.hpp"

namespace withy::study {

/// Names of the loads that have reached a limit in a state, of their command, its rate or a speed: small motions do not
/// feel what they would do without it. Of sampled ones as of a sample there. Empty where a state has no finite
/// accelerations.
std::vector<std::string> at_limits(const Configuration& configuration, const State& state);

/// The same in a sentence; empty where there are none.
std::string at_limits_text(const std::vector<std::string>& loads);

}  // namespace withy::study
