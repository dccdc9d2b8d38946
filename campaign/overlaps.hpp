/// \file
/// Paths of a plan that lead into each other: what one sets, another replaces.
#pragma once

#include <string>

#include "withy/campaign/plan_reader.hpp"

namespace withy::campaign {

/// Whether a path leads to a part of what another leads to: "gravity.1" of "gravity", but not "gravity" itself.
bool is_within(const std::string& path, const std::string& whole);

/// Reports each axis and each derived value that another of the plan replaces, all of it or a part that it gives, so
/// that the table would tell of values that no case had.
void check_overlaps(const Plan& plan, const PlanReader& reader);

}  // namespace withy::campaign
