#include "withy/results/run_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/study/formulation_meaning.hpp"
#include "withy/study/run.hpp"

namespace withy {
namespace {

std::string name_of_sign(int sign) { return sign > 0 ? "positive" : (sign < 0 ? "negative" : "zero"); }

/// Of a quaternion w x y z: intrinsic turns about x, y, z, R = Rx(a) Ry(b) Rz(c).
std::string attitude(std::span<const double> q) {
  const double w = q[0], x = q[1], y = q[2], z = q[3], size = w * w + x * x + y * y + z * z;
  return fmt::format("{}, {}, {} deg, turned about x, y, z in this order",
                     degrees_text(std::atan2(2 * (w * x - y * z), w * w - x * x - y * y + z * z)),
                     degrees_text(std::asin(std::clamp(2 * (x * z + w * y) / size, -1.0, 1.0))),
                     degrees_text(std::atan2(2 * (w * z - x * y), w * w + x * x - y * y - z * z)));
}

}  // namespace

std::string to_four_places(double value) {
  constexpr double long_number = 1e12, short_number = 0.1;
  if (!(std::abs(value) < long_number)) return fmt::format("{:.6g}", value);
  if (value != 0 && std::abs(value) < short_number) return fmt::format("{:.4g}", value);
  return fmt::format("{:.4f}", value == 0 ? 0.0 : value);  // zero has no sign
}

std::string degrees_text(double angle) {
  constexpr double rounding = 1e-14;  // of a turn
  return to_four_places(std::abs(angle) < rounding ? 0.0 : angle * 180 / std::numbers::pi);
}

std::string readable(double value, const std::string& unit) {
  constexpr double many = 20 * std::numbers::pi;  // a wheel: its turns tell more than its degrees
  const std::string turns = std::abs(value) > many ? fmt::format(", {:.5g} turns", value / (2 * std::numbers::pi)) : "";
  if (unit == "rad") return fmt::format("{} deg{}", degrees_text(value), turns);
  if (unit == "rad/s" && std::abs(value) > many)
    return fmt::format("{:.6g} rad/s, {:.5g} rpm", value, value * 30 / std::numbers::pi);
  return fmt::format("{:.6g}{}{}", value, unit.empty() || unit == "1" ? "" : " ", unit == "1" ? "" : unit);
}

/// What is told of a run, a line each: what it is of, and the text.
using Lines = std::vector<std::pair<std::string, std::string>>;

void add_final_coordinates(const Model& model, const State& last, Lines& lines) {
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const auto columns = coordinate_columns(model.hinges()[h]);
    const Slot& slot = model.layout().hinges[h];
    std::size_t first = 0;
    if (columns.size() >= 4 && columns[0].name.ends_with(".qw")) {
      lines.emplace_back("final " + model.hinges()[h].name, attitude(std::span(last.y).subspan(slot.position, 4)));
      first = 4;
    }
    for (std::size_t i = first; i < columns.size(); ++i)
      lines.emplace_back("final " + columns[i].name, readable(last.y[slot.position + i], columns[i].unit));
  }
}

void add_efforts(const Model& model, const RunSummary& summary, Lines& lines) {
  const auto effort_text = [&](const std::vector<double>& efforts, std::size_t speed) {
    return fmt::format("{:.5g} {}", efforts.at(speed), unit_of_effort(model, speed));
  };
  for (const Slot& slot : model.layout().hinges)
    for (std::size_t s = slot.speed; s < slot.speed + slot.speeds; ++s)
      if (summary.peak_effort.at(s) > 0)
        lines.emplace_back("peak effort " + model.layout().speed_names[s], effort_text(summary.peak_effort, s));
  for (const MotionNode& motion : model.motions()) {
    const Slot& slot = model.layout().hinges[static_cast<std::size_t>(motion.hinge)];
    for (std::size_t s = slot.speed; s < slot.speed + slot.speeds; ++s)
      lines.emplace_back(
          "effort of motion " + motion.name,
          fmt::format("peak {} on {}", effort_text(summary.peak_motion_effort, s), model.layout().speed_names[s]));
  }
}

void add_events(const Model& model, const RunSummary& summary, Lines& lines) {
  for (const EventTime& e : summary.events)
    lines.emplace_back("event " + e.name, fmt::format("{:.6g} s{}", e.time,
                                                      e.direction > 0   ? ", upwards"
                                                      : e.direction < 0 ? ", downwards"
                                                                        : ""));
  const EventBook book(model);
  for (std::size_t i = 0; book.any() && i < book.plan().events.size(); ++i)
    if (const double loss = book.numbers(summary.final.y, i).loss; loss != 0)
      lines.emplace_back("energy lost in " + book.plan().events[i].name, readable(loss, "J"));
  if (summary.switchings > 0) lines.emplace_back("switchings of loads", std::to_string(summary.switchings));
}

std::string run_table(const study::Prepared& prepared, const RunSummary& summary) {
  const Scene& scene = prepared.scene;
  const Model& model = *scene.model;
  Lines lines{{"outcome", study::outcome_text(summary)}};
  add_final_coordinates(model, summary.final, lines);
  for (const auto& [body, d] : summary.peak_deflection)
    lines.emplace_back("peak deflection " + body, fmt::format("y {:.5g} m, z {:.5g} m", d[1], d[2]));
  add_efforts(model, summary, lines);
  add_events(model, summary, lines);
  lines.emplace_back("energy drift", fmt::format("{:.2g}", summary.energy_drift));
  lines.emplace_back("steps", fmt::format("{} ({} rejected), {} evaluations", summary.steps.accepted,
                                          summary.steps.rejected, summary.steps.evaluations));
  lines.emplace_back("CPU time", fmt::format("{:.4g} s", summary.cpu_seconds));
  if (summary.conditioning.condition > 0)
    lines.emplace_back("mass matrix at the end",
                       fmt::format("condition {:.3g}, determinant {}{}", summary.conditioning.condition,
                                   name_of_sign(summary.conditioning.determinant_sign),
                                   loops_of(model).empty() ? "" : ": of the tree, as if its loops were open"));
  std::size_t width = 23;  // that of the certificate below
  for (const auto& [what, text] : lines) width = std::max(width, what.size());
  std::string out =
      fmt::format("{} ({}, {})\n\n", prepared.title(), study::formulation_title(scene), scene.integrator_name);
  for (const auto& [what, text] : lines) out += fmt::format("{:<{}} {}\n", what, width, text);
  if (summary.status == RunStatus::completed && !summary.message.empty()) out += "\nnote: " + summary.message + '\n';
  return out;
}

std::string extremes_text(const nlohmann::ordered_json& outputs) {
  constexpr double small = 0.01;
  const auto ever = [](const nlohmann::ordered_json& o) {
    return o["min"]["value"].is_number() && std::isfinite(o["min"]["value"].get<double>());
  };
  const auto reach = [&](const nlohmann::ordered_json& o) {
    if (!ever(o)) return 0.0;
    return std::max(std::abs(o["min"]["value"].get<double>()), std::abs(o["max"]["value"].get<double>()));
  };
  const auto kin_of = [](const std::string& name, const nlohmann::ordered_json& o) {
    return name.substr(0, name.find('.')) + '[' + o["unit"].get<std::string>();
  };
  std::map<std::string, double> greatest;  // of an output, in one unit
  for (const auto& [name, o] : outputs.items())
    greatest[kin_of(name, o)] = std::max(greatest[kin_of(name, o)], reach(o));
  std::size_t width = 23;
  for (const auto& [name, o] : outputs.items()) width = std::max(width, name.size() + 9);
  std::string out;
  std::size_t left_out = 0;
  for (const auto& [name, o] : outputs.items()) {
    if (!ever(o)) {
      out += fmt::format("{:<{}} it never was a number\n", "range of " + name, width);
      continue;
    }
    if (reach(o) < small * greatest[kin_of(name, o)]) {
      ++left_out;
      continue;
    }
    const std::string unit = o["unit"];
    out += fmt::format("{:<{}} {} at {:.4g} s to {} at {:.4g} s\n", "range of " + name, width,
                       readable(o["min"]["value"], unit), o["min"]["t"].get<double>(),
                       readable(o["max"]["value"], unit), o["max"]["t"].get<double>());
  }
  if (left_out > 0)
    out += fmt::format("{} below a hundredth of these; run.json has them all\n",
                       left_out == 1 ? "one more is" : fmt::format("{} more are", left_out));
  return out.empty() ? out : '\n' + out;
}

}  // namespace withy
