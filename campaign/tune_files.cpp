#include "withy/campaign/tune_files.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/results/csv.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/figures_page.hpp"
#include "withy/results/report/report_page.hpp"

namespace withy::campaign {
namespace {

using Json = nlohmann::ordered_json;

const char* state_name(FittedValue::State state) {
  switch (state) {
    case FittedValue::State::fitted:
      return "fitted";
    case FittedValue::State::at_bound:
      return "at-bound";
    case FittedValue::State::undetermined:
      return "undetermined";
  }
  return "";
}

Json number_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json parameter_json(const TuneResult& result, const FittedValue& p) {
  Json j = {{"path", p.tuned.path},
            {"unit", p.tuned.unit},
            {"start", p.tuned.start},
            {"value", p.value},
            {"state", state_name(p.state)},
            {"deviation", p.deviation ? Json(*p.deviation) : Json(nullptr)},
            {"bounds", {number_or_null(p.tuned.least), number_or_null(p.tuned.most)}}};
  if (p.state != FittedValue::State::undetermined) return j;
  j["same_as"] = Json::object();
  for (const auto& [other, factor] : p.same_as) j["same_as"][result.parameters[other].tuned.path] = factor;
  return j;
}

Json column_json(const MeasuredColumn& c, const ColumnFit& fit) {
  return {{"name", c.name},
          {"unit", c.unit},
          {"values", c.count()},
          {"weight_deviation", c.deviation},
          {"deviation_given", c.deviation_given},
          {"rms_before", fit.at_start.empty() ? Json(nullptr) : Json(fit.before)},
          {"rms_after", fit.after},
          {"neighbour_correlation", fit.correlation ? Json(*fit.correlation) : Json(nullptr)}};
}

/// What pictures and tables show an angle in.
struct Shown {
  double factor = 1;
  std::string unit;
};
Shown shown_in(const std::string& unit) {
  if (unit == "rad") return {180 / std::numbers::pi, "deg"};
  return {1, unit.empty() ? "1" : unit};
}

Curve curve_of(const std::vector<double>& t, const std::vector<double>& y, double factor, std::size_t pen) {
  Curve curve;
  curve.pen = pen;
  for (std::size_t i = 0; i < std::min(t.size(), y.size()); ++i) {
    if (!std::isfinite(y[i])) continue;
    curve.x.push_back(t[i]);
    curve.y.push_back(factor * y[i]);
  }
  return curve;
}

}  // namespace

Json tune_json(const TuneResult& result) {
  Json j = {{"converged", result.converged()}, {"trouble", result.trouble}, {"parameters", Json::array()}};
  for (const FittedValue& p : result.parameters) j["parameters"].push_back(parameter_json(result, p));
  j["correlation"] = result.correlation;
  j["singular_values"] = result.singular_values;
  j["data"] = {{"file", result.data.file}, {"values", result.data.count()}, {"ignored", result.data.ignored}};
  j["columns"] = Json::array();
  for (std::size_t c = 0; c < result.columns.size(); ++c)
    j["columns"].push_back(column_json(result.data.columns[c], result.columns[c]));
  j["residual_before"] = result.before;
  j["residual_after"] = result.after;
  j["starts"] = Json::array();
  for (const SearchEnd& s : result.starts)
    j["starts"].push_back({{"from", s.from},
                           {"to", s.to},
                           {"residual", number_or_null(s.residual)},
                           {"converged", s.converged},
                           {"reason", s.reason}});
  j["agreeing_starts"] = result.agreeing;
  j["runs"] = result.runs;
  j["failed_runs"] = result.failed;
  j["last_failure"] = result.last_failure;
  return j;
}

std::string tune_json_line(const TuneResult& result) { return json_line(tune_json(result)); }

std::string tune_csv(const TuneResult& result) {
  std::vector<Column> head = {{"t", "s"}};
  for (const MeasuredColumn& c : result.data.columns)
    for (const char* what : {".measured", ".before", ".fitted"}) head.push_back({c.name + what, c.unit});
  std::string text = csv_head(head);
  std::vector<double> row;
  for (std::size_t i = 0; i < result.data.times.size(); ++i) {
    row.assign(1, result.data.times[i]);
    for (std::size_t c = 0; c < result.columns.size(); ++c) {
      const ColumnFit& fit = result.columns[c];
      row.push_back(result.data.columns[c].values[i]);
      row.push_back(fit.at_start.empty() ? std::numeric_limits<double>::quiet_NaN() : fit.at_start[i]);
      row.push_back(fit.at_end[i]);
    }
    text += csv_line(row);
  }
  return text;
}

Picture tune_picture(const TuneResult& result, const std::string& title) {
  constexpr std::size_t before_pen = 7, fitted_pen = 6, measured_pen = 1;
  std::vector<Panel> panels;
  for (std::size_t c = 0; c < result.columns.size(); ++c) {
    const MeasuredColumn& column = result.data.columns[c];
    const ColumnFit& fit = result.columns[c];
    const Shown shown = shown_in(column.unit);
    Panel panel{"t [s]", column.name + " [" + shown.unit + "]", {1e300, -1e300}, {}, 220};
    if (!result.data.times.empty()) panel.x_range = {result.data.times.front(), result.data.times.back()};
    panel.curves = {curve_of(result.data.times, fit.at_start, shown.factor, before_pen),
                    curve_of(result.data.times, fit.at_end, shown.factor, fitted_pen),
                    curve_of(result.data.times, column.values, shown.factor, measured_pen)};
    panel.curves.back().points = true;
    panel.curves[0].name = "before", panel.curves[1].name = "fitted", panel.curves[2].name = "measured";
    for (const Curve& curve : panel.curves)
      for (const double y : curve.y)
        panel.y_range = {std::min(panel.y_range.first, y), std::max(panel.y_range.second, y)};
    panels.push_back(std::move(panel));
  }
  return {title, {}, panels};
}

std::vector<std::string> tune_content() { return {"tune.json", "fit.csv", "fit.svg", report_name}; }

void write_tune(const std::filesystem::path& folder, const TuneResult& result, const std::string& title,
                const std::string& data) {
  write_file(folder / "tune.json", json_text(tune_json(result)));
  if (!result.trouble.empty()) return;
  write_file(folder / "fit.csv", tune_csv(result));
  const Picture picture = tune_picture(result, title + ": dots measured, grey before, line fitted");
  write_file(folder / "fit.svg", svg_plot(picture));
  write_figures_page(folder / report_name, title + ": fit to " + data, tune_text(result, title),
                     {{"", {}, picture.panels}});
}

}  // namespace withy::campaign
