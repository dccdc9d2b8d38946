#include "withy/results/run_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "withy/core/model/event_plan.hpp"
#include "withy/results/json_text.hpp"
#include "withy/scene/scene_values.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

Json tip_peaks(const RunSummary& summary) {
  Json peaks = Json::object();
  for (const auto& [body, d] : summary.peak_deflection) append_member(peaks, body, {{"y", d[1]}, {"z", d[2]}});
  return peaks;
}

/// Peaks on the rates of a hinge.
Json peaks_of(const Slot& hinge, const std::vector<double>& peaks) {
  Json efforts = Json::array();
  for (std::size_t i = 0; i < hinge.speeds; ++i) efforts.push_back(peaks.at(hinge.speed + i));
  return efforts;
}

Json effort_peaks(const Model& model, const RunSummary& summary) {
  Json peaks = Json::object();
  for (const Slot& hinge : model.layout().hinges) {
    if (hinge.speeds > 0) append_member(peaks, hinge.name, peaks_of(hinge, summary.peak_effort));
  }
  return peaks;
}

Json motion_effort_peaks(const Model& model, const RunSummary& summary) {
  Json peaks = Json::object();
  for (const MotionNode& motion : model.motions()) {
    const Slot& hinge = model.layout().hinges[static_cast<std::size_t>(motion.hinge)];
    peaks[hinge.name] = peaks_of(hinge, summary.peak_motion_effort);
  }
  return peaks;
}

Json events_json(const RunSummary& summary) {
  Json events = Json::array();
  for (const EventTime& e : summary.events) {
    events.push_back({{"name", e.name}, {"time", e.time}});
    if (e.direction != 0) events.back()["direction"] = e.direction > 0 ? "up" : "down";
  }
  return events;
}

/// How often each event that acts has acted, and the kinetic energy [J] that its impulses have taken.
Json acted_json(const EventBook& book, const State& end) {
  Json events = Json::object();
  for (std::size_t i = 0; i < book.plan().events.size(); ++i) {
    const EventNumbers n = book.numbers(end.y, i);
    Json& event = events[book.plan().events[i].name] = {{"times", n.happened}};
    if (n.happened > 0) event["last"] = n.last;
    event["energy_lost"] = n.loss;
  }
  return events;
}

/// The condition of M; null where it was not looked at.
Json condition_json(const Conditioning& c) { return c.condition > 0 ? Json(c.condition) : Json(); }

}  // namespace

Json state_json(const Model& model, const State& state) { return value_json(state_value(model, state)); }

Json statistics_json(const std::vector<OutputStatistics>& outputs) {
  Json all = Json::object();
  for (const OutputStatistics& o : outputs)
    all[o.name] = {{"unit", o.unit},
                   {"min", {{"value", o.least}, {"t", o.least_at}}},
                   {"max", {{"value", o.greatest}, {"t", o.greatest_at}}},
                   {"mean", o.mean()},
                   {"rms", o.rms()},
                   {"integral", std::isfinite(o.least) ? o.integral : o.least}};
  return all;
}

Json run_json(const Scene& scene, const RunSummary& summary) {
  Json j;
  j["scene"] = scene.file;
  j["name"] = scene.name;
  j["formulation"] = scene.formulation_name;
  j["integrator"] = scene.integrator_name;
  j["status"] = name(summary.status);
  j["message"] = summary.message;
  j["t_end"] = summary.reached;
  j["final"] = state_json(*scene.model, summary.final);
  j["peaks"] = {{"tip_deflection", tip_peaks(summary)}, {"effort", effort_peaks(*scene.model, summary)}};
  if (!scene.model->motions().empty()) j["peaks"]["motion_effort"] = motion_effort_peaks(*scene.model, summary);
  j["energy_drift"] = summary.energy_drift;
  j["steps"] = summary.steps.accepted;
  j["rejected_steps"] = summary.steps.rejected;
  j["evaluations"] = summary.steps.evaluations;
  j["cpu_seconds"] = summary.cpu_seconds;
  j["suspected_jumps"] = summary.suspected_jumps;
  const EventBook book(*scene.model);
  if (!scene.events.empty() || book.any()) j["events"] = events_json(summary);
  if (book.any()) j["acted"] = acted_json(book, summary.final);
  j["condition"] = condition_json(summary.conditioning);
  j["determinant_sign"] = summary.conditioning.determinant_sign;
  return j;
}

}  // namespace withy
