#include "withy/apps/withy/advice_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/apps/withy/certificate.hpp"
#include "withy/apps/withy/scene_edit.hpp"
#include "withy/core/plugin/formulation.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

std::string modes_text(const TradePoint& p) {
  if (p.modes == 0) return "modes as they are";
  return fmt::format("{} mode{}{}", p.modes, p.modes == 1 ? "" : "s", p.family.empty() ? "" : ' ' + p.family);
}

std::string integration_text(const TradePoint& p) { return fmt::format("{} at {:g}", p.integrator, p.tolerance); }

/// Of the accuracy asked, or where that is a share, the same share: "0.61 %".
std::string use_text(const Advisor& a, double use) {
  if (a.accuracy().share && !a.accuracy().length && !a.accuracy().angle)
    return fmt::format("{:.2g} %", 100 * use * *a.accuracy().share);
  return fmt::format("{:.2g} of the accuracy", use);
}

std::string distances_text(const MeasuredOutputs& outputs, const PerMeasure& d) {
  std::string out;
  constexpr std::array<const char*, measures> nouns = {"angles", "slides", "places", "deflections"};
  for (std::size_t m = 0; m < measures; ++m) {
    if (!outputs.has(static_cast<Measure>(m))) continue;
    out += fmt::format(
        "{}{} {}", out.empty() ? "" : ", ", nouns.at(m),
        m == 0 ? fmt::format("{:.2g} deg", d[m] * 180 / std::numbers::pi) : fmt::format("{:.2g} mm", 1e3 * d[m]));
  }
  return out;
}

std::string milliseconds(double seconds) { return fmt::format("{:.3g} ms", 1e3 * seconds); }

/// What a formulation does not know.
std::string left_out(const Terms& terms) {
  switch (terms.truncation) {
    case Truncation::ruthless:
      return "every product of an elastic coordinate or rate with the rigid motion: stiffening and softening by "
             "rotation "
             "and load, foreshortening, change of inertia by deflection";
    case Truncation::strict:
      return terms.strain == StrainOrder::linear
                 ? "second-order kinematics, and all beyond the first order of elastic coordinates and rates"
                 : "all beyond the first order of elastic coordinates and rates, and that order in the columns of the "
                   "mass matrix that belong to the modes";
    case Truncation::symmetric:
      return terms.strain == StrainOrder::linear ? "second-order kinematics, and all beyond the first order of the "
                                                   "kinetic energy in the elastic coordinates"
                                                 : "all beyond the first order of the kinetic energy in the elastic "
                                                   "coordinates";
    case Truncation::none:
      break;
  }
  if (terms.strain == StrainOrder::linear)
    return "second-order kinematics: foreshortening, and with it stiffening and buckling by axial load";
  if (terms.strain == StrainOrder::quadratic) return "the third and higher orders of deflection";
  return "extension along beams and shear";
}

/// What the model does not know.
std::string left_out(const ProbedModel& model) {
  if (model.scene.model->layout().bodies.empty()) return "nothing: no body is flexible";
  std::string text = left_out(model.scene.formulation->terms());
  std::string bodies;
  for (const auto& own : model.point.bodies) bodies += (bodies.empty() ? "; of " : ", ") + own.first;
  if (bodies.empty()) return text;
  const Terms least{StrainOrder::linear, Truncation::ruthless};  // bodies have no other formulation of their own
  return text + bodies + " " + left_out(least);
}

/// The best that the probes with a property did: cheapest that passed, else the least wrong of those that went
/// furthest.
template <class Property>
const Probe* best_of(const Advisor& a, Property&& property) {
  const Probe* best = nullptr;
  for (const Probe& p : a.probes()) {
    if (!property(p.point)) continue;
    if (best == nullptr || p.passed() != best->passed()) {
      if (best == nullptr || p.passed()) best = &p;
    } else if (p.passed()) {
      if (a.cost(p) < a.cost(*best)) best = &p;
    } else if (std::pair(p.walk.time, -p.use) > std::pair(best->walk.time, -best->use)) {
      best = &p;
    }
  }
  return best;
}

/// How a probe fared beside the choice, as a clause.
std::string fared(const Advisor& a, const Probe& p) {
  const Probe& choice = *a.choice();
  const double end = choice.walk.time;
  switch (p.outcome) {
    case Probe::Outcome::passed:
      return fmt::format("holds it at {:.2g} times the cost, with {} and {}: {}", a.cost(p) / a.cost(choice),
                         modes_text(p.point), integration_text(p.point), use_text(a, p.use));
    case Probe::Outcome::inaccurate:
      return p.walk.time < end ? fmt::format("with {}, {} off when it was cut at {:.3g} of {:.3g} s",
                                             modes_text(p.point), use_text(a, p.use), p.walk.time, end)
                               : fmt::format("with {}, {} off", modes_text(p.point), use_text(a, p.use));
    case Probe::Outcome::too_costly:
      return fmt::format("with {} and {}, not done when it had cost more than the choice", modes_text(p.point),
                         integration_text(p.point));
    case Probe::Outcome::stopped:
      return fmt::format("with {}, stops at {:.3g} s: {}", modes_text(p.point), p.walk.time, p.reason);
    default:
      return p.reason;
  }
}

Json distances_json(const MeasuredOutputs& outputs, const PerMeasure& d) {
  Json j = Json::object();
  for (std::size_t m = 0; m < measures; ++m)
    if (outputs.has(static_cast<Measure>(m))) j[measure_name(m)] = d[m];
  return j;
}

Json point_json(const TradePoint& p) {
  Json bodies = Json::object();
  for (const auto& [body, formulation] : p.bodies) bodies[body] = formulation;
  return {{"formulation", p.formulation},
          {"bodies", std::move(bodies)},
          {"modes", p.modes > 0 ? Json(p.modes) : Json()},
          {"family", p.family.empty() ? Json() : Json(p.family)},
          {"integrator", p.integrator},
          {"tolerance", p.tolerance}};
}

Json probe_json(const Advisor& a, const Probe& p) {
  Json j = point_json(p.point);
  j["outcome"] = outcome_name(p.outcome);
  if (!p.reason.empty()) j["reason"] = p.reason;
  j["of_accuracy"] = p.use;
  j["distances"] = distances_json(a.outputs(), p.distances);
  j["until"] = p.walk.time;
  j["steps"] = p.walk.steps;
  j["evaluations"] = p.walk.evaluations;
  j["cost_seconds"] = a.cost(p);
  return j;
}

}  // namespace

std::string no_advice_text(const Advisor& a) {
  if (!a.trouble().empty()) return a.trouble();
  std::string text = "none of the candidates holds " + a.accuracy().text();
  if (!a.reference()) return text;
  text += fmt::format("; the reference ({}) is known to {}.", a.reference()->point.text(),
                      use_text(a, a.reference()->own_use()));
  const Probe* nearest = nullptr;
  for (const Probe& p : a.probes())
    if (p.outcome == Probe::Outcome::inaccurate && p.walk.end == Walk::End::reached &&
        (nearest == nullptr || p.use < nearest->use))
      nearest = &p;
  if (nearest != nullptr)
    text += fmt::format(" Nearest: {}, {} off. Allow more --modes or tighter --tolerances.", nearest->point.text(),
                        use_text(a, nearest->use));
  return text;
}

std::string advice_text(const Advice& advice) {
  Advisor& a = advice.advisor;
  const Probe& choice = *a.choice();
  const Reference& reference = *a.reference();
  const ProbedModel& model = a.model_of(choice.point);
  const Scene& scene = advice.engine.scene();
  std::string out;
  const auto line = [&](const std::string& what, const std::string& text) {
    out += fmt::format("{:<12}{}\n", what, text);
  };
  std::string names;
  for (const std::string& n : a.outputs().names()) names += (names.empty() ? "" : ", ") + n;
  out += fmt::format("{}: {}{} of {}\n\n", scene.name.empty() ? scene.file : scene.name, a.accuracy().text(),
                     a.accuracy().share ? " of the greatest way" : "", names);
  line("advice", fmt::format("{}, {}, {}", choice.point.formulation_text(), modes_text(choice.point),
                             integration_text(choice.point)));
  line("error", fmt::format("{} ({}); the reference itself is known to {}", use_text(a, choice.use),
                            distances_text(a.outputs(), choice.distances), use_text(a, reference.own_use())));
  line("cost", fmt::format("{} of CPU time: {} steps, {} evaluations", milliseconds(a.cost(choice)), choice.walk.steps,
                           choice.walk.evaluations));
  if (advice.steps.product > 0) line("steps", step_limit_text(advice.steps));
  const char* head = "why";
  if (!choice.point.bodies.empty()) {
    const Probe* p =
        best_of(a, [&](const TradePoint& t) { return t.formulation == choice.point.formulation && t.bodies.empty(); });
    if (p != nullptr) {
      line(head, choice.point.formulation + " everywhere: " + fared(a, *p));
      head = "";
    }
  }
  for (const std::string& f : a.candidates().formulations) {
    if (f == choice.point.formulation) continue;
    const Probe* p = best_of(a, [&](const TradePoint& t) { return t.formulation == f; });
    if (p == nullptr) continue;
    line(head, f + ": " + fared(a, *p));
    head = "";
  }
  const auto own = [&](const TradePoint& t) {
    return t.formulation == choice.point.formulation && t.family == choice.point.family;
  };
  if (const Probe* p = best_of(a, [&](const TradePoint& t) { return own(t) && t.modes < choice.point.modes; })) {
    line(head, "fewer modes: " + fared(a, *p));
    head = "";
  }
  for (const std::string& i : a.candidates().integrators) {
    const Probe* p = best_of(a, [&](const TradePoint& t) {
      return own(t) && t.modes == choice.point.modes && t.integrator == i && i != choice.point.integrator;
    });
    if (p == nullptr) continue;
    line(head, i + ": " + fared(a, *p));
    head = "";
  }
  line("left out", left_out(model));
  const auto watched = indicators(model.scene, advice.confirmed);
  if (!watched.empty()) {
    const Indicator& first = watched.front();
    line("binds",
         fmt::format("{}: {:.2g}, limit {:.3g}{}", first.text, first.value, first.limit,
                     first.use() > 1 ? "; beyond it " + first.meaning + ", which the error above has in it" : ""));
  }
  head = "next up";
  for (const Probe& p : a.above()) {
    const bool fails = p.outcome == Probe::Outcome::stopped || p.outcome == Probe::Outcome::refused;
    line(head, fails ? p.point.text() + ": " + p.reason
                     : fmt::format("{}: {} off, {}", p.point.text(), use_text(a, p.use), milliseconds(a.cost(p))));
    head = "";
  }
  line("measured", fmt::format("{} probes, {:.2g} s of CPU time, against {}", a.probes().size(), a.spent(),
                               reference.point.text()));
  out += "\nin the scene:\n\n" + scene_lines(advice.overrides);
  return out;
}

Json search_json(const Engine& engine, const Advisor& a) {
  Json j{{"scene", engine.scene().file}, {"name", engine.scene().name}};
  const auto number = [](const std::optional<double>& x) { return x ? Json(*x) : Json(); };
  j["accuracy"] = {{"share", number(a.accuracy().share)},
                   {"length", number(a.accuracy().length)},
                   {"angle", number(a.accuracy().angle)}};
  j["outputs"] = a.outputs().names();
  if (a.reference()) {
    const Reference& r = *a.reference();
    Json reference = point_json(r.point);
    reference["ways"] = distances_json(a.outputs(), r.ways);
    reference["allowed"] = distances_json(a.outputs(), r.limits);
    reference["own_error"] = distances_json(a.outputs(), r.own);
    reference["own_error_of_accuracy"] = r.own_use();
    j["reference"] = std::move(reference);
  }
  j["advice"] = nullptr;
  if (!a.choice()) j["reason"] = no_advice_text(a);
  j["probes"] = Json::array();
  for (const Probe& p : a.probes()) j["probes"].push_back(probe_json(a, p));
  j["cpu_seconds"] = a.spent();
  return j;
}

Json advice_json(const Advice& advice) {
  Advisor& a = advice.advisor;
  const ProbedModel& model = a.model_of(a.choice()->point);
  Json j = search_json(advice.engine, a);
  Json choice = probe_json(a, *a.choice());
  choice["steps_limited_by"] = advice.steps.cause();
  choice["left_out"] = left_out(model);
  choice["indicators"] = Json::array();
  for (const Indicator& i : indicators(model.scene, advice.confirmed))
    choice["indicators"].push_back({{"what", i.text}, {"value", i.value}, {"limit", i.limit}, {"beyond", i.meaning}});
  choice["overrides"] = advice.overrides;
  choice["scene_lines"] = scene_lines(advice.overrides);
  j["advice"] = std::move(choice);
  j["next_up"] = Json::array();
  for (const Probe& p : a.above()) j["next_up"].push_back(probe_json(a, p));
  return j;
}

}  // namespace withy::app
