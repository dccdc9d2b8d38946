#include "withy/results/inverse_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/results/svg_plot.hpp"
#include "withy/results/text_table.hpp"
#include "withy/study/formulation_meaning.hpp"
#include "withy/study/run.hpp"

namespace withy {

namespace {

using Json = nlohmann::ordered_json;

Json drives_json(const study::InverseStudy& study) {
  Json all = Json::object();
  for (const study::Drive& drive : study.drives()) {
    const study::Demand d = study.demand(drive);
    all[drive.name] = {{"unit", drive.unit},  {"peak_effort", d.peak},      {"peak_time", d.peak_time},
                       {"rms_effort", d.rms}, {"peak_power", d.peak_power}, {"work", d.work}};
  }
  return all;
}

std::string demands_text(const study::InverseStudy& study) {
  TextTable table(
      {"<drive", "peak effort\n[N m, N]", "at\n[s]", "rms effort\n[N m, N]", "peak power\n[W]", "work\n[J]"});
  for (const study::Drive& drive : study.drives()) {
    const study::Demand d = study.demand(drive);
    table.add({drive.name, fmt::format("{:.5g}", d.peak), fmt::format("{:.4g}", d.peak_time),
               fmt::format("{:.5g}", d.rms), fmt::format("{:.5g}", d.peak_power), fmt::format("{:.5g}", d.work)});
  }
  return table.str();
}

/// Names stand for the rest of a file that has many, as results.csv of a run.
std::string ignored_text(const std::vector<std::string>& ignored) {
  constexpr std::size_t most = 6;
  if (ignored.empty()) return "";
  const std::size_t shown = std::min(most, ignored.size());
  std::string text = "\nColumns left out, for no hinge of one coordinate has their names: ";
  for (std::size_t i = 0; i < shown; ++i) text += (i > 0 ? ", " : "") + ignored[i];
  return text + (ignored.size() > shown ? fmt::format(" and {} more.\n", ignored.size() - shown) : ".\n");
}

}  // namespace

Json inverse_json(const Scene& scene, const RunSummary& summary, const study::InverseStudy& study,
                  const std::vector<std::string>& ignored) {
  return {{"scene", scene.file},
          {"name", scene.name},
          {"formulation", scene.formulation_name},
          {"status", name(summary.status)},
          {"message", summary.message},
          {"t_end", summary.reached},
          {"drives", drives_json(study)},
          {"ignored", ignored}};
}

std::string inverse_text(const std::string& title, const Scene& scene, const RunSummary& summary,
                         const study::InverseStudy& study, const std::vector<std::string>& ignored) {
  return fmt::format("{} ({}, {}, {} outputs, {})\n\n{}", title, study::formulation_title(scene), scene.integrator_name,
                     study.times().size(), study::outcome_text(summary), demands_text(study)) +
         ignored_text(ignored);
}

std::string inverse_picture(const std::string& title, const study::InverseStudy& study) {
  std::vector<Panel> panels;
  for (const study::Drive& drive : study.drives()) {
    Curve curve;
    curve.x = study.times();
    curve.y = drive.effort;
    const auto [low, high] = std::minmax_element(curve.y.begin(), curve.y.end());
    const std::pair<double, double> range = curve.y.empty() ? std::pair(0.0, 1.0) : std::pair(*low, *high);
    panels.push_back({"time [s]", drive.name + " [" + drive.unit + "]", range, {std::move(curve)}});
    if (!study.times().empty()) panels.back().x_range = {study.times().front(), study.times().back()};
  }
  return svg_plot(title, {"effort of the motion"}, panels);
}

}  // namespace withy
