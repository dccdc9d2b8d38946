#include "withy/study/indicators.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/measured_place.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/validity_limits.hpp"

namespace withy::study {
namespace {

/// Of the elastic energy of a family: what its highest mode may have before the next one is missed.
constexpr double highest_mode_limit = 0.1;

/// Of what spins in the plane that a body bends in rounding leaves less.
constexpr double least_spin = 1e-9;

/// Modes in one direction alone: taken as the plane of rotation. What a plate or a body of a file bends like is not
/// said.
bool one_direction(const BodyValidity& body) {
  return body.highest.size() == 1 && body.highest.front().family.starts_with("bending_");
}

/// Between segments kinematics is exact, so that the load of each counts by itself; unless it is truncated: then what
/// lies between them is no better than within one piece, and the load of the whole counts.
void add_load(std::vector<Indicator>& all, const BodyNode& node, const BodyValidity& b, const Terms& own) {
  const auto add = [&](const std::string& name, const LoadRatio& load) {
    all.push_back({"load of '" + name + "' over its buckling load", load.size(), load_limit,
                   "the second-order terms left out act"});
  };
  const bool as_one = node.segment && node.segment->body != nullptr && own.truncation != Truncation::none;
  if (!as_one) add(b.name, b.load);
  if (as_one && node.segment->index == 0) add(node.segment->whole, b.whole);
}

void add_body(std::vector<Indicator>& all, const Scene& scene, const BodyValidity& b, const Terms& own,
              const RunSummary& summary) {
  const BodyNode& node = scene.model->bodies()[static_cast<std::size_t>(scene.model->body(b.name))];
  if (!second_order(own)) {
    all.push_back({"rate of '" + b.name + "' over its fundamental frequency", b.rate_ratio,
                   rate_limit(own, one_direction(b)), "natural frequencies are 1 % off"});
    add_load(all, node, b, own);
  }
  if (without_gyroscopic(own) && b.spin_ratio > least_spin)
    all.push_back({"moment of what spins on '" + b.name + "' over what bends it", b.spin_ratio, spin_limit,
                   "natural frequencies are 1 % off"});
  const std::optional<Bend> bend = greatest_bend(b, summary);
  if (bend && own.strain != StrainOrder::exact) {
    all.push_back({deflection_name(b) + " of '" + b.name + "' over its length", bend->deflection, deflection_limit,
                   "deflections are not small"});
    if (bend->bent() && bend->by_angle())
      all.push_back({"angle that " + measured_name(b) + " of '" + b.name + "' turns by while it is bent", bend->angle,
                     angle_limit, "angles are not small"});
  }
  if (needs_no_modes(scene, b, summary)) return;
  for (const HighestMode& h : b.highest) {
    if (h.modes > 1)
      all.push_back({"energy of the highest " + before_mode(h.family) + "mode of '" + b.name + "'", h.share,
                     highest_mode_limit, "modes that were left out would take part"});
  }
}

/// Steps that nobody controls are to follow the lowest vibration of each body: six of them a period and more.
void add_step(std::vector<Indicator>& all, const Scene& scene, const RunSummary& summary) {
  constexpr double radians_a_step = 1;
  if (scene.source.at("integrator").find("rtol") != nullptr || summary.steps.accepted == 0) return;
  const double step = (summary.reached - scene.initial.time) / static_cast<double>(summary.steps.accepted);
  for (const BodyValidity& b : summary.validity.bodies)
    if (b.fundamental > 0)
      all.push_back({"step times the lowest frequency of '" + b.name + "'", step * b.fundamental, radians_a_step,
                     "its vibrations are not followed"});
}

}  // namespace

std::string measured_name(const BodyValidity& body) {
  std::string name = MeasuredPlace{body.station, {}}.in_words();
  for (const std::string& station : body.beside) name += ", " + station;
  return body.beside.empty() ? name : "what moves most of " + name;
}

std::string deflection_name(const BodyValidity& body) {
  if (body.station == "tip" && body.beside.empty()) return "tip deflection";
  return "deflection of " + measured_name(body);
}

std::optional<Bend> greatest_bend(const BodyValidity& body, const RunSummary& summary) {
  const auto deflection = summary.peak_deflection_ratio.find(body.name);
  const auto angle = summary.peak_section_angle.find(body.name);
  if (deflection == summary.peak_deflection_ratio.end()) return {};
  return Bend{deflection->second, angle == summary.peak_section_angle.end() ? 0 : angle->second};
}

std::string before_mode(const std::string& family) { return family == "mode" ? "" : family + ' '; }

bool needs_no_modes(const Scene& scene, const BodyValidity& body, const RunSummary& summary) {
  constexpr double of_tolerance = 1e3;
  const BodyNode& node = scene.model->bodies()[static_cast<std::size_t>(scene.model->body(body.name))];
  if (node.segment) return true;
  const Value* atol = scene.source.at("integrator").find("atol");
  const auto ratio = summary.peak_deflection_ratio.find(body.name);
  if (atol == nullptr || ratio == summary.peak_deflection_ratio.end()) return false;
  return ratio->second * node.body->shape().length <= of_tolerance * atol->number();
}

std::vector<Indicator> indicators(const Scene& scene, const RunSummary& summary, std::optional<Terms> used) {
  const Terms terms = used.value_or(scene.formulation->terms());
  std::vector<Indicator> all;
  for (const BodyValidity& b : summary.validity.bodies) {
    const BodyNode& node = scene.model->bodies()[static_cast<std::size_t>(scene.model->body(b.name))];
    add_body(all, scene, b, node.terms.value_or(terms), summary);
  }
  add_step(all, scene, summary);
  std::stable_sort(all.begin(), all.end(), [](const Indicator& a, const Indicator& b) { return a.use() > b.use(); });
  return all;
}

void add_in_place(std::vector<Indicator>& indicators, Indicator indicator) {
  const auto after =
      std::find_if(indicators.begin(), indicators.end(), [&](const Indicator& i) { return i.use() < indicator.use(); });
  indicators.insert(after, std::move(indicator));
}

std::optional<double> add_rounding(std::vector<Indicator>& indicators, const Model& model,
                                   const EquationsOfMotion& equations, const State& state) {
  constexpr double limit = 1e-6;
  const double rounding = rounding_error(model, equations, state).relative;
  if (!std::isfinite(rounding)) return {};
  add_in_place(indicators, {"error that rounding leaves the accelerations", rounding, limit,
                            "accelerations have fewer than six digits"});
  return rounding;
}

std::vector<Indicator> indicators_at(const Prepared& prepared, const State& state) {
  RunOptions options;
  options.end = state.time;
  options.deflection_limit = prepared.scene.deflection_limit;
  try {
    const RunSummary summary = withy::simulate(prepared.model(), *prepared.equations, *prepared.scene.integrator, state,
                                               options, [](const State&) {});
    if (summary.status != RunStatus::completed) return {};
    std::vector<Indicator> all = indicators(prepared.scene, summary);
    add_rounding(all, prepared.model(), *prepared.equations, state);
    return all;
  } catch (const std::invalid_argument&) {  // an integrator that cannot treat these equations
    return {};
  }
}

}  // namespace withy::study
