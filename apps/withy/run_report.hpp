/// \file
/// What is told about a run: run.json and the short table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/apps/withy/certificate.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::app {

/// The content of run.json, certificate included; see docs/command-line.md.
nlohmann::ordered_json run_json(const Engine& engine, const RunSummary& summary, const Evidence& evidence = {});

/// A run for people: outcome, final hinge coordinates, peaks, cost; ends with a line break.
std::string run_table(const Engine& engine, const RunSummary& summary);

/// "completed", or "diverged at 0.0523 s".
std::string outcome_text(const RunSummary& summary);
/// A coordinate with its unit, angles in degrees: "60.0051 deg".
std::string readable(double value, const std::string& unit);

}  // namespace withy::app
