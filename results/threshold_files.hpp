/// \file
/// Thresholds of a trade study as JSON, table and picture.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/study/threshold.hpp"

namespace withy {

/// "passes", "fails beyond", "holds to 3.5", "above it at 0", "fails at 0".
std::string threshold_outcome(const study::Threshold& row, const study::Sweep& range);
/// An element of "thresholds" in limit.json.
nlohmann::ordered_json threshold_json(const study::Threshold& row, const study::Sweep& range);
/// What tells the rows of a study apart, a column each.
struct ThresholdLabels {
  bool families = false, overs = false, frequencies = false;
  [[nodiscard]] std::vector<std::string> heads() const;
  [[nodiscard]] std::vector<std::string> of(const study::Threshold& row) const;
};
/// A line a row.
std::string threshold_csv(const std::vector<study::Threshold>& rows, const study::Sweep& range,
                          const ThresholdLabels& labels);
/// Error over the value, one panel a mode.
std::string threshold_picture(const std::string& title, const std::vector<study::Threshold>& rows,
                              const study::Sweep& range, double limit);

}  // namespace withy
