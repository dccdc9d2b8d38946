/// \file
/// Correlations of a plan's values.
#pragma once

#include "withy/campaign/plan_reader.hpp"

namespace withy::campaign {

/// Reads `correlation` of a plan whose axes and design are known; what is wrong goes to the reader's diagnostics.
void read_correlation(const Value& given, const PlanReader& reader, Plan& plan);

}  // namespace withy::campaign
