#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/trade_axes.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/text_table.hpp"
#include "withy/results/threshold_files.hpp"
#include "withy/results/trade_files.hpp"
#include "withy/study/accuracy.hpp"

namespace withy::app {
namespace {

constexpr std::size_t scanned = 9;  ///< values of the range that are looked at first

/// What the user asked for.
struct Question {
  study::Sweep range;
  double limit = 0;
  TradeAxes axes;  ///< without the range
};

Question read_question(const TradeArguments& arguments) {
  Question q;
  const study::Accuracy limit = study::Accuracy::parse(arguments.limit);
  if (!limit.share || limit.angle || limit.length)
    throw InputError("--limit: got '" + arguments.limit + "'; need a relative error, as 1% or 0.01");
  q.limit = *limit.share;
  TradeAxes axes = arguments.axes;
  axes.over.clear();
  for (const std::string& over : arguments.axes.over) {
    const bool range = over.find(':') != std::string::npos;
    if (range && !q.range.none()) throw InputError("--over: with --limit one range is gone along; got '" + over + "'");
    if (range) q.range = parse_sweep(over, "--over", scanned);
    if (!range) axes.over.push_back(over);
  }
  if (q.range.none()) throw InputError("--limit: need the range that it is sought in, as --over spin.axle=0:4");
  if (q.range.values.front() == q.range.values.back()) throw InputError("--over: the range has no length");
  if (arguments.measure == "frequencies") {  // integration has no part in them
    axes.integrators = {"dopri5"};
    axes.tolerances = {1e-6};
  } else if (!q.range.spun().empty()) {
    throw InputError("--over: '" + q.range.path +
                     "' holds a hinge at a rate, which is for --measure frequencies; "
                     "give a path of the scene, as motions.spin.rate");
  }
  q.axes = std::move(axes);
  return q;
}

std::string table_text(const std::vector<study::Threshold>& rows, const study::Sweep& range,
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

std::optional<study::Thresholds> found(const Engine& engine, const TradeArguments& arguments, const Question& q) {
  const std::vector<study::Point> points = study::points_of(axes_of(q.axes, engine.registry()));
  const study::Control control = study_control("trade");
  if (arguments.measure == "frequencies") {
    const study::Holding holding = holding_of(engine.model(), arguments.lock, arguments.spin);
    return study::thresholds_of_frequencies(engine.prepared(), engine.registry(),
                                            {points, q.range, holding, arguments.count}, q.limit, control);
  }
  std::optional<TradeFolder> store;
  if (!arguments.out.empty())
    store.emplace(arguments.out, trade_fingerprint(engine.prepared(), points, engine.registry(), arguments.outputs));
  return study::thresholds_of_runs(engine.prepared(), engine.registry(), points, q.range, q.limit,
                                   {arguments.jobs, store ? &*store : nullptr, control, arguments.outputs});
}

nlohmann::ordered_json thresholds_json(const TradeArguments& arguments, const Question& q,
                                       const study::Thresholds& thresholds) {
  nlohmann::ordered_json j{{"scene", arguments.scene},
                           {"limit", q.limit},
                           {"measure", arguments.measure},
                           {"path", q.range.path},
                           {"reference",
                            {{"formulation", thresholds.reference},
                             {"modes", thresholds.reference_modes},
                             {"relative_error", thresholds.reference_error}}},
                           {"thresholds", nlohmann::ordered_json::array()}};
  for (const study::Threshold& row : thresholds.rows) j["thresholds"].push_back(threshold_json(row, q.range));
  return j;
}

}  // namespace

ExitStatus trade_threshold(const TradeArguments& arguments) {
  const Question q = read_question(arguments);
  const bool frequencies = arguments.measure == "frequencies";
  const Engine engine(arguments);
  const auto taken = take_folder(arguments, "trade", provenance_of(engine.scene(), engine.plugins()),
                                 {"limit.json", "limit.csv", "limit.svg"});
  const auto thresholds = found(engine, arguments, q);
  if (!thresholds) return ExitStatus::interrupted;
  const ThresholdLabels labels{arguments.axes.families.size() > 1 || !arguments.axes.families.front().empty(),
                               arguments.axes.over.size() > 1, frequencies};
  const nlohmann::ordered_json j = thresholds_json(arguments, q, *thresholds);
  const std::string title = fmt::format("{}: where the error of {} passes {:g} %", arguments.scene,
                                        frequencies ? "frequencies" : "hinges or tips", 100 * q.limit);
  if (!arguments.out.empty()) {
    const std::filesystem::path folder = arguments.out;
    write_file(folder / "limit.json", json_text(j));
    write_file(folder / "limit.csv", threshold_csv(thresholds->rows, q.range, labels));
    write_file(folder / "limit.svg", threshold_picture(title, thresholds->rows, q.range, q.limit));
  }
  if (arguments.json) {
    print(json_text(j));
    return ExitStatus::done;
  }
  std::string text = title + "\n\n" + table_text(thresholds->rows, q.range, labels) +
                     fmt::format("\nReference: {}, {} modes; its own error, against one mode less{}: {:.2g} %.\n",
                                 thresholds->reference, thresholds->reference_modes,
                                 frequencies ? "" : " and ten times the tolerance", 100 * thresholds->reference_error);
  if (!arguments.out.empty()) text += "\nlimit.csv, limit.svg and limit.json in " + arguments.out + '\n';
  print(text);
  return ExitStatus::done;
}

}  // namespace withy::app
