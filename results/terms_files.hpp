/// \file
/// The sizes of terms along a run as JSON, table and picture.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/results/svg_plot.hpp"
#include "withy/study/term_study.hpp"

namespace withy {

/// The content of terms.json.
nlohmann::ordered_json terms_json(const Scene& scene, const RunSummary& summary, const study::TermSizes& sizes);
/// A line an output, a column a group and term.
std::string terms_csv(const study::TermSizes& sizes);
/// Sizes over time in decades, six a panel.
Picture terms_picture(const std::string& title, const study::TermSizes& sizes);

}  // namespace withy
