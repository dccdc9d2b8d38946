/// \file
/// How a state stands against the limits of a formulation, without a run.
#pragma once

#include <vector>

#include "withy/study/indicators.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// As indicators, of a run that ends where it begins: what its motion makes of it later is not in them. None where the
/// state is none that a run can begin at.
std::vector<Indicator> indicators_at(const Prepared& prepared, const State& state);

}  // namespace withy::study
