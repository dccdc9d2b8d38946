#include "withy/results/advice_json.hpp"

#include <nlohmann/json.hpp>

#include "withy/results/certificate_json.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

Json distances_json(const study::Outputs& outputs, const study::Distances& distances) {
  Json j = Json::object();
  for (std::size_t i = 0; i < distances.size(); ++i) j[outputs.list()[i].label] = distances[i];
  return j;
}

/// What the accuracy is asked of.
Json measure_json(const study::Outputs& outputs) {
  Json all = Json::array();
  for (const study::Output& o : outputs.list()) {
    const auto measure = static_cast<std::size_t>(o.measure);
    all.push_back({{"output", o.label}, {"measure", study::measure_name(measure)}, {"unit", o.unit}});
  }
  return all;
}

Json point_json(const study::Point& p) {
  Json bodies = Json::object();
  for (const auto& [body, formulation] : p.bodies) bodies[body] = formulation;
  return {{"formulation", p.formulation},
          {"bodies", std::move(bodies)},
          {"modes", p.modes > 0 ? Json(p.modes) : Json()},
          {"family", p.family.empty() ? Json() : Json(p.family)},
          {"integrator", p.integrator},
          {"tolerance", p.tolerance}};
}

Json probe_json(const study::Outputs& outputs, const study::Probe& p) {
  Json j = point_json(p.point);
  j["outcome"] = study::outcome_name(p.outcome);
  if (!p.reason.empty()) j["reason"] = p.reason;
  j["of_accuracy"] = p.use;
  j["distances"] = distances_json(outputs, p.distances);
  j["until"] = p.walk.time;
  j["steps"] = p.walk.steps;
  j["evaluations"] = p.walk.evaluations;
  j["cost_seconds"] = p.cost;
  return j;
}

/// A limit that is asked of nothing is infinite, which JSON has no number for.
Json reference_json(const study::Outputs& outputs, const study::Yardstick& yardstick) {
  const study::Reference& r = yardstick.reference;
  Json j = point_json(r.point);
  if (r.added_by) j["added_by"] = point_json(*r.added_by);
  j["ranges"] = distances_json(outputs, r.ranges);
  j["counted_ranges"] = distances_json(outputs, r.scales);
  j["allowed"] = distances_json(outputs, yardstick.limits);
  j["own_error"] = distances_json(outputs, r.own);
  j["own_error_of_accuracy"] = yardstick.own_use();
  return j;
}

}  // namespace

Json search_json(const AdviceQuestion& question, const study::Advice& advice, const std::string& reason) {
  const Scene& scene = question.prepared.scene;
  Json j{{"scene", scene.file}, {"name", scene.name}};
  const auto number = [](const std::optional<double>& x) { return x ? Json(*x) : Json(); };
  j["accuracy"] = {{"share", number(question.accuracy.share)},
                   {"length", number(question.accuracy.length)},
                   {"angle", number(question.accuracy.angle)}};
  j["outputs"] = question.outputs.names();
  j["measures"] = measure_json(question.outputs);
  j["floors"] = study::floors_text();
  if (!advice.until.empty()) j["until"] = advice.until;
  if (advice.yardstick) j["reference"] = reference_json(question.outputs, *advice.yardstick);
  j["advice"] = nullptr;
  if (!reason.empty()) j["reason"] = reason;
  j["probes"] = Json::array();
  for (const study::Probe& p : advice.probes) j["probes"].push_back(probe_json(question.outputs, p));
  j["cpu_seconds"] = advice.cpu_seconds;
  j["limit_seconds"] = advice.limit_seconds;
  j["models"] = {{"all", advice.models}, {"tried", advice.models_tried}};
  return j;
}

Json advice_json(const AdviceQuestion& question, const study::Advice& advice, const std::string& left_out,
                 const std::vector<std::string>& changes, const std::string& scene_lines) {
  Json j = search_json(question, advice, "");
  Json choice = probe_json(question.outputs, *advice.choice);
  choice["steps_limited_by"] = advice.steps.cause();
  choice["left_out"] = left_out;
  choice["indicators"] = indicators_json(advice.indicators);
  choice["overrides"] = changes;
  choice["scene_lines"] = scene_lines;
  j["advice"] = std::move(choice);
  j["next_up"] = Json::array();
  for (const study::Probe& p : advice.above) j["next_up"].push_back(probe_json(question.outputs, p));
  return j;
}

}  // namespace withy
