#include "withy/apps/withy/trade_threshold.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/measures.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/progress.hpp"
#include "withy/apps/withy/text_table.hpp"
#include "withy/apps/withy/trade_frequencies.hpp"
#include "withy/apps/withy/trade_limit.hpp"
#include "withy/apps/withy/trade_run.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t scanned = 9;  ///< values of the range that are looked at first

struct Interrupted {};

/// One model and, of frequencies, one mode.
struct Row {
  TradePoint point;
  std::string mode;
  Crossing crossing;
  double at_rest = 0;          ///< of a spin that begins at zero: the mode's frequency there [rad/s]; else 0
  std::vector<double> errors;  ///< at the values scanned
};

/// What the user asked for.
struct Question {
  Sweep range;
  double limit = 0;
  std::vector<TradePoint> points;
};

Question read_question(const TradeArguments& arguments) {
  Question q;
  const Accuracy limit = Accuracy::parse(arguments.limit);
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
  q.points = trade_points(axes);
  return q;
}

/// A point as it is at a value of the range.
TradePoint at_value(TradePoint point, const std::string& path, double value) {
  point.over.push_back(fmt::format("{}={}", path, value));
  return point;
}

/// Errors of whole runs, and the greatest error of a reference.
std::vector<Row> rows_of_runs(const TradeArguments& arguments, const Question& q, Json& reference) {
  std::vector<TradePoint> all;
  for (const double v : q.range.values)
    for (const TradePoint& p : q.points) all.push_back(at_value(p, q.range.path, v));
  TradeStudy study(arguments, all, {arguments.out, arguments.jobs});
  if (!study.run()) throw Interrupted();
  const auto error = [&](const TradePoint& point) {
    const TradeResult* r = study.result(point);
    if (r == nullptr) {
      study.add(point);
      if (!study.run()) throw Interrupted();
      r = study.result(point);
    }
    return r->completed() ? r->relative_error : INFINITY;
  };
  std::vector<Row> rows;
  for (const TradePoint& p : q.points) {
    Row row{p, "", {}, 0, {}};
    for (const double v : q.range.values) row.errors.push_back(error(at_value(p, q.range.path, v)));
    row.crossing =
        find_crossing([&](double v) { return error(at_value(p, q.range.path, v)); }, q.range.values, q.limit, 1e-3);
    rows.push_back(std::move(row));
  }
  double own = 0;
  for (const auto& [over, r] : study.references().items()) {
    reference = {{"formulation", r.at("formulation")}, {"modes", r.at("modes")}};
    own = std::max(own, r.at("relative_error").get<double>());
  }
  reference["relative_error"] = own;
  return rows;
}

/// Errors of natural frequencies.
std::vector<Row> rows_of_frequencies(const TradeArguments& arguments, const Question& q, Json& reference) {
  FrequencyStudy study(arguments, q.points, q.range);
  const bool from_rest = !q.range.spun().empty() && q.range.values.front() == 0;
  std::vector<Row> rows;
  Progress progress("trade", static_cast<double>(q.points.size()));
  for (const TradePoint& p : q.points) {
    for (const std::string& mode : study.names()) {
      if (interrupted()) throw Interrupted();
      Row row{p, mode, {}, from_rest ? study.reference_frequency(mode, 0) : 0, {}};
      const auto error = [&](double v) { return study.error(p, mode, v); };
      for (const double v : q.range.values) row.errors.push_back(error(v));
      row.crossing = find_crossing(error, q.range.values, q.limit, 1e-5);
      rows.push_back(std::move(row));
    }
    progress.at(static_cast<double>(&p - q.points.data() + 1));
  }
  reference = study.reference_json();
  return rows;
}

std::string outcome(const Row& row, const Question& q) {
  switch (row.crossing.kind) {
    case Crossing::Kind::passes:
      return row.crossing.fails ? "fails beyond" : "passes";
    case Crossing::Kind::holds:
      return fmt::format("holds to {:g}", q.range.values.back());
    case Crossing::Kind::exceeds:
      return fmt::format("{} at {:g}", row.crossing.fails ? "fails" : "above it", q.range.values.front());
  }
  return "";
}

/// What tells one row from another; `text` of a column that all rows share is left out.
std::vector<std::string> labels(const Row& row, const TradeArguments& arguments) {
  std::vector<std::string> cells = {row.point.formulation, std::to_string(row.point.modes)};
  if (arguments.axes.families.size() > 1 || !arguments.axes.families.front().empty()) cells.push_back(row.point.family);
  if (arguments.axes.over.size() > 1) {
    std::string over;
    for (const std::string& o : row.point.over) over += (over.empty() ? "" : " ") + o;
    cells.push_back(over);
  }
  if (arguments.measure == "frequencies") {
    cells.push_back(row.mode);
  } else {
    cells.push_back(row.point.integrator);
    cells.push_back(fmt::format("{:g}", row.point.tolerance));
  }
  return cells;
}

std::vector<std::string> label_heads(const TradeArguments& arguments) {
  std::vector<std::string> heads = {"formulation", "modes"};
  if (arguments.axes.families.size() > 1 || !arguments.axes.families.front().empty()) heads.emplace_back("family");
  if (arguments.axes.over.size() > 1) heads.emplace_back("over");
  if (arguments.measure == "frequencies")
    heads.emplace_back("mode");
  else
    heads.insert(heads.end(), {"integrator", "tolerance"});
  return heads;
}

std::string table_text(const std::vector<Row>& rows, const Question& q, const TradeArguments& arguments) {
  std::vector<std::string> heads = label_heads(arguments);
  for (std::string& h : heads)
    if (h != "modes" && h != "tolerance") h = "<" + h;
  heads.push_back(q.range.path);
  const bool from_rest = rows.front().at_rest > 0;
  if (from_rest) heads.emplace_back("over frequency\nat rest");
  heads.emplace_back("<");
  TextTable table(heads);
  for (const Row& row : rows) {
    const bool passes = row.crossing.kind == Crossing::Kind::passes;
    std::vector<std::string> cells = labels(row, arguments);
    cells.push_back(passes ? fmt::format("{:.4g}", row.crossing.value) : "-");
    if (from_rest) cells.push_back(passes ? fmt::format("{:.4f}", row.crossing.value / row.at_rest) : "-");
    cells.push_back(outcome(row, q));
    table.add(std::move(cells));
  }
  return table.str();
}

Json row_json(const Row& row, const Question& q) {
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
  const bool passes = row.crossing.kind == Crossing::Kind::passes;
  j["outcome"] = passes ? "passes" : row.crossing.kind == Crossing::Kind::holds ? "holds" : "exceeds";
  j["value"] = passes ? Json(row.crossing.value) : Json();
  if (row.at_rest > 0) j["over_frequency_at_rest"] = passes ? Json(row.crossing.value / row.at_rest) : Json();
  j["fails"] = row.crossing.fails;
  j["errors"] = Json::array();
  for (std::size_t k = 0; k < row.errors.size(); ++k) {
    const double e = row.errors[k];
    j["errors"].push_back({{"value", q.range.values[k]}, {"relative_error", std::isfinite(e) ? Json(e) : Json()}});
  }
  return j;
}

std::string csv_text(const std::vector<Row>& rows, const Question& q, const TradeArguments& arguments) {
  std::string text;
  for (const std::string& h : label_heads(arguments)) text += h + ",";
  text += q.range.path + ",outcome\n";
  for (const Row& row : rows) {
    for (const std::string& cell : labels(row, arguments)) text += '"' + cell + "\",";
    const bool passes = row.crossing.kind == Crossing::Kind::passes;
    text += fmt::format("{},{}\n", passes ? fmt::format("{}", row.crossing.value) : "", outcome(row, q));
  }
  return text;
}

/// Error over the value, one panel a mode.
std::string picture(const std::string& title, const std::vector<Row>& rows, const Question& q) {
  std::vector<std::string> modes, legend;
  std::vector<Panel> panels;
  for (const Row& row : rows) {
    const std::string name = fmt::format("{} {}", row.point.formulation, row.point.modes);
    const auto pen = static_cast<std::size_t>(std::find(legend.begin(), legend.end(), name) - legend.begin());
    if (pen == legend.size()) legend.push_back(name);
    const auto m = static_cast<std::size_t>(std::find(modes.begin(), modes.end(), row.mode) - modes.begin());
    if (m == modes.size()) {
      modes.push_back(row.mode);
      panels.push_back({q.range.path + (row.mode.empty() ? "" : ", frequency of " + row.mode),
                        "error [%]",
                        {0.1 * q.limit, 1e4 * q.limit},
                        {}});
      panels.back().log_y = true;
    }
    Curve curve;
    curve.pen = pen;
    for (std::size_t k = 0; k < row.errors.size() && std::isfinite(row.errors[k]); ++k) {
      curve.x.push_back(q.range.values[k]);
      curve.y.push_back(std::max(100 * row.errors[k], 1e-12));
    }
    curve.ends_early = !curve.x.empty() && curve.x.size() < row.errors.size();
    panels[m].curves.push_back(std::move(curve));
  }
  for (Panel& panel : panels) {
    Curve limit{{q.range.values.front(), q.range.values.back()}, {}, false, false, legend.size()};
    limit.y.assign(2, 100 * q.limit);
    panel.curves.push_back(limit);
  }
  legend.emplace_back("limit");
  return svg_plot(title, legend, panels);
}

}  // namespace

ExitStatus trade_threshold(const TradeArguments& arguments) {
  const Question q = read_question(arguments);
  const bool frequencies = arguments.measure == "frequencies";
  Json reference;
  std::vector<Row> rows;
  try {
    rows = frequencies ? rows_of_frequencies(arguments, q, reference) : rows_of_runs(arguments, q, reference);
  } catch (const Interrupted&) {
    return ExitStatus::interrupted;
  }
  Json j{{"scene", arguments.scene}, {"limit", q.limit},       {"measure", arguments.measure},
         {"path", q.range.path},     {"reference", reference}, {"thresholds", Json::array()}};
  for (const Row& row : rows) j["thresholds"].push_back(row_json(row, q));
  const std::string title = fmt::format("{}: where the error of {} passes {:g} %", arguments.scene,
                                        frequencies ? "frequencies" : "hinges or tips", 100 * q.limit);
  if (!arguments.out.empty()) {
    const std::filesystem::path folder = arguments.out;
    std::filesystem::create_directories(folder);
    write_file(folder / "limit.json", json_text(j));
    write_file(folder / "limit.csv", csv_text(rows, q, arguments));
    write_file(folder / "limit.svg", picture(title, rows, q));
  }
  if (arguments.json) {
    print(json_text(j));
    return ExitStatus::done;
  }
  std::string text = title + "\n\n" + table_text(rows, q, arguments) +
                     fmt::format("\nReference: {}, {} modes; its own error, against one mode less{}: {:.2g} %.\n",
                                 reference.at("formulation").get<std::string>(), reference.at("modes").get<int>(),
                                 frequencies ? "" : " and ten times the tolerance",
                                 100 * reference.at("relative_error").get<double>());
  if (!arguments.out.empty()) text += "\nlimit.csv, limit.svg and limit.json in " + arguments.out + '\n';
  print(text);
  return ExitStatus::done;
}

}  // namespace withy::app
