/// \file
/// The certificate of a run as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "withy/study/certificate.hpp"

namespace withy {

/// The value of "certificate" in run.json; see docs/results.md.
nlohmann::ordered_json certificate_json(const Scene& scene, const RunSummary& summary,
                                        const study::Certificate& certificate);
/// The content of run.json.
nlohmann::ordered_json run_json(const Scene& scene, const RunSummary& summary, const study::Certificate& certificate);

/// Of hinges and tips, by their names, without the time up to which they are.
nlohmann::ordered_json named_distances_json(const study::NamedDistances& distances);
nlohmann::ordered_json families_json(const std::vector<study::BodyFamilies>& families);
nlohmann::ordered_json indicators_json(const std::vector<study::Indicator>& indicators);

}  // namespace withy
