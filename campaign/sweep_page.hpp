/// \file
/// What the page of a sweep shows.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "withy/campaign/collect.hpp"

namespace withy::campaign {

/// Of the tables that collect() wrote: each column's range, quantiles and histogram over the completed cases, of a
/// large sweep over every so many; envelopes of results over what varies; some hundred whole cases; statistics, indices
/// and failures. Memory: 64 MB. \throws std::system_error
nlohmann::ordered_json sweep_page(const std::filesystem::path& store, const Collected& collected);

/// The same as report.html in the store, where this build holds the page.
void write_sweep_page(const std::filesystem::path& store, const Collected& collected);

}  // namespace withy::campaign
