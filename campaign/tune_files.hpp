/// \file
/// Fits to measured data as text, JSON, table and picture.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/campaign/tune.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy::campaign {

/// What `withy tune --json` prints.
nlohmann::ordered_json tune_json(const TuneResult& result);
/// The same on one line, for callers that read it themselves.
std::string tune_json_line(const TuneResult& result);
/// Parameters, residuals, what is not determined, how the search went.
std::string tune_text(const TuneResult& result, const std::string& title);
/// What an interrupted search had come to, with the values that `--set` takes, to go on from; empty where no run ended.
std::string interrupted_text(const TuneResult& result);
/// A line a time: of each column what was measured, the scene's own run and the fitted one.
std::string tune_csv(const TuneResult& result);
/// A panel a column over time: dots are measured, lines the scene's own run and the fitted one.
Picture tune_picture(const TuneResult& result, const std::string& title);

/// The files of a fit in its folder: JSON, table, picture and their page.
std::vector<std::string> tune_content();
/// Writes them; of data that there is no fit to, the JSON alone. \param data its file \throws std::system_error
void write_tune(const std::filesystem::path& folder, const TuneResult& result, const std::string& title,
                const std::string& data);

}  // namespace withy::campaign
