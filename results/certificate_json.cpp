#include "withy/results/certificate_json.hpp"

#include <nlohmann/json.hpp>

#include "withy/results/json_text.hpp"
#include "withy/results/run_json.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;
using study::Certificate;

/// The formulation that a body is modelled in: its own, else the scene's.
std::string formulation_of(const std::string& body, const Certificate& certificate) {
  for (const study::OwnFormulation& own : certificate.own)
    if (own.body == body) return own.formulation;
  return certificate.formulation;
}

Json body_json(const BodyValidity& b, const Certificate& certificate, const RunSummary& summary) {
  Json j{{"name", b.name},
         {"formulation", formulation_of(b.name, certificate)},
         {"fundamental_frequency", b.fundamental},
         {"rate_over_fundamental", {{"value", b.rate_ratio}, {"time", b.rate_time}}},
         {"spin_over_bending", {{"value", b.spin_ratio}, {"time", b.spin_time}}}};
  Json shares = Json::object();
  for (std::size_t k = 0; k < motion_terms; ++k)
    if (b.load.shares[k] != 0) shares[motion_term_name(k)] = b.load.shares[k];
  j["load_over_buckling"] = {
      {"value", b.load.size()},
      {"sense", b.load.stiffens ? "stiffening" : "buckling"},
      {"time", b.load_time},
      {"binds", b.load.size() > 0 ? Json(motion_term_name(study::greatest_share(b.load))) : Json()},
      {"shares", std::move(shares)},
      {"compressive", b.buckling}};
  if (b.whole.size() > 0) j["load_over_buckling"]["of_all_segments"] = b.whole.size();
  const auto deflection = summary.peak_deflection_ratio.find(b.name);
  j["deflection_over_length"] = deflection != summary.peak_deflection_ratio.end() ? Json(deflection->second) : Json();
  const auto angle = summary.peak_section_angle.find(b.name);
  j["section_angle"] = angle != summary.peak_section_angle.end() ? Json(angle->second) : Json();
  std::string measured = b.station;
  for (const std::string& station : b.beside) measured += ", " + station;
  j["deflection_of"] = measured.empty() ? Json() : Json(measured);
  j["highest_mode"] = Json::object();
  for (const HighestMode& h : b.highest) {
    j["highest_mode"][h.family] = {
        {"frequency", h.frequency}, {"modes", h.modes}, {"energy_share", h.modes > 1 ? Json(h.share) : Json()}};
  }
  return j;
}

/// Parts of drifts; null of those that are not told apart.
Json parts_json(const study::DriftShares& shares, double study::DriftShare::*part, bool momenta) {
  const auto of = [&](const std::optional<study::DriftShare>& share) { return share ? Json(*share.*part) : Json(); };
  Json j{{"energy", of(shares.energy)}};
  if (momenta) j.update({{"linear", of(shares.linear)}, {"angular", of(shares.angular)}});
  return j;
}

Json drift_by_json(const study::Certificate& c) {
  if (!c.shares) return {};
  const bool momenta = c.momentum.conserved;
  return {{"model", parts_json(*c.shares, &study::DriftShare::model, momenta)},
          {"integration", parts_json(*c.shares, &study::DriftShare::integration, momenta)}};
}

Json dropped_json(const Certificate& c) {
  Json groups = Json::object();
  for (const study::DroppedForces& d : c.dropped) {
    Json terms = Json::object();
    for (const study::DroppedTerm& t : d.terms) terms[t.term] = t.share;
    groups[d.group] = {{"share", d.share},
                       {"spread", d.spread},
                       {"moment", d.moment ? Json(*d.moment) : Json()},
                       {"terms", std::move(terms)}};
  }
  return groups;
}

/// Rungs over time, the accuracy asked and what finding them has cost.
Json plan_json(const Certificate& c) {
  const study::RungPlan& plan = *c.plan;
  Json all = Json::array();
  for (const study::PlannedStretch& s : plan.stretches)
    all.push_back({{"formulation", c.rungs[s.stretch.rung]},
                   {"start", s.stretch.start},
                   {"end", s.stretch.end},
                   {"accuracy_used", s.use}});
  Json evaluations = Json::object();
  for (std::size_t i = 0; i < c.rungs.size(); ++i)
    evaluations[c.rungs[i]] = {{"run", i < plan.run_evaluations.size() ? plan.run_evaluations[i] : 0},
                               {"coarse", plan.evaluations[i]}};
  Json above;
  if (!plan.above.empty()) above = {{"formulation", plan.above}, {"share_at_an_instant", plan.above_share}};
  return {{"list", std::move(all)},          {"accuracy", plan.accuracy},
          {"accuracy_used", plan.use},       {"worst", plan.worst.empty() ? Json() : Json(plan.worst)},
          {"windows", plan.windows},         {"repeated", plan.repeated},
          {"integrator", plan.integrator},   {"evaluations", std::move(evaluations)},
          {"not_compared", std::move(above)}};
}

Json estimate_json(const Certificate& c) {
  if (!c.estimate) return {};
  const study::ErrorEstimate& e = *c.estimate;
  Json j = {{"against", e.against}};
  j.update(named_distances_json(e.distances));
  j["at_most"] = e.at_most;
  j["until"] = e.distances.until;
  j["off"] = e.off;
  j["lacks"] = e.lacks.empty() ? Json() : Json(e.lacks);
  j["evaluations"] = e.evaluations;
  j["cpu_seconds"] = e.cpu_seconds;
  return j;
}

Json more_modes_json(const study::MoreModes& more) {
  Json j = named_distances_json(more.distances);
  j["until"] = more.distances.until;
  j["evaluations"] = more.evaluations;
  j["cpu_seconds"] = more.cpu_seconds;
  return j;
}

Json steps_json(const study::StepLimit& s) {
  Json j = {{"limited_by", s.cause()},
            {"mean", s.mean},
            {"fastest_mode", s.moving > 0 ? Json(s.moving) : Json()},
            {"step_times_fastest_mode", s.product > 0 ? Json(s.product) : Json()},
            {"stability_limit", s.limit ? Json(*s.limit) : Json()},
            {"fastest_pole", s.maker.empty() ? Json() : Json(s.maker)}};
  if (!s.resting.empty()) j["at_rest"] = {{"coordinate", s.resting}, {"pole", s.fastest}};
  if (s.fewer) j["fewer_modes"] = {{"without", s.fewer->mode}, {"fastest_mode", s.fewer->fastest}};
  if (!s.unlimited.empty()) j["unlimited_integrators"] = s.unlimited;
  return j;
}

}  // namespace

Json named_distances_json(const study::NamedDistances& d) {
  return {{"hinges", d.hinges},
          {"tips", d.tips},
          {"deflections", d.deflections},
          {"moments", d.moments},
          {"forces", d.forces}};
}

Json families_json(const std::vector<study::BodyFamilies>& families) {
  Json all = Json::array();
  for (const study::BodyFamilies& f : families)
    all.push_back({{"body", f.body}, {"strain", f.strain}, {"family", f.family}, {"modes", f.modes}});
  return all;
}

Json indicators_json(const std::vector<study::Indicator>& indicators) {
  Json all = Json::array();
  for (const study::Indicator& i : indicators)
    all.push_back({{"what", i.text}, {"value", i.value}, {"limit", i.limit}, {"beyond", i.meaning}});
  return all;
}

Json certificate_json(const Scene& scene, const RunSummary& summary, const Certificate& certificate) {
  Json c;
  c["program"] = "withy " WITHY_VERSION;
  c["formulation"] = {{"name", certificate.formulation}, {"meaning", certificate.meaning}};
  for (const study::OwnFormulation& own : certificate.own)
    c["formulation"]["bodies"][own.body] = {{"name", own.formulation}, {"meaning", own.meaning}};
  if (certificate.plan) c["stretches"] = plan_json(certificate);
  c["integrator"] = value_json(scene.source.at("integrator"));
  c["output_interval"] = scene.output;
  c["compiled"] = certificate.compiled;
  c["energy_drift"] = certificate.energy_drift;
  c["energy_drift_without_truncation"] = certificate.untruncated_drift;
  c["momentum_drift"] = certificate.momentum.conserved
                            ? Json{{"linear", certificate.momentum.linear}, {"angular", certificate.momentum.angular}}
                            : Json();
  c["drift_by"] = drift_by_json(certificate);
  c["dropped"] = dropped_json(certificate);
  c["families"] = families_json(certificate.families);
  c["acceleration_rounding"] = certificate.rounding ? Json(*certificate.rounding) : Json();
  c["samples"] = certificate.samples;
  c["bodies"] = Json::array();
  for (const BodyValidity& b : certificate.bodies) c["bodies"].push_back(body_json(b, certificate, summary));
  const NeglectedAcceleration& n = certificate.neglected;
  c["neglected_acceleration"] =
      !certificate.against.empty() && n.samples > 0
          ? Json{{"against", certificate.against}, {"rms", n.rms}, {"peak", n.peak}, {"samples", n.samples}}
          : Json();
  c["estimated_error"] = estimate_json(certificate);
  if (!certificate.estimate) c["without_estimate"] = certificate.without_estimate;
  c["one_mode_more"] = certificate.more_modes.more ? more_modes_json(*certificate.more_modes.more) : Json();
  if (!certificate.more_modes.why_not.empty()) c["without_one_mode_more"] = certificate.more_modes.why_not;
  c["steps"] = steps_json(certificate.steps);
  c["indicators"] = indicators_json(certificate.indicators);
  return c;
}

Json run_json(const Scene& scene, const RunSummary& summary, const Certificate& certificate) {
  Json j = run_json(scene, summary);
  j["certificate"] = certificate_json(scene, summary, certificate);
  return j;
}

}  // namespace withy
