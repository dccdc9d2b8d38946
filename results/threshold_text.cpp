#include <fmt/format.h>

#include "withy/results/text_table.hpp"
#include "withy/results/threshold_files.hpp"

namespace withy {
namespace {

std::string crossings_text(const std::vector<study::Threshold>& rows, const study::Sweep& range,
                           const ThresholdLabels& labels) {
  std::vector<std::string> heads = labels.heads();
  for (std::string& h : heads)
    if (h != "modes" && h != "tolerance") h = "<" + h;
  heads.push_back(range.path);
  const bool from_rest = rows.front().at_rest > 0;
  if (from_rest) heads.emplace_back("over frequency\nat rest");
  heads.emplace_back("<");
  TextTable table(heads);
  for (const study::Threshold& row : rows) {
    const bool passes = row.crossing.kind == study::Crossing::Kind::passes;
    std::vector<std::string> cells = labels.of(row);
    cells.push_back(passes ? fmt::format("{:.4g}", row.crossing.value) : "-");
    if (from_rest) cells.push_back(passes ? fmt::format("{:.4f}", row.crossing.value / row.at_rest) : "-");
    cells.push_back(threshold_outcome(row, range));
    table.add(std::move(cells));
  }
  return table.str();
}

}  // namespace

std::string threshold_title(const std::string& scene, bool frequencies, double limit) {
  return fmt::format("{}: where the error of {} passes {:g} %", scene, frequencies ? "frequencies" : "the worst output",
                     100 * limit);
}

std::string threshold_text(const std::string& title, const study::Thresholds& thresholds, const study::Sweep& range,
                           const ThresholdLabels& labels) {
  const std::string frozen =
      thresholds.frozen_from
          ? fmt::format(
                "\nAt {} = {:g}, the least such value looked at, the equations of small motions change over a turn or "
                "with "
                "time: frequencies are those of one frozen angle there (withy modes --floquet looks at the whole "
                "turn).\n",
                range.path, *thresholds.frozen_from)
          : std::string();
  return title + "\n\n" + crossings_text(thresholds.rows, range, labels) + frozen +
         fmt::format("\nReference: {}, {} modes; its own error, against one mode less{}: {:.2g} %.\n",
                     thresholds.reference, thresholds.reference_modes,
                     labels.frequencies ? "" : " and ten times the tolerance", 100 * thresholds.reference_error);
}

}  // namespace withy
