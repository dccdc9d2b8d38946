#include "withy/results/comparison_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "withy/core/model/columns.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/results/report/drawing.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy {
namespace {

/// When the first of the runs begins, and the last of them ends.
std::pair<double, double> run_times(const std::vector<const study::ComparedRun*>& runs) {
  std::pair<double, double> times = {runs.front()->outputs.front().time, runs.front()->outputs.back().time};
  for (const study::ComparedRun* run : runs)
    times = {std::min(times.first, run->outputs.front().time), std::max(times.second, run->outputs.back().time)};
  return times;
}

/// A panel of one quantity, a curve a run. The range is that of the runs completed, or of all where none was.
Panel panel_of(const std::string& label, const std::vector<const study::ComparedRun*>& runs,
               const std::function<double(const study::ComparedRun&, const State&)>& quantity) {
  const auto completed = [](const study::ComparedRun* r) { return r->summary.status == RunStatus::completed; };
  const bool any_completed = std::any_of(runs.begin(), runs.end(), completed);
  Panel panel{"time [s]", label, {std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()}, {}};
  panel.x_range = run_times(runs);
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

std::pair<Eigen::Index, Eigen::Index> plane_of(const std::vector<std::vector<Vector3>>& lines) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const auto& line : lines) {
    for (const Vector3& p : line) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  return widest_plane(low, high);
}

/// The first output of a run at or behind a time; the end where it ended before.
std::vector<State>::const_iterator output_at(const study::ComparedRun& run, double time) {
  constexpr double one_time = 1e-9;  // of itself: times that differ by less are one
  return std::find_if(run.outputs.begin(), run.outputs.end(),
                      [&](const State& s) { return s.time >= time - one_time * std::abs(time); });
}

/// When the trees are seen: "2.2 s", of outputs at several times "2.2 to 2.5 s".
std::string times_text(const std::vector<double>& times) {
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  return brief(*first) + (brief(*first) == brief(*last) ? "" : " to " + brief(*last)) + " s";
}

/// The tree of every run at its first output in the second half of all, or where the run ended before.
Panel tree_panel(const std::vector<const study::ComparedRun*>& runs) {
  const auto [begin, end] = run_times(runs);
  const double middle = begin + (end - begin) / 2;
  std::vector<double> times;
  Panel panel{"", "", {std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()}, {}, 380};
  panel.equal = true;
  std::pair<Eigen::Index, Eigen::Index> plane{-1, -1};
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const Scene& scene = runs[k]->prepared.scene;
    Drawing drawing(scene.model, scene.formulation->terms());
    const auto& outputs = runs[k]->outputs;
    const auto shown = output_at(*runs[k], middle);
    if (shown != outputs.end()) times.push_back(shown->time);
    const auto lines = drawing.lines(shown != outputs.end() ? shown->y : outputs.back().y);
    if (plane.first < 0) plane = plane_of(lines);
    for (const std::vector<Vector3>& line : lines) {
      Curve curve;
      curve.pen = k;
      curve.ends_early = shown == outputs.end() && &line == &lines.back();
      for (const Vector3& p : line) {
        curve.x.push_back(p[plane.first]);
        curve.y.push_back(p[plane.second]);
        panel.y_range.first = std::min(panel.y_range.first, curve.y.back());
        panel.y_range.second = std::max(panel.y_range.second, curve.y.back());
      }
      panel.curves.push_back(std::move(curve));
    }
  }
  const char axes[] = "xyz";
  panel.x_label = std::string(1, axes[plane.first]) + " [m], at " + times_text(times) + " or where the run stopped";
  panel.y_label = std::string(1, axes[plane.second]) + " [m]";
  return panel;
}

/// Distance of a tip from where the reference has it, at outputs of both.
Panel error_panel(const study::Comparison& comparison, const std::vector<const study::ComparedRun*>& runs,
                  const Tip& tip) {
  const study::ComparedRun& reference = comparison.runs[comparison.reference];
  const auto place = [&tip](Observation& seen, const State& s) {
    seen.observe(s.y);
    const WorldPose pose = seen.frame_pose(tip.tip.body, tip.tip.frame);
    return Vector3(Eigen::Map<const Vector3>(pose.position.data()));
  };
  Panel panel{"time [s]", "error of " + tip.body + ".tip against " + reference.formulation() + " [m]", {1, 1}, {}, 260};
  panel.log_y = true;
  panel.x_range = run_times(runs);
  double least = std::numeric_limits<double>::infinity(), greatest = 0;
  const auto of_reference = reference.prepared.equations->make_observation();
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (runs[k] == &reference) continue;
    const auto seen = runs[k]->prepared.equations->make_observation();
    Curve curve;
    curve.pen = k;
    curve.ends_early = runs[k]->summary.status != RunStatus::completed;
    const std::size_t both = std::min(runs[k]->outputs.size(), reference.outputs.size());
    for (std::size_t i = 0; i < both; ++i) {
      const State &a = runs[k]->outputs[i], &b = reference.outputs[i];
      if (a.time != b.time) break;
      const double error = (place(*seen, a) - place(*of_reference, b)).norm();
      if (!(error > 1e-12) || !std::isfinite(error)) continue;
      curve.x.push_back(a.time);
      curve.y.push_back(error);
      if (a.time < 0.02 * reference.outputs.back().time && !curve.ends_early) continue;
      least = std::min(least, error);
      greatest = std::max(greatest, error);
    }
    panel.curves.push_back(std::move(curve));
  }
  if (greatest > 0) panel.y_range = {std::max(least, greatest * 1e-7), greatest};
  return panel;
}

/// Names of the runs, each with how it ended or, where it came to its end, how far off its tip was at most.
std::vector<std::string> legend_of(const std::vector<const study::ComparedRun*>& runs,
                                   const std::vector<Curve>& errors) {
  std::vector<std::string> legend;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    std::string name = runs[k]->formulation();
    if (runs[k]->summary.status != RunStatus::completed) name += " (" + study::outcome_text(runs[k]->summary) + ")";
    for (const Curve& curve : errors) {
      if (curve.pen != k || curve.ends_early || curve.y.empty()) continue;
      const double greatest = *std::max_element(curve.y.begin(), curve.y.end());
      name += greatest < 1e-4 ? fmt::format(": {:.2g} µm off", 1e6 * greatest)
                              : fmt::format(": {:.2g} mm off", 1e3 * greatest);
    }
    legend.push_back(std::move(name));
  }
  return legend;
}

}  // namespace

std::string comparison_picture(const std::string& title, const study::Comparison& comparison) {
  std::vector<const study::ComparedRun*> runs;
  for (std::size_t i = 0; i < comparison.listed; ++i) runs.push_back(&comparison.runs[i]);
  const Model& model = runs.front()->prepared.model();
  std::vector<Panel> panels = {tree_panel(runs)};
  const std::vector<Tip> ends = tips(model);
  const bool measured = comparison.has_reference() && !ends.empty();
  if (measured) panels.push_back(error_panel(comparison, runs, ends.back()));
  const std::vector<std::string> legend = legend_of(runs, measured ? panels.back().curves : std::vector<Curve>());
  for (const Tip& tip : ends) {
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
