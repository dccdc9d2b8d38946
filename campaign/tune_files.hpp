/// \file
/// Fits to measured data as text, JSON, table and picture.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/campaign/tune.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy::campaign {

/// What `withy tune --json` prints.
nlohmann::ordered_json tune_json(const TuneResult& result);
/// Parameters, residuals, what is not determined, how the search went.
std::string tune_text(const TuneResult& result, const std::string& title);
/// A line a time: of each column what was measured, the scene's own run and the fitted one.
std::string tune_csv(const TuneResult& result);
/// A panel a column over time: dots are measured, lines the scene's own run and the fitted one.
Picture tune_picture(const TuneResult& result, const std::string& title);

}  // namespace withy::campaign
