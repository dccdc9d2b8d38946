#include "withy/results/advice_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace withy {
namespace {

/// Errors below this share of the accuracy tell no difference.
constexpr double least_use = 1e-4;

std::string note_of(const study::Probe& p) {
  const study::Point& at = p.point;
  const std::string modes = at.modes == 0 ? "modes as they are" : fmt::format("{} modes {}", at.modes, at.family);
  const std::string cut = p.walk.end == study::Walk::End::cut ? fmt::format(", cut at {:.3g} s", p.walk.time) : "";
  return fmt::format("{}, {}, {} at {:g}: {}{}", at.formulation, modes, at.integrator, at.tolerance,
                     study::outcome_name(p.outcome), cut);
}

bool is_shown(const study::Probe& p) {
  using Outcome = study::Probe::Outcome;
  return p.cost > 0 && p.use > 0 &&
         (p.passed() || p.outcome == Outcome::no_candidate || p.outcome == Outcome::inaccurate);
}

void enter(const study::Probe& p, Curve& curve) {
  curve.x.push_back(1e3 * p.cost);
  curve.y.push_back(std::max(p.use, least_use));
  curve.notes.push_back(note_of(p));
}

}  // namespace

Picture advice_picture(const study::Advice& advice) {
  Panel panel{"CPU time of the run, or until it was cut [ms]", "error, of the accuracy asked [1]", {0.1, 1}, {}, 300};
  panel.log_x = panel.log_y = panel.free_x = true;
  std::map<std::string, Curve> curves;
  double first = 1e300, last = 0;
  for (const study::Probe& p : advice.probes) {
    if (!is_shown(p)) continue;
    enter(p, curves[p.point.formulation]);
    panel.y_range.first = std::min(panel.y_range.first, std::max(p.use, least_use) / 2);
    panel.y_range.second = std::max(panel.y_range.second, 2 * p.use);
    first = std::min(first, 1e3 * p.cost), last = std::max(last, 1e3 * p.cost);
  }
  Picture picture{
      "What was tried: below the line a model holds the accuracy to the end; above it, it was cut where it no longer "
      "did",
      {},
      {}};
  for (auto& [formulation, curve] : curves) {
    curve.points = true;
    picture.legend.push_back(formulation);
    panel.curves.push_back(std::move(curve));
  }
  Curve limit{{first, last}, {1, 1}};
  limit.pen = picture.legend.size();
  picture.legend.emplace_back("the accuracy asked");
  if (first <= last) panel.curves.push_back(std::move(limit));
  if (advice.choice) {
    Curve choice;
    choice.points = true;
    choice.pen = picture.legend.size();
    picture.legend.emplace_back("advised");
    enter(*advice.choice, choice);
    panel.curves.push_back(std::move(choice));
  }
  picture.panels.push_back(std::move(panel));
  return picture;
}

}  // namespace withy
