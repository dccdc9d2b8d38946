/// \file
/// Thresholds of a trade study as JSON, table and picture.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/study/threshold.hpp"

namespace withy {

/// "passes", "fails beyond", "holds to 3.5", "above it at 0", "fails at 0".
std::string threshold_outcome(const study::Threshold& row, const study::Sweep& range);
/// An element of "thresholds" in limit.json.
nlohmann::ordered_json threshold_json(const study::Threshold& row, const study::Sweep& range);
/// The content of limit.json. \param measure whose error it is, as "frequencies"
nlohmann::ordered_json thresholds_json(const std::string& scene, const std::string& measure, double limit,
                                       const study::Sweep& range, const study::Thresholds& thresholds);
/// What tells the rows of a study apart, a column each.
struct ThresholdLabels {
  bool families = false, overs = false, frequencies = false;
  [[nodiscard]] std::vector<std::string> heads() const;
  [[nodiscard]] std::vector<std::string> of(const study::Threshold& row) const;
};
/// "arm.yaml: where the error of frequencies passes 1 %".
std::string threshold_title(const std::string& scene, bool frequencies, double limit);
/// A row a model with the value at which it passes the limit; below, the reference and its own error.
std::string threshold_text(const std::string& title, const study::Thresholds& thresholds, const study::Sweep& range,
                           const ThresholdLabels& labels);
/// A line a row.
std::string threshold_csv(const std::vector<study::Threshold>& rows, const study::Sweep& range,
                          const ThresholdLabels& labels);
/// Error over the value, one panel a mode.
std::string threshold_picture(const std::string& title, const std::vector<study::Threshold>& rows,
                              const study::Sweep& range, double limit);

/// The files of thresholds in their folder: JSON, table, picture.
std::vector<std::string> threshold_content();
/// Writes them. \param content of limit.json \throws std::system_error
void write_thresholds(const std::filesystem::path& folder, const nlohmann::ordered_json& content,
                      const std::string& title, const study::Thresholds& thresholds, const study::Sweep& range,
                      double limit, const ThresholdLabels& labels);

}  // namespace withy
