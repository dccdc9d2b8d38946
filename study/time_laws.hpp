/// \file
/// Which loads the time is in, and what a scene without them has to do without.
#pragma once

#include <string>
#include <vector>

#include "withy/core/analysis/turn.hpp"
#include "withy/study/configuration.hpp"

namespace withy::study {

/// Of loads that change with time those whose law has it: themselves, or what they measure, directly or through others
/// and outputs. Each once.
std::vector<std::string> with_the_time(const Configuration& configuration, const State& state, const Turning& turning,
                                       const std::vector<std::string>& loads);

/// What to take away with some loads, that the rest is a scene: they, and those that measure or act through one of
/// them, in the order of the scene. Empty where outputs, events or initial values name one of them, for then the scene
/// would be refused.
std::vector<std::string> taken_away_with(const Scene& scene, const std::vector<std::string>& loads);

/// "--set loads.a=null --set loads.b=null".
std::string set_to_null(const std::vector<std::string>& loads);

}  // namespace withy::study
