#include "withy/apps/withy/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/apps/withy/columns.hpp"
#include "withy/apps/withy/json_text.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

Json tip_peaks(const RunSummary& summary) {
  Json peaks = Json::object();
  for (const auto& [body, d] : summary.peak_deflection) peaks[body] = {{"y", d[1]}, {"z", d[2]}};
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
    if (hinge.speeds > 0) peaks[hinge.name] = peaks_of(hinge, summary.peak_effort);
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
  for (const EventTime& e : summary.events)
    events.push_back({{"name", e.name}, {"time", e.time}, {"direction", e.direction > 0 ? "up" : "down"}});
  return events;
}

/// The condition of M; null where it was not looked at.
Json condition_json(const Conditioning& c) { return c.condition > 0 ? Json(c.condition) : Json(); }

std::string name_of_sign(int sign) { return sign > 0 ? "positive" : (sign < 0 ? "negative" : "zero"); }

}  // namespace

Json state_json(const Model& model, const State& state) { return Json::parse(write_state(model, state)); }

Json run_json(const Engine& engine, const RunSummary& summary, const Evidence& evidence) {
  const Scene& scene = engine.scene();
  Json j;
  j["scene"] = scene.file;
  j["name"] = scene.name;
  j["formulation"] = scene.formulation_name;
  j["integrator"] = scene.integrator_name;
  j["status"] = name(summary.status);
  j["message"] = summary.message;
  j["t_end"] = summary.final.time;
  j["final"] = state_json(*scene.model, summary.final);
  j["peaks"] = {{"tip_deflection", tip_peaks(summary)}, {"effort", effort_peaks(*scene.model, summary)}};
  if (!scene.model->motions().empty()) j["peaks"]["motion_effort"] = motion_effort_peaks(*scene.model, summary);
  j["energy_drift"] = summary.energy_drift;
  j["steps"] = summary.steps.accepted;
  j["rejected_steps"] = summary.steps.rejected;
  j["evaluations"] = summary.steps.evaluations;
  j["cpu_seconds"] = summary.cpu_seconds;
  j["suspected_jumps"] = summary.suspected_jumps;
  if (!scene.events.empty()) j["events"] = events_json(summary);
  j["condition"] = condition_json(summary.conditioning);
  j["determinant_sign"] = summary.conditioning.determinant_sign;
  j["certificate"] = certificate_json(engine, summary, evidence);
  return j;
}

std::string outcome_text(const RunSummary& summary) {
  if (summary.status == RunStatus::completed) return "completed";
  return fmt::format("{} at {:.4g} s", name(summary.status), summary.final.time);
}

std::string readable(double value, const std::string& unit) {
  if (unit == "rad") return fmt::format("{:.4f} deg", value * 180 / std::numbers::pi);
  return fmt::format("{:.6g}{}{}", value, unit.empty() || unit == "1" ? "" : " ", unit == "1" ? "" : unit);
}

std::string run_table(const Engine& engine, const RunSummary& summary) {
  const Scene& scene = engine.scene();
  const Model& model = *scene.model;
  std::string out;
  const auto line = [&](const std::string& what, const std::string& text) {
    out += fmt::format("{:<23} {}\n", what, text);
  };
  out += fmt::format("{} ({}, {})\n\n", scene.name.empty() ? scene.file : scene.name, scene.formulation_name,
                     scene.integrator_name);
  line("outcome", outcome_text(summary));
  for (const HingeNode& hinge : model.hinges()) {
    const auto columns = coordinate_columns(hinge);
    const Slot& slot = *model.layout().hinge(hinge.name);
    for (std::size_t i = 0; i < columns.size(); ++i)
      line("final " + columns[i].name, readable(summary.final.y[slot.position + i], columns[i].unit));
  }
  for (const auto& [body, d] : summary.peak_deflection) {
    line("peak deflection " + body, fmt::format("y {:.5g} m, z {:.5g} m", d[1], d[2]));
  }
  for (const Slot& slot : model.layout().hinges) {
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      const double effort = summary.peak_effort.at(slot.speed + i);
      if (effort > 0) line("peak effort " + model.layout().speed_names[slot.speed + i], fmt::format("{:.5g}", effort));
    }
  }
  for (const MotionNode& motion : model.motions()) {
    const Slot& slot = model.layout().hinges[static_cast<std::size_t>(motion.hinge)];
    for (std::size_t i = 0; i < slot.speeds; ++i)
      line("effort of motion " + motion.name,
           fmt::format("peak {:.5g} on {}", summary.peak_motion_effort.at(slot.speed + i),
                       model.layout().speed_names[slot.speed + i]));
  }
  for (const EventTime& e : summary.events)
    line("event " + e.name, fmt::format("{:.6g} s, {}", e.time, e.direction > 0 ? "upwards" : "downwards"));
  if (summary.switchings > 0) line("switchings of loads", std::to_string(summary.switchings));
  line("energy drift", fmt::format("{:.2g}", summary.energy_drift));
  line("steps", fmt::format("{} ({} rejected), {} evaluations", summary.steps.accepted, summary.steps.rejected,
                            summary.steps.evaluations));
  line("CPU time", fmt::format("{:.4g} s", summary.cpu_seconds));
  if (summary.conditioning.condition > 0) {
    line("mass matrix at the end", fmt::format("condition {:.3g}, determinant {}", summary.conditioning.condition,
                                               name_of_sign(summary.conditioning.determinant_sign)));
  }
  if (summary.status == RunStatus::completed && !summary.message.empty()) out += "\nnote: " + summary.message + '\n';
  return out;
}

}  // namespace withy::app
