#include "withy/results/terms_files.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/results/csv.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json terms_json(const Scene& scene, const RunSummary& summary, const study::TermSizes& ledger) {
  Json j{{"scene", scene.file},        {"formulation", scene.formulation_name}, {"status", name(summary.status)},
         {"message", summary.message}, {"outputs", ledger.times.size()},        {"unit", "N/sqrt(kg)"},
         {"groups", Json::object()}};
  for (std::size_t g = 0; g < ledger.groups.size(); ++g) {
    Json& group = j["groups"][ledger.groups[g].name];
    for (std::size_t k = 0; k < terms_of_motion; ++k)
      group[std::string(name(static_cast<Term>(k)))] = {{"rms", ledger.rms(g, k)}, {"peak", ledger.peak(g, k)}};
  }
  j["left_out"] = {{"of", ledger.richest}, {"by", Json::object()}};
  for (const study::LeftOutBy& by : ledger.left_out) {
    Json& groups = j["left_out"]["by"][by.formulation];
    for (std::size_t g = 0; g < ledger.groups.size(); ++g)
      groups[ledger.groups[g].name] = {{"rms", by.rms(g)}, {"peak", by.peak(g)}};
  }
  return j;
}

std::string terms_csv(const study::TermSizes& ledger) {
  std::vector<Column> columns{{"t", "s"}};
  for (const CoordinateGroup& g : ledger.groups) {
    for (std::size_t k = 0; k < terms_of_motion; ++k)
      columns.push_back({g.name + '.' + std::string(name(static_cast<Term>(k))), "N/sqrt(kg)"});
  }
  std::string text = csv_head(columns);
  for (std::size_t i = 0; i < ledger.times.size(); ++i) {
    std::vector<double> row{ledger.times[i]};
    for (const auto& group : ledger.sizes) {
      for (const auto& sizes : group) row.push_back(sizes[i]);
    }
    text += csv_line(row);
  }
  return text;
}

Picture terms_picture(const std::string& title, const study::TermSizes& ledger) {
  std::vector<std::string> legend;
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < terms_of_motion; ++k) {
    if (ledger.absent(k)) continue;
    shown.push_back(k);
    legend.emplace_back(name(static_cast<Term>(k)));
  }
  std::vector<Panel> panels;
  for (std::size_t g = 0; g < ledger.groups.size(); ++g) {
    const double top = std::max(ledger.greatest_peak(g), 1e-300);
    Panel panel{"time [s]", ledger.groups[g].name + " [N/sqrt(kg)]", {1e-6 * top, top}, {}};
    panel.log_y = true;
    if (!ledger.times.empty()) panel.x_range = {ledger.times.front(), ledger.times.back()};
    for (std::size_t pen = 0; pen < shown.size(); ++pen) {
      const std::size_t k = shown[pen];
      Curve curve;
      curve.pen = pen;
      // Terms are differences of sums as large as the greatest: what is rounding beside it is none.
      for (std::size_t i = 0; i < ledger.times.size(); ++i)
        append_in_decades(curve, ledger.times[i], ledger.sizes[g][k][i], rounding_in_pictures * top);
      if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
    }
    panels.push_back(std::move(panel));
  }
  return {title, legend, panels};
}

}  // namespace withy
