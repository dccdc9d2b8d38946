/// \file
/// Makes tables of a store: every case, statistics, sensitivities, what failed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "withy/campaign/estimates.hpp"
#include "withy/campaign/store.hpp"

namespace withy::campaign {

/// What was written beside the table.
struct Collected {
  std::uint64_t cases = 0, done = 0, failed = 0, lost = 0;
  bool statistics = false, indices = false, histories = false;
  Estimate failed_share;  ///< of the cases that are done
};

/// Writes into the store, each file whole or not at all: table.csv, a row a case in the order of the plan; failed.csv,
/// with the command that repeats each; statistics.csv of every point of the grids, where values are drawn; indices.csv
/// of the designs that have them; histories.csv and histories.svg, percentiles over the cases at each time of what is
/// kept over time. The same bytes for the same results. Memory: eight bytes a case, and 64 MB.
/// \throws ResultsError, std::system_error
Collected collect(const std::filesystem::path& store);

}  // namespace withy::campaign
