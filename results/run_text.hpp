/// \file
/// What is told about a run: the short table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/core/simulation/simulate.hpp"
#include "withy/study/prepared.hpp"

namespace withy {

/// A run for people: outcome, final hinge coordinates, peaks, cost; ends with a line break.
std::string run_table(const study::Prepared& prepared, const RunSummary& summary);

/// The range of every output that the scene asks statistics of, a line each: those far below the greatest of the same
/// output and unit are left out. \param outputs as run.json has them
std::string extremes_text(const nlohmann::ordered_json& outputs);

/// A number for a table, to four places: "60.0051". Where these would say less than four digits it has four, "0.01047"
/// and "5.654e-05"; what has more digits than are known has an exponent.
std::string to_four_places(double value);

/// An angle [rad] in degrees, to four places likewise. What rounding leaves of a turn is zero.
std::string degrees_text(double angle);

/// A coordinate with its unit, angles in degrees: "60.0051 deg".
std::string readable(double value, const std::string& unit);

}  // namespace withy
