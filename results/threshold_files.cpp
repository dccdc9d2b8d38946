#include "withy/results/threshold_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy {

using Json = nlohmann::ordered_json;

std::string threshold_outcome(const study::Threshold& row, const study::Sweep& range) {
  switch (row.crossing.kind) {
    case study::Crossing::Kind::passes:
      return row.crossing.fails ? "fails beyond" : "passes";
    case study::Crossing::Kind::holds:
      return fmt::format("holds to {:g}", range.values.back());
    case study::Crossing::Kind::exceeds:
      return fmt::format("{} at {:g}", row.crossing.fails ? "fails" : "above it", range.values.front());
  }
  return "";
}

std::vector<std::string> ThresholdLabels::heads() const {
  std::vector<std::string> heads = {"formulation", "modes"};
  if (families) heads.emplace_back("family");
  if (overs) heads.emplace_back("over");
  if (frequencies)
    heads.emplace_back("mode");
  else
    heads.insert(heads.end(), {"integrator", "tolerance"});
  return heads;
}

std::vector<std::string> ThresholdLabels::of(const study::Threshold& row) const {
  std::vector<std::string> cells = {row.point.formulation, std::to_string(row.point.modes)};
  if (families) cells.push_back(row.point.family);
  if (overs) {
    std::string over;
    for (const std::string& o : row.point.over) over += (over.empty() ? "" : " ") + o;
    cells.push_back(over);
  }
  if (frequencies) {
    cells.push_back(row.mode);
  } else {
    cells.push_back(row.point.integrator);
    cells.push_back(fmt::format("{:g}", row.point.tolerance));
  }
  return cells;
}

Json threshold_json(const study::Threshold& row, const study::Sweep& range) {
  Json j{{"formulation", row.point.formulation},
         {"modes", row.point.modes},
         {"family", row.point.family.empty() ? Json() : Json(row.point.family)},
         {"over", row.point.over}};
  if (row.mode.empty()) {
    j["integrator"] = row.point.integrator;
    j["tolerance"] = row.point.tolerance;
  } else {
    j["mode"] = row.mode;
  }
  const bool passes = row.crossing.kind == study::Crossing::Kind::passes;
  j["outcome"] = passes ? "passes" : row.crossing.kind == study::Crossing::Kind::holds ? "holds" : "exceeds";
  j["value"] = passes ? Json(row.crossing.value) : Json();
  if (row.at_rest > 0) j["over_frequency_at_rest"] = passes ? Json(row.crossing.value / row.at_rest) : Json();
  j["fails"] = row.crossing.fails;
  j["errors"] = Json::array();
  for (std::size_t k = 0; k < row.errors.size(); ++k) {
    const double e = row.errors[k];
    j["errors"].push_back({{"value", range.values[k]}, {"relative_error", std::isfinite(e) ? Json(e) : Json()}});
  }
  return j;
}

std::string threshold_csv(const std::vector<study::Threshold>& rows, const study::Sweep& range,
                          const ThresholdLabels& labels) {
  std::string text;
  for (const std::string& h : labels.heads()) text += h + ",";
  text += range.path + ",outcome\n";
  for (const study::Threshold& row : rows) {
    for (const std::string& cell : labels.of(row)) text += '"' + cell + "\",";
    const bool passes = row.crossing.kind == study::Crossing::Kind::passes;
    text += fmt::format("{},{}\n", passes ? fmt::format("{}", row.crossing.value) : "", threshold_outcome(row, range));
  }
  return text;
}

std::string threshold_picture(const std::string& title, const std::vector<study::Threshold>& rows,
                              const study::Sweep& range, double limit) {
  std::vector<std::string> modes, legend;
  std::vector<Panel> panels;
  for (const study::Threshold& row : rows) {
    const std::string name = fmt::format("{} {}", row.point.formulation, row.point.modes);
    const auto pen = static_cast<std::size_t>(std::find(legend.begin(), legend.end(), name) - legend.begin());
    if (pen == legend.size()) legend.push_back(name);
    const auto m = static_cast<std::size_t>(std::find(modes.begin(), modes.end(), row.mode) - modes.begin());
    if (m == modes.size()) {
      modes.push_back(row.mode);
      panels.push_back({range.path + (row.mode.empty() ? "" : ", frequency of " + row.mode),
                        "error [%]",
                        {0.1 * limit, 1e4 * limit},
                        {}});
      panels.back().log_y = true;
    }
    Curve curve;
    curve.pen = pen;
    // An error that is the rounding of the two that are compared is none.
    std::size_t k = 0;
    for (; k < row.errors.size() && std::isfinite(row.errors[k]); ++k)
      append_in_decades(curve, range.values[k], 100 * row.errors[k], 100 * rounding_in_pictures);
    curve.ends_early = !curve.x.empty() && k < row.errors.size();
    panels[m].curves.push_back(std::move(curve));
  }
  for (Panel& panel : panels) {
    Curve line{{range.values.front(), range.values.back()}, {}, false, false, legend.size()};
    line.y.assign(2, 100 * limit);
    panel.curves.push_back(line);
  }
  legend.emplace_back("limit");
  return svg_plot(title, legend, panels);
}

nlohmann::ordered_json thresholds_json(const std::string& scene, const std::string& measure, double limit,
                                       const study::Sweep& range, const study::Thresholds& thresholds) {
  nlohmann::ordered_json j{{"scene", scene},
                           {"limit", limit},
                           {"measure", measure},
                           {"path", range.path},
                           {"reference",
                            {{"formulation", thresholds.reference},
                             {"modes", thresholds.reference_modes},
                             {"relative_error", thresholds.reference_error}}},
                           {"frozen_from", thresholds.frozen_from ? Json(*thresholds.frozen_from) : Json()},
                           {"thresholds", nlohmann::ordered_json::array()}};
  for (const study::Threshold& row : thresholds.rows) j["thresholds"].push_back(threshold_json(row, range));
  return j;
}

std::vector<std::string> threshold_content() { return {"limit.json", "limit.csv", "limit.svg"}; }

void write_thresholds(const std::filesystem::path& folder, const Json& content, const std::string& title,
                      const study::Thresholds& thresholds, const study::Sweep& range, double limit,
                      const ThresholdLabels& labels) {
  write_file(folder / "limit.json", json_text(content));
  write_file(folder / "limit.csv", threshold_csv(thresholds.rows, range, labels));
  write_file(folder / "limit.svg", threshold_picture(title, thresholds.rows, range, limit));
}

}  // namespace withy
