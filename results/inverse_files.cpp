#include "withy/results/inverse_files.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/results/svg_plot.hpp"

namespace withy {

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

std::string inverse_picture(const std::string& title, const study::InverseStudy& study) {
  std::vector<Panel> panels;
  for (const study::Drive& drive : study.drives()) {
    Curve curve;
    curve.x = study.times();
    curve.y = drive.effort;
    const auto [low, high] = std::minmax_element(curve.y.begin(), curve.y.end());
    const std::pair<double, double> range = curve.y.empty() ? std::pair(0.0, 1.0) : std::pair(*low, *high);
    panels.push_back({"time [s]", drive.name + " [" + drive.unit + "]", range, {std::move(curve)}});
  }
  return svg_plot(title, {"effort of the motion"}, panels);
}

}  // namespace withy
