#include "withy/apps/withy/certificate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "withy/apps/withy/progress.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/core/simulation/paired_run.hpp"
#include "withy/core/simulation/validity_limits.hpp"
#include "withy/results/json_text.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

/// Modes in one direction alone: taken as the plane of rotation.
bool one_direction(const BodyValidity& body) { return body.highest.size() == 1; }

std::size_t greatest_share(const LoadRatio& load) {
  std::size_t most = 0;
  for (std::size_t k = 1; k < motion_terms; ++k)
    if (std::abs(load.shares[k]) > std::abs(load.shares[most])) most = k;
  return most;
}

std::string percent(double ratio) { return fmt::format("{:.2g} %", 100 * ratio); }

Json body_json(const BodyValidity& b, const RunSummary& summary) {
  Json j{{"name", b.name},
         {"fundamental_frequency", b.fundamental},
         {"rate_over_fundamental", {{"value", b.rate_ratio}, {"time", b.rate_time}}}};
  Json shares = Json::object();
  for (std::size_t k = 0; k < motion_terms; ++k)
    if (b.load.shares[k] != 0) shares[motion_term_name(k)] = b.load.shares[k];
  j["load_over_buckling"] = {{"value", b.load.size()},
                             {"sense", b.load.greatest > -b.load.least ? "stiffening" : "buckling"},
                             {"time", b.load_time},
                             {"binds", b.load.size() > 0 ? Json(motion_term_name(greatest_share(b.load))) : Json()},
                             {"shares", std::move(shares)},
                             {"compressive", b.buckling}};
  const auto deflection = summary.peak_deflection_ratio.find(b.name);
  j["deflection_over_length"] = deflection != summary.peak_deflection_ratio.end() ? Json(deflection->second) : Json();
  j["highest_mode"] = Json::object();
  for (const HighestMode& h : b.highest) {
    j["highest_mode"][h.family] = {
        {"frequency", h.frequency}, {"modes", h.modes}, {"energy_share", h.modes > 1 ? Json(h.share) : Json()}};
  }
  return j;
}

std::string error_text(const ErrorEstimate& e, const Beyond& beyond, const Engine& engine) {
  std::string out;
  for (const HingeNode& hinge : engine.model().hinges()) {
    const auto found = e.distances.hinges.find(hinge.name);
    if (found == e.distances.hinges.end()) continue;
    const auto columns = coordinate_columns(hinge);
    const std::string unit = columns.size() == 1 ? columns[0].unit : "";
    out += out.empty() ? "" : ", ";
    out += hinge.name + ' ';
    out += unit == "rad" ? fmt::format("{:.2g} deg", found->second * 180 / std::numbers::pi)
                         : fmt::format("{:.2g}{}", found->second, unit.empty() ? "" : ' ' + unit);
  }
  for (const auto& [tip, d] : e.distances.tips)
    out += fmt::format("{}{} {:.2g} mm", out.empty() ? "" : ", ", tip, 1e3 * d);
  if (out.empty()) return "no hinge moves and no body has a tip";
  out = fmt::format("against {}, estimated by a coarse run of both: {}", beyond.formulation, out);
  if (e.distances.until < e.end)
    out += fmt::format("; up to {:.4g} s, where the estimate's budget ended", e.distances.until);
  return out;
}

std::string body_text(const BodyValidity& b, const RunSummary& summary) {
  std::string out =
      fmt::format("turns at {:.2g} of its fundamental frequency {:.4g} rad/s", b.rate_ratio, b.fundamental);
  if (b.load.size() > 0) {
    const std::size_t most = greatest_share(b.load);
    out += fmt::format("; {} load {:.2g} of the buckling load, most of it from {}",
                       b.load.greatest > -b.load.least ? "stiffening" : "compressive", b.load.size(),
                       motion_term_name(most));
  }
  if (const auto d = summary.peak_deflection_ratio.find(b.name); d != summary.peak_deflection_ratio.end())
    out += fmt::format("; tip deflection {:.2g} of its length", d->second);
  for (const HighestMode& h : b.highest)
    if (h.modes > 1)
      out += fmt::format("; highest of {} {} modes has {} of their energy", h.modes, h.family, percent(h.share));
  return out;
}

/// The last formulation of a run that changes it; nothing where the run has one.
const Rung* last_rung(const Engine& engine, const Evidence& evidence) {
  return evidence.escalated != nullptr ? &engine.rungs()[evidence.escalated->stretches.back().rung] : nullptr;
}

const EquationsOfMotion& last_equations(const Engine& engine, const Evidence& evidence) {
  const Rung* rung = last_rung(engine, evidence);
  return rung != nullptr ? *rung->equations : engine.equations();
}

std::optional<Terms> last_terms(const Engine& engine, const Evidence& evidence) {
  const Rung* rung = last_rung(engine, evidence);
  return rung != nullptr ? std::optional(rung->terms) : std::nullopt;
}

Json stretches_json(const Engine& engine, const EscalatedRun& run) {
  Json all = Json::array();
  for (const Stretch& s : run.stretches) {
    Json why = Json::array();
    for (const Excess& e : s.excess)
      why.push_back(
          {{"body", e.body}, {"indicator", e.indicator}, {"value", e.value}, {"limit", e.limit}, {"time", e.time}});
    all.push_back({{"formulation", engine.rungs()[s.rung].name},
                   {"start", s.start},
                   {"end", s.end},
                   {"steps", s.steps},
                   {"evaluations", s.evaluations},
                   {"energy_drift", s.energy_drift},
                   {"escalated_because", std::move(why)},
                   {"energy_jump", s.energy_jump}});
  }
  return {{"list", std::move(all)}, {"discarded_evaluations", run.discarded_evaluations}};
}

std::vector<std::string> stretches_text(const Engine& engine, const EscalatedRun& run) {
  std::vector<std::string> lines;
  for (const Stretch& s : run.stretches) {
    std::string text = fmt::format("{} from {:.4g} to {:.4g} s", engine.rungs()[s.rung].name, s.start, s.end);
    if (!s.excess.empty()) {
      const Excess& e = s.excess.front();
      text += e.limit > 0 ? fmt::format("; left since at {:.4g} s {} of '{}' is {:.3g}, limit {:.3g}", e.time,
                                        e.indicator, e.body, e.value, e.limit)
                          : "; left since " + e.indicator;
    }
    lines.push_back(std::move(text));
  }
  return lines;
}

}  // namespace

std::string StepLimit::cause() const {
  if (!limit || product == 0) return "unknown";
  return product > 0.6 * *limit ? "stability" : "accuracy";
}

StepLimit step_limit(const Integrator& integrator, double start, const RunSummary& summary) {
  StepLimit s;
  s.limit = integrator.stability_limit();
  if (summary.steps.accepted == 0) return s;
  s.mean = (summary.final.time - start) / static_cast<double>(summary.steps.accepted);
  s.fastest = summary.fastest_mode;
  s.product = s.mean * s.fastest;
  return s;
}

StepLimit step_limit(const Engine& engine, const RunSummary& summary) {
  StepLimit s = step_limit(*engine.scene().integrator, engine.scene().initial.time, summary);
  if (s.cause() != "stability") return s;
  const State& state = summary.final;
  s.fewer = best_slowing(engine.model(), engine.equations().system(state.time, state.y));
  // Those with error control, so that no step need be chosen. The first folds stiffness into a symmetric mass matrix.
  for (const std::string id : {"imex", "radau"}) {
    const bool able = id != "imex" || engine.equations().linearly_implicit() != nullptr;
    if (able && engine.registry().find<Integrator>(id) != nullptr) s.unlimited.push_back(id);
  }
  return s;
}

std::string step_limit_text(const StepLimit& s) {
  if (!s.limit) return fmt::format("mean step times fastest mode {:.2g}", s.product);
  if (std::isinf(*s.limit))
    return fmt::format("limited by {}: mean step times fastest mode {:.2g}, stable at any step", s.cause(), s.product);
  std::string text = fmt::format("limited by {}: mean step times fastest mode {:.2g}, stable to {:.3g}", s.cause(),
                                 s.product, *s.limit);
  if (s.fewer && s.fewer->fastest > 0 && s.fewer->fastest < s.fastest)
    text +=
        fmt::format("; without {} the fastest mode is {:.3g} rad/s in place of {:.3g}, for steps {:.2g} times as long",
                    s.fewer->mode, s.fewer->fastest, s.fastest, s.fastest / s.fewer->fastest);
  if (!s.unlimited.empty()) text += fmt::format("; no vibration limits the steps of {}", fmt::join(s.unlimited, ", "));
  return text;
}

ErrorEstimate estimate_error(const Engine& engine, const EquationsOfMotion& used_equations, const Beyond& beyond,
                             const RunSummary& summary) {
  const PairedTolerances coarse = paired_tolerances(summary);
  const auto integrator = make_integrator(engine.registry(), "dopri5",
                                          Value::map({{"rtol", Value(coarse.rtol)}, {"atol", Value(coarse.atol)}}));
  ErrorEstimate e;
  e.end = summary.final.time;
  PairedRunOptions options;
  options.end = summary.final.time;
  options.output = engine.scene().output;
  options.most_evaluations = summary.steps.evaluations;
  options.interrupted = interrupted;
  const PairedRun run = run_paired(
      engine.model(), used_equations, *beyond.equations, *integrator, engine.scene().initial, options,
      [&](const State& used, const State& up) {
        add_distances(e.distances, {engine.model(), used_equations, used}, {*beyond.model, *beyond.equations, up});
      });
  e.cpu_seconds = run.cpu_seconds;
  e.distances.until = run.until;
  return e;
}

std::vector<Indicator> indicators(const Scene& scene, const RunSummary& summary, std::optional<Terms> used) {
  const Terms terms = used.value_or(scene.formulation->terms());
  std::vector<Indicator> all;
  for (const BodyValidity& b : summary.validity.bodies) {
    const BodyNode& node = scene.model->bodies()[static_cast<std::size_t>(scene.model->body(b.name))];
    const Terms own = node.terms.value_or(terms);
    if (!second_order(own)) {
      all.push_back({"rate of '" + b.name + "' over its fundamental frequency", b.rate_ratio,
                     rate_limit(own, one_direction(b)), "frequencies of vibration are 1 % wrong"});
      all.push_back({"load of '" + b.name + "' over its buckling load", b.load.size(), load_limit,
                     "the second-order terms left out act"});
    }
    const auto d = summary.peak_deflection_ratio.find(b.name);
    if (d != summary.peak_deflection_ratio.end() && own.strain != StrainOrder::exact)
      all.push_back({"tip deflection of '" + b.name + "' over its length", d->second, deflection_limit,
                     "deflections are not small"});
    for (const HighestMode& h : b.highest) {
      if (h.modes > 1)
        all.push_back({"energy of the highest " + h.family + " mode of '" + b.name + "'", h.share, 0.1,
                       "modes that were left out would take part"});
    }
  }
  if (summary.conditioning.condition > 0) {
    all.push_back({"condition of the mass matrix times the rounding unit",
                   summary.conditioning.condition * std::numeric_limits<double>::epsilon(), 1e-6,
                   "accelerations have fewer than six digits"});
  }
  std::stable_sort(all.begin(), all.end(), [](const Indicator& a, const Indicator& b) { return a.use() > b.use(); });
  return all;
}

Json certificate_json(const Engine& engine, const RunSummary& summary, const Evidence& evidence) {
  const Scene& scene = engine.scene();
  Json c;
  c["program"] = "withy " WITHY_VERSION;
  c["formulation"] = {{"name", scene.formulation_name}, {"meaning", engine.formulation_summary()}};
  if (evidence.escalated != nullptr) c["stretches"] = stretches_json(engine, *evidence.escalated);
  c["integrator"] = value_json(scene.source.at("integrator"));
  c["output_interval"] = scene.output;
  c["compiled"] = last_equations(engine, evidence).savings();
  c["energy_drift"] = summary.energy_drift;
  // Digits lost in solving for accelerations: no result is better than this, whatever the integrator's tolerance.
  const double condition = summary.conditioning.condition;
  c["condition_times_epsilon"] = condition > 0 ? Json(condition * std::numeric_limits<double>::epsilon()) : Json();
  c["samples"] = summary.validity.samples;
  c["bodies"] = Json::array();
  for (const BodyValidity& b : summary.validity.bodies) c["bodies"].push_back(body_json(b, summary));
  const NeglectedAcceleration& n = summary.validity.neglected;
  c["neglected_acceleration"] =
      evidence.beyond != nullptr && n.samples > 0
          ? Json{{"against", evidence.beyond->formulation}, {"rms", n.rms}, {"peak", n.peak}, {"samples", n.samples}}
          : Json();
  if (evidence.estimate != nullptr && evidence.beyond != nullptr) {
    const ErrorEstimate& e = *evidence.estimate;
    c["estimated_error"] = {{"against", evidence.beyond->formulation},
                            {"hinges", e.distances.hinges},
                            {"tips", e.distances.tips},
                            {"until", e.distances.until},
                            {"cpu_seconds", e.cpu_seconds}};
  } else {
    c["estimated_error"] = Json();
  }
  const StepLimit s = step_limit(engine, summary);
  c["steps"] = {{"limited_by", s.cause()},
                {"mean", s.mean},
                {"fastest_mode", summary.fastest_mode > 0 ? Json(summary.fastest_mode) : Json()},
                {"step_times_fastest_mode", s.product > 0 ? Json(s.product) : Json()},
                {"stability_limit", s.limit ? Json(*s.limit) : Json()}};
  if (s.fewer) c["steps"]["fewer_modes"] = {{"without", s.fewer->mode}, {"fastest_mode", s.fewer->fastest}};
  if (!s.unlimited.empty()) c["steps"]["unlimited_integrators"] = s.unlimited;
  c["indicators"] = Json::array();
  for (const Indicator& i : indicators(scene, summary, last_terms(engine, evidence)))
    c["indicators"].push_back({{"what", i.text}, {"value", i.value}, {"limit", i.limit}, {"beyond", i.meaning}});
  return c;
}

std::string certificate_text(const Engine& engine, const RunSummary& summary, const Evidence& evidence) {
  std::string out = "\ncertificate\n";
  const auto line = [&out](const std::string& what, const std::string& text) {
    out += fmt::format("{:<23} {}\n", what, text);
  };
  line("modelled", engine.formulation_summary());
  if (evidence.escalated != nullptr) {
    for (const std::string& text : stretches_text(engine, *evidence.escalated)) line("", text);
  }
  const NeglectedAcceleration& n = summary.validity.neglected;
  if (evidence.beyond != nullptr && n.samples > 0) {
    line("left out", fmt::format("{} of the accelerations in the mean, {} at the peaks, against {} ({} samples)",
                                 percent(n.rms), percent(n.peak), evidence.beyond->formulation, n.samples));
  }
  if (evidence.estimate != nullptr && evidence.beyond != nullptr)
    line("error", error_text(*evidence.estimate, *evidence.beyond, engine));
  for (const BodyValidity& b : summary.validity.bodies) line(b.name, body_text(b, summary));
  const auto all = indicators(engine.scene(), summary, last_terms(engine, evidence));
  if (!all.empty()) {
    const Indicator& first = all.front();
    line("binds", fmt::format("{}: {:.2g}, limit {:.3g}{}", first.text, first.value, first.limit,
                              first.use() > 1 ? "; beyond it " + first.meaning : ""));
  }
  const StepLimit s = step_limit(engine, summary);
  if (s.product > 0) line("steps", step_limit_text(s));
  return out;
}

}  // namespace withy::app
