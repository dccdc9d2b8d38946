#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/text_table.hpp"
#include "withy/apps/withy/trade_run.hpp"
#include "withy/apps/withy/trade_threshold.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

std::string over_text(const TradePoint& point) {
  std::string text;
  for (const std::string& o : point.over) {
    const std::string path = o.substr(0, o.find('='));
    text += (text.empty() ? "" : " ") + path.substr(path.find_last_of('.') + 1) + o.substr(o.find('='));
  }
  return text;
}

std::string table_text(const std::vector<TradeResult>& results, const std::vector<bool>& front) {
  const auto any = [&](auto&& has) { return std::any_of(results.begin(), results.end(), has); };
  const bool families = any([](const TradeResult& r) { return !r.point.family.empty(); });
  const bool overs = any([](const TradeResult& r) { return !r.point.over.empty(); });
  std::vector<std::string> head = {"<", "<formulation", "modes"};
  if (families) head.emplace_back("<family");
  if (overs) head.emplace_back("<over");
  for (const char* h :
       {"<integrator", "tolerance", "<outcome", "hinge\nerror", "tip error\n[mm]", "error\n[%]", "steps", "CPU\n[ms]"})
    head.emplace_back(h);
  TextTable table(head);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const TradeResult& r = results[i];
    std::vector<std::string> row = {front[i] ? "*" : "", r.point.formulation, std::to_string(r.point.modes)};
    if (families) row.push_back(r.point.family.empty() ? "scene's" : r.point.family);
    if (overs) row.push_back(over_text(r.point));
    row.push_back(r.point.integrator);
    row.push_back(fmt::format("{:g}", r.point.tolerance));
    row.push_back(r.status);
    if (r.completed()) {
      for (std::string& cell :
           std::vector<std::string>{fmt::format("{:.3g}", r.hinge_error), fmt::format("{:.3g}", 1e3 * r.tip_error),
                                    fmt::format("{:.3g}", 100 * r.relative_error), std::to_string(r.steps),
                                    fmt::format("{:.2f}", 1e3 * r.cpu_seconds)})
        row.push_back(std::move(cell));
    } else {
      row.insert(row.end(), 5, "-");
    }
    table.add(std::move(row));
  }
  return table.str();
}

/// Reasons of the points that failed, each said once.
std::string reasons_text(const std::vector<TradeResult>& results) {
  std::map<std::string, std::pair<std::string, std::size_t>> reasons;  // by formulation, integrator and status
  for (const TradeResult& r : results) {
    if (r.completed()) continue;
    auto& [text, count] = reasons[r.point.formulation + ' ' + r.point.integrator + ' ' + r.status];
    if (text.empty()) text = r.point.text() + ": " + r.message;
    ++count;
  }
  std::string out;
  for (const auto& [key, reason] : reasons) {
    out += "\n" + reason.first;
    if (reason.second > 1) out += fmt::format(" ({} more like it)", reason.second - 1);
    out += '\n';
  }
  return out;
}

std::string references_text(const Json& references) {
  std::string out;
  for (const auto& [over, r] : references.items()) {
    out += fmt::format(
        "Reference{}: {}, {} modes, {} at {:g}; its own error, against one mode less and ten times the tolerance: "
        "hinges {:.2g}, tips {:.2g} mm, {:.2g} %.\n",
        over.empty() ? "" : " at " + over, r.at("formulation").get<std::string>(), r.at("modes").get<int>(),
        r.at("integrator").get<std::string>(), r.at("tolerance").get<double>(), r.at("hinge_error").get<double>(),
        1e3 * r.at("tip_error").get<double>(), 100 * r.at("relative_error").get<double>());
  }
  return out;
}

std::string csv_text(const std::vector<TradeResult>& results, const std::vector<bool>& front) {
  std::string text =
      "formulation,modes,family,integrator,tolerance,over,status,hinge_error,tip_error[m],relative_error,steps,"
      "evaluations,cpu[s],pareto\n";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const TradeResult& r = results[i];
    text += fmt::format("{},{},{},{},{:g},\"{}\",{},", r.point.formulation, r.point.modes, r.point.family,
                        r.point.integrator, r.point.tolerance, over_text(r.point), r.status);
    if (r.completed())
      text += fmt::format("{},{},{},{},{},{},{}\n", r.hinge_error, r.tip_error, r.relative_error, r.steps,
                          r.evaluations, r.cpu_seconds, front[i] ? 1 : 0);
    else
      text += ",,,,,,0\n";
  }
  return text;
}

/// Error over cost, both logarithmic; a colour a formulation, the front as a line. A panel for each of the values gone
/// over.
std::string picture(const std::string& title, const std::vector<TradeResult>& results, const std::vector<bool>& front) {
  std::vector<std::string> legend;
  std::map<std::string, std::size_t> pens;
  for (const TradeResult& r :
       results)  // those that failed too: a colour means the same in every study of the same list
    if (pens.emplace(r.point.formulation, legend.size()).second) legend.push_back(r.point.formulation);
  const std::size_t line = legend.size();
  legend.emplace_back("Pareto front");
  std::vector<std::string> overs;
  std::vector<Panel> panels;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const TradeResult& r = results[i];
    if (!r.completed()) continue;
    const std::string over = over_text(r.point);
    const auto at = std::find(overs.begin(), overs.end(), over);
    const auto p = static_cast<std::size_t>(at - overs.begin());
    if (at == overs.end()) {
      overs.push_back(over);
      panels.push_back({"CPU time [ms]" + (over.empty() ? "" : ", " + over), "error [%]", {1e300, 0}, {}});
      panels.back().log_x = panels.back().log_y = true;
      panels.back().curves.resize(legend.size());
      for (std::size_t c = 0; c < line; ++c) panels.back().curves[c].points = true;
    }
    const double x = 1e3 * r.cpu_seconds, y = std::max(100 * r.relative_error, 1e-12);
    const auto add = [&](Curve& curve) {
      curve.x.push_back(x);
      curve.y.push_back(y);
    };
    add(panels[p].curves[pens.at(r.point.formulation)]);
    if (front[i]) add(panels[p].curves[line]);
    panels[p].y_range = {std::min(panels[p].y_range.first, y), std::max(panels[p].y_range.second, y)};
  }
  for (Panel& panel : panels) {  // along the front error falls as cost rises
    Curve& curve = panel.curves[line];
    std::sort(curve.x.begin(), curve.x.end());
    std::sort(curve.y.rbegin(), curve.y.rend());
  }
  return svg_plot(title, legend, panels);
}

}  // namespace

ExitStatus trade(const TradeArguments& arguments) {
  if (!arguments.limit.empty()) return trade_threshold(arguments);
  if (arguments.measure != "runs" || !arguments.lock.empty() || !arguments.spin.empty())
    throw InputError(
        "--measure frequencies, --lock and --spin go with --limit; frequencies over a range are what "
        "withy modes --sweep shows");
  TradeStudy study(arguments, trade_points(arguments.axes), {arguments.out, arguments.jobs});
  const bool whole = study.run();
  const auto results = study.results();
  const auto front = pareto_front(results);
  const Scene& scene = study.engine().scene();
  const std::string title = scene.name.empty() ? scene.file : scene.name;
  Json j{{"scene", scene.file}, {"name", scene.name}, {"references", study.references()}, {"points", Json::array()}};
  for (std::size_t i = 0; i < results.size(); ++i) {
    j["points"].push_back(result_json(results[i]));
    j["points"].back()["pareto"] = static_cast<bool>(front[i]);
  }
  std::string text =
      arguments.json
          ? json_text(j)
          : title + "\n\n" + table_text(results, front) +
                "\n*: no other point is both more accurate, as far as the reference can tell, and cheaper. Error "
                "in % of the greatest way of a hinge or tip.\n" +
                references_text(study.references()) + reasons_text(results);
  if (!arguments.out.empty()) {
    const std::filesystem::path folder = arguments.out;
    write_file(folder / "trade.json", json_text(j));
    write_file(folder / "trade.csv", csv_text(results, front));
    write_file(folder / "trade.svg", picture(title, results, front));
    if (!arguments.json) text += "\ntrade.csv, trade.svg and trade.json in " + arguments.out + '\n';
  }
  print(text);
  return whole ? ExitStatus::done : ExitStatus::interrupted;
}

}  // namespace withy::app
