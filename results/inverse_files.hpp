/// \file
/// What motors would have to give, as JSON, table and picture.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/study/inverse.hpp"

namespace withy {

/// How the run ended, and the demand on each drive. \param ignored columns of the motion's file that were left out
nlohmann::ordered_json inverse_json(const Scene& scene, const RunSummary& summary, const study::InverseStudy& study,
                                    const std::vector<std::string>& ignored);
/// A row a drive; then the first columns that were left out, and how many more.
std::string inverse_text(const std::string& title, const Scene& scene, const RunSummary& summary,
                         const study::InverseStudy& study, const std::vector<std::string>& ignored);
/// Effort over time, a panel a drive.
std::string inverse_picture(const std::string& title, const study::InverseStudy& study);

}  // namespace withy
