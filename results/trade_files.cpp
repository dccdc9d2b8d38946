#include "withy/results/trade_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "withy/core/plugin/mode_family.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/provenance.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/run_command.hpp"
#include "withy/results/svg_plot.hpp"
#include "withy/scene/scene_error.hpp"
#include "withy/scene/sha256.hpp"

namespace withy {

using Json = nlohmann::ordered_json;

std::string trade_over_text(const study::Point& point) {
  std::string text;
  for (const std::string& o : point.over) {
    const std::string path = o.substr(0, o.find('='));
    text += (text.empty() ? "" : " ") + path.substr(path.find_last_of('.') + 1) + o.substr(o.find('='));
  }
  return text;
}

bool measures_hinges(const study::Outputs& outputs) {
  return outputs.has(study::Measure::angle) || outputs.has(study::Measure::slide);
}

bool measures_tips(const study::Outputs& outputs) { return outputs.has(study::Measure::place); }

Json trade_result_json(const study::TradeResult& r) {
  return {{"formulation", r.point.formulation},
          {"modes", r.point.modes},
          {"family", r.point.family.empty() ? Json() : Json(r.point.family)},
          {"integrator", r.point.integrator},
          {"tolerance", r.point.tolerance},
          {"over", r.point.over},
          {"status", r.status},
          {"message", r.message},
          {"hinge_error", r.hinge_error},
          {"tip_error", r.tip_error},
          {"relative_error", r.relative_error},
          {"cpu_seconds", r.cpu_seconds},
          {"steps", r.steps},
          {"evaluations", r.evaluations},
          {"sensors", r.sensors}};
}

Json trade_reference_json(const study::TradeReference& r) {
  return {{"formulation", r.point.formulation},
          {"family", r.point.family},
          {"modes", r.point.modes},
          {"integrator", r.point.integrator},
          {"tolerance", r.point.tolerance},
          {"hinge_way", r.hinge_way},
          {"tip_way", r.tip_way},
          {"hinge_error", r.hinge_error},
          {"tip_error", r.tip_error},
          {"relative_error", r.relative_error},
          {"sensor_ways", r.sensor_ways},
          {"sensor_errors", r.sensor_errors}};
}

namespace {

/// Takes away numbers that nobody measured, which would be taken for exact ones.
void leave_unmeasured(Json& j, const study::Outputs& outputs, bool completed) {
  const auto leave = [&j](const char* key) {
    if (j.contains(key)) j[key] = Json();
  };
  for (const char* key : {"hinge_error", "hinge_way"})
    if (!completed || !measures_hinges(outputs)) leave(key);
  for (const char* key : {"tip_error", "tip_way"})
    if (!completed || !measures_tips(outputs)) leave(key);
  if (!completed) leave("relative_error");
}

}  // namespace

Json trade_json(const Scene& scene, const study::TradeStudy& study, const std::vector<study::TradeResult>& results,
                const std::vector<bool>& front, const std::vector<double>& shares) {
  Json j{{"scene", scene.file}, {"name", scene.name}};
  j["outputs"] = Json::array();
  for (const study::Output& o : study.outputs().list()) j["outputs"].push_back({{"output", o.label}, {"unit", o.unit}});
  j["references"] = Json::object(), j["points"] = Json::array();
  for (const auto& [over, reference] : study.references()) {
    j["references"][over] = trade_reference_json(reference);
    leave_unmeasured(j["references"][over], study.outputs(), true);
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    j["points"].push_back(trade_result_json(results[i]));
    leave_unmeasured(j["points"].back(), study.outputs(), results[i].completed());
    j["points"].back()["pareto"] = static_cast<bool>(front[i]);
  }
  j["cheapest"] = cheapest_json(results, shares);
  return j;
}

std::string trade_csv(const std::vector<study::TradeResult>& results, const std::vector<bool>& front,
                      const study::Outputs& outputs) {
  std::string text =
      "formulation,modes,family,integrator,tolerance,over,status,hinge_error,tip_error[m],relative_error,steps,"
      "evaluations,cpu[s],pareto\n";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const study::TradeResult& r = results[i];
    text += fmt::format("{},{},{},{},{:g},\"{}\",{},", r.point.formulation, r.point.modes, r.point.family,
                        r.point.integrator, r.point.tolerance, trade_over_text(r.point), r.status);
    if (r.completed())
      text += fmt::format("{},{},{},{},{},{},{}\n", measures_hinges(outputs) ? fmt::format("{}", r.hinge_error) : "",
                          measures_tips(outputs) ? fmt::format("{}", r.tip_error) : "", r.relative_error, r.steps,
                          r.evaluations, r.cpu_seconds, front[i] ? 1 : 0);
    else
      text += ",,,,,,0\n";
  }
  return text;
}

namespace {

/// Where errors of zero [%] are drawn, which logarithms have no place for: a decade below all others; nothing where
/// there are none.
std::optional<double> zero_errors(const std::vector<study::TradeResult>& results) {
  bool any = false;
  double least = std::numeric_limits<double>::infinity();
  for (const study::TradeResult& r : results) {
    if (!r.completed()) continue;
    if (r.relative_error > 0)
      least = std::min(least, 100 * r.relative_error);
    else
      any = true;
  }
  if (!any) return {};
  return std::isfinite(least) ? 0.1 * least : 1e-12;
}

}  // namespace

std::string trade_picture(const std::string& title, const std::vector<study::TradeResult>& results,
                          const std::vector<bool>& front) {
  const std::optional<double> zero = zero_errors(results);
  const std::string error = zero ? fmt::format("error [%], 0 at {:.1g}", *zero) : "error [%]";
  std::vector<std::string> legend;
  std::map<std::string, std::size_t> pens;
  for (const study::TradeResult& r :
       results)  // those that failed too: a colour means the same in every study of the same list
    if (pens.emplace(r.point.formulation, legend.size()).second) legend.push_back(r.point.formulation);
  const std::size_t line = legend.size();
  legend.emplace_back("Pareto front");
  std::vector<std::string> overs;
  std::vector<Panel> panels;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const study::TradeResult& r = results[i];
    if (!r.completed()) continue;
    const std::string over = trade_over_text(r.point);
    const auto at = std::find(overs.begin(), overs.end(), over);
    const auto p = static_cast<std::size_t>(at - overs.begin());
    if (at == overs.end()) {
      overs.push_back(over);
      panels.push_back({"CPU time [ms]" + (over.empty() ? "" : ", " + over), error, {1e300, 0}, {}});
      panels.back().log_x = panels.back().log_y = true;
      panels.back().curves.resize(legend.size());
      for (std::size_t c = 0; c < line; ++c) panels.back().curves[c].points = true;
    }
    const double x = 1e3 * r.cpu_seconds, y = r.relative_error > 0 ? 100 * r.relative_error : zero.value_or(0);
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

Json trade_page(const study::Prepared& prepared, Json trade, const std::vector<study::TradeResult>& results,
                Registry& registry, const std::vector<std::string>& plugin_folders) {
  for (std::size_t i = 0; i < results.size(); ++i) {
    std::string command = command_with("withy run", prepared.scene.file, plugin_folders) + " --formulation " +
                          results[i].point.formulation;
    for (const std::string& setting : prepared.scene.settings) command += " --set " + quoted(setting);
    for (const std::string& over : results[i].point.over) command += " --set " + quoted(over);
    for (const study::Change& change : study::changes_at(prepared.scene, results[i].point, registry))
      command += " --set " + quoted(change.text());
    trade["points"].at(i)["command"] = command;
  }
  return trade;
}

std::vector<std::string> trade_content() { return {"trade.json", "trade.csv", "trade.svg", report_name}; }

void write_trade(const std::filesystem::path& folder, const study::Prepared& prepared, const Json& content,
                 const std::vector<study::TradeResult>& results, const std::vector<bool>& front,
                 const study::Outputs& outputs, Registry& registry, const std::vector<std::string>& plugin_folders) {
  const std::string title = prepared.title();
  write_file(folder / "trade.json", json_text(content));
  write_file(folder / "trade.csv", trade_csv(results, front, outputs));
  write_file(folder / "trade.svg", trade_picture(title, results, front));
  if (has_report_page())
    write_study_page(folder / report_name, "trade", title,
                     trade_page(prepared, content, results, registry, plugin_folders));
}

namespace {

study::PointStore::Kept kept_of(const Json& j, const study::Point& point) {
  const Json& r = j.at("reference");
  study::PointStore::Kept kept;
  kept.reference = {
      {r.at("formulation"), r.at("family"), r.at("modes"), r.at("integrator"), r.at("tolerance"), point.over},
      r.at("hinge_way"),
      r.at("tip_way"),
      r.at("hinge_error"),
      r.at("tip_error"),
      r.at("relative_error"),
      r.at("sensor_ways"),
      r.at("sensor_errors")};
  kept.result = {point,
                 j.at("status"),
                 j.at("message"),
                 j.at("hinge_error"),
                 j.at("tip_error"),
                 j.at("relative_error"),
                 j.at("cpu_seconds"),
                 j.at("steps"),
                 j.at("evaluations"),
                 kept.reference.relative_error,
                 j.at("sensors")};
  return kept;
}

}  // namespace

std::optional<study::PointStore::Kept> TradeFolder::find(const study::Point& point) {
  const std::optional<Json> kept = points_.find(point.key());
  if (!kept) return {};
  try {
    return kept_of(*kept, point);
  } catch (const Json::exception&) {
    return {};  // no result of this version: it is computed anew
  }
}

void TradeFolder::keep(const Kept& kept) {
  Json j = trade_result_json(kept.result);
  j["reference"] = trade_reference_json(kept.reference);
  points_.keep(kept.result.point.key(), j);
}

namespace {

/// Of the values and files of the scene at each value that is gone over, which may name files of its own.
std::vector<std::string> subjects_over(const SceneValues& values, const std::vector<study::Point>& points,
                                       Registry& registry) {
  std::set<std::vector<std::string>> overs;
  for (const study::Point& p : points) overs.insert(p.over);
  std::vector<std::string> subjects;
  for (const std::vector<std::string>& over : overs) {
    SceneValues changed = values;
    try {
      for (const std::string& text : over) changed.set_text(text);
      subjects.push_back(provenance_of(make_scene(changed, registry)).subject());
    } catch (const SceneError&) {
      subjects.emplace_back();  // the points there say what is wrong
    }
  }
  return subjects;
}

}  // namespace

std::string trade_fingerprint(const study::Prepared& prepared, const std::vector<study::Point>& points,
                              Registry& registry, const std::vector<std::string>& outputs) {
  int modes = 0;
  double tolerance = 1;
  std::map<std::string, std::string> builds;
  const auto build_of = [&]<class Interface>(const std::string& id) {
    const Plugin<Interface>* plugin = id.empty() ? nullptr : registry.find<Interface>(id);
    if (plugin != nullptr) builds[std::string(kind_name<Interface>()) + '/' + id] = library_identity(plugin->origin);
  };
  for (const study::Point& p : points) {
    modes = std::max(modes, p.modes);
    tolerance = std::min(tolerance, p.tolerance);
    build_of.operator()<Formulation>(p.formulation);
    build_of.operator()<ModeFamily>(p.family);
    build_of.operator()<Integrator>(p.integrator);
  }
  for (const char* reference : {"exact", "quadratic"}) build_of.operator()<Formulation>(reference);
  build_of.operator()<Integrator>("dopri5");
  return sha256(json_line(Json::array({provenance_of(prepared.scene).fingerprint(), modes, tolerance, builds,
                                       subjects_over(prepared.values, points, registry), outputs})));
}

}  // namespace withy
