/// \file
/// What motors would have to give, as JSON, table and picture.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/study/inverse.hpp"

namespace withy {

/// How the run ended, and the demand on each drive.
nlohmann::ordered_json inverse_json(const Scene& scene, const RunSummary& summary, const study::InverseStudy& study);
/// A row a drive.
std::string inverse_text(const std::string& title, const Scene& scene, const RunSummary& summary,
                         const study::InverseStudy& study);
/// Effort over time, a panel a drive.
std::string inverse_picture(const std::string& title, const study::InverseStudy& study);

}  // namespace withy
