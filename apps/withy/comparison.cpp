#include "withy/apps/withy/comparison.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include "withy/apps/withy/run_report.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy::app {
namespace {

double greatest(const std::map<std::string, double>& values) {
  double most = 0;
  for (const auto& [name, value] : values) most = std::max(most, value);
  return most;
}

Vector3 vector_at(const State& s, std::size_t i) { return {s.y[i], s.y[i + 1], s.y[i + 2]}; }

Eigen::Quaterniond quaternion_at(const State& s, std::size_t i) {
  return Eigen::Quaterniond(s.y[i], s.y[i + 1], s.y[i + 2], s.y[i + 3]).normalized();
}

/// Distance of one hinge's coordinates in two states; q and −q are the same orientation.
double hinge_distance(const HingeNode& hinge, std::size_t p, const State& a, std::size_t q, const State& b,
                      std::size_t positions) {
  const auto kernel = hinge.hinge->kernel();
  const auto kind = kernel ? std::optional(kernel->kind) : std::nullopt;
  if (kind == HingeKernel::Kind::spherical || kind == HingeKernel::Kind::free) {
    const double angle = quaternion_at(a, p).angularDistance(quaternion_at(b, q));
    if (kind == HingeKernel::Kind::spherical) return angle;
    return std::max(angle, (vector_at(a, p + 4) - vector_at(b, q + 4)).norm());
  }
  double most = 0;
  for (std::size_t i = 0; i < positions; ++i) most = std::max(most, std::abs(a.y[p + i] - b.y[q + i]));
  return most;
}

/// A panel of one quantity, a curve a run. The range is that of the runs completed, or of all where none was.
Panel panel_of(const std::string& label, const std::vector<const ComparedRun*>& runs,
               const std::function<double(const ComparedRun&, const State&)>& quantity) {
  const auto completed = [](const ComparedRun* r) { return r->summary.status == RunStatus::completed; };
  const bool any_completed = std::any_of(runs.begin(), runs.end(), completed);
  Panel panel{"time [s]", label, {std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()}, {}};
  for (const ComparedRun* run : runs) {
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

double Distances::greatest_hinge() const { return greatest(hinges); }
double Distances::greatest_tip() const { return greatest(tips); }

void add_distances(Distances& d, const Moment& a, const Moment& b) {
  d.until = a.state.time;
  for (std::size_t h = 0; h < a.model.hinges().size(); ++h) {
    const Slot& slot = a.model.layout().hinges[h];
    if (slot.positions == 0) continue;
    double& most = d.hinges[slot.name];
    most = std::max(most, hinge_distance(a.model.hinges()[h], slot.position, a.state,
                                         b.model.layout().hinges[h].position, b.state, slot.positions));
  }
  const auto places = tips(a.model), others = tips(b.model);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto p = a.equations.frame_pose(a.state.y, places[i].tip.body, places[i].tip.frame).position;
    const auto q = b.equations.frame_pose(b.state.y, others[i].tip.body, others[i].tip.frame).position;
    double& most = d.tips[places[i].body + ".tip"];
    most = std::max(most, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
  }
}

Distances distances(const ComparedRun& run, const ComparedRun& reference) {
  Distances d;
  const Model& model = run.engine->model();
  // The last output of a run that stopped need not be at a common time.
  for (std::size_t i = 0; i < std::min(run.outputs.size(), reference.outputs.size()); ++i) {
    const State& a = run.outputs[i];
    const State& b = reference.outputs[i];
    if (a.time != b.time) break;
    add_distances(d, {model, run.engine->equations(), a},
                  {reference.engine->model(), reference.engine->equations(), b});
  }
  return d;
}

std::string picture(const std::string& title, const std::vector<const ComparedRun*>& runs) {
  std::vector<std::string> legend;
  for (const ComparedRun* run : runs) {
    const bool completed = run->summary.status == RunStatus::completed;
    legend.push_back(run->formulation() + (completed ? "" : " (" + outcome_text(run->summary) + ")"));
  }
  const Model& model = runs.front()->engine->model();
  std::vector<Panel> panels;
  for (const Tip& tip : tips(model)) {
    if (!tip.flexible) continue;
    for (const std::size_t axis : {std::size_t{1}, std::size_t{2}}) {
      Panel panel = panel_of(tip.body + ".tip deflection " + "xyz"[axis] + " [m]", runs,
                             [&tip, axis](const ComparedRun& run, const State& s) {
                               return deflection(run.engine->equations(), s.y, tip)[axis];
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
                              [position, angle](const ComparedRun&, const State& s) {
                                return s.y[position] * (angle ? 180 / std::numbers::pi : 1.0);
                              }));
  }
  return svg_plot(title, legend, panels);
}

}  // namespace withy::app
