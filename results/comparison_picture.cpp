#include "withy/results/comparison_picture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "withy/core/model/columns.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy {
namespace {

/// A panel of one quantity, a curve a run. The range is that of the runs completed, or of all where none was.
Panel panel_of(const std::string& label, const std::vector<const study::ComparedRun*>& runs,
               const std::function<double(const study::ComparedRun&, const State&)>& quantity) {
  const auto completed = [](const study::ComparedRun* r) { return r->summary.status == RunStatus::completed; };
  const bool any_completed = std::any_of(runs.begin(), runs.end(), completed);
  Panel panel{"time [s]", label, {std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()}, {}};
  for (const study::ComparedRun* run : runs) {
    Curve curve;
    curve.ends_early = !completed(run);
    for (const State& s : run->outputs) {
      const double y = quantity(*run, s);
      if (!std::isfinite(y)) break;
      curve.x.push_back(s.time);
      curve.y.push_back(y);
      if (any_completed && curve.ends_early) continue;
      panel.y_range.first = std::min(panel.y_range.first, y);
      panel.y_range.second = std::max(panel.y_range.second, y);
    }
    panel.curves.push_back(std::move(curve));
  }
  if (panel.y_range.first > panel.y_range.second) panel.y_range = {0, 1};
  return panel;
}

}  // namespace

std::string comparison_picture(const std::string& title, const std::vector<const study::ComparedRun*>& runs) {
  std::vector<std::string> legend;
  for (const study::ComparedRun* run : runs) {
    const bool completed = run->summary.status == RunStatus::completed;
    legend.push_back(run->formulation() + (completed ? "" : " (" + study::outcome_text(run->summary) + ")"));
  }
  const Model& model = runs.front()->prepared.model();
  std::vector<Panel> panels;
  for (const Tip& tip : tips(model)) {
    if (!tip.flexible) continue;
    for (const std::size_t axis : {std::size_t{1}, std::size_t{2}}) {
      Panel panel = panel_of(tip.body + ".tip deflection " + "xyz"[axis] + " [m]", runs,
                             [&tip, axis](const study::ComparedRun& run, const State& s) {
                               return deflection(*run.prepared.equations, s.y, tip)[axis];
                             });
      // A direction in which nothing bends has no panel.
      if (panel.y_range.first != 0 || panel.y_range.second != 0) panels.push_back(std::move(panel));
    }
  }
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const auto columns = coordinate_columns(model.hinges()[h]);
    if (columns.size() != 1) continue;
    const bool angle = columns[0].unit == "rad";
    const std::size_t position = model.layout().hinges[h].position;
    panels.push_back(panel_of(columns[0].name + (angle ? " [deg]" : " [" + columns[0].unit + "]"), runs,
                              [position, angle](const study::ComparedRun&, const State& s) {
                                return s.y[position] * (angle ? 180 / std::numbers::pi : 1.0);
                              }));
  }
  return svg_plot(title, legend, panels);
}

}  // namespace withy
