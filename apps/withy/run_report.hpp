/// \file
/// What is told about a run: the short table.
#pragma once

#include <string>

#include "withy/core/simulation/simulate.hpp"
#include "withy/study/prepared.hpp"

namespace withy::app {

/// A run for people: outcome, final hinge coordinates, peaks, cost; ends with a line break.
std::string run_table(const study::Prepared& prepared, const RunSummary& summary);

/// A coordinate with its unit, angles in degrees: "60.0051 deg".
std::string readable(double value, const std::string& unit);

}  // namespace withy::app
