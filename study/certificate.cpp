#include "withy/study/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "withy/core/plugin/formulation.hpp"
#include "withy/core/simulation/validity_limits.hpp"
#include "withy/study/candidates.hpp"
#include "withy/study/common_velocity.hpp"
#include "withy/study/formulation_meaning.hpp"
#include "withy/study/vibrations_followed.hpp"

namespace withy::study {
namespace {

/// Flexible bodies in another formulation than the scene's.
std::vector<OwnFormulation> own_formulations(const Scene& scene, Registry& registry) {
  std::vector<OwnFormulation> all;
  for (const std::string& name : flexible_bodies(scene)) {
    const Value* own = scene.source.at("bodies").at(name).find("formulation");
    if (own == nullptr || own->kind() == Value::Kind::null) continue;
    const FormulationWords words = formulation_words_of(*own, registry);
    // By titles: of two with the same name the choices may be others.
    if (words.title != formulation_title(scene)) all.push_back({name, words.title, words.meaning});
  }
  return all;
}

void add_plan(Certificate& c, const Prepared& prepared, RungPlan plan, double reached) {
  for (const Rung& rung : prepared.rungs) c.rungs.push_back(rung.name);
  std::erase_if(plan.stretches, [&](const PlannedStretch& s) {
    return s.stretch.start >= reached && s.stretch.start > plan.stretches.front().stretch.start;
  });
  plan.stretches.back().stretch.end = std::min(plan.stretches.back().stretch.end, reached);
  c.plan = std::move(plan);
}

void add(Certificate& c, const Indicator& indicator) { add_in_place(c.indicators, indicator); }

void add_common_velocity(Certificate& c, std::optional<double> part) {
  constexpr double limit = 0.01;
  if (!part) return;
  add(c, {"part of the accelerations that a velocity of the whole makes", *part, limit,
          "the motion depends on the frame that it is described in, which no other formulation's does"});
}

/// Whether terms are truncated that neither a rate nor a load of a body tells, as in `consistent`.
/// \param used what the run kept in the end, in the place of the scene's formulation
bool truncates_unseen(const Scene& scene, const Terms& used) {
  std::vector<Terms> terms = terms_in_use(scene);
  terms.front() = used;
  return std::any_of(terms.begin(), terms.end(),
                     [](const Terms& t) { return t.truncation != Truncation::none && second_order(t); });
}

/// Of 83 random scenes in `consistent` an output was off by more than a tenth of its range in all 14 beyond this limit,
/// and in 10 of the others, all of which other indicators tell; of 70 further ones in 15 of the 17 beyond it, and in 4
/// of the others, 3 of which other indicators tell. Energy and the share of dropped forces tell them worse.
void add_neglected(Certificate& c, const Scene& scene, const Terms& terms) {
  constexpr double limit = 0.08;
  if (c.neglected.samples == 0 || !truncates_unseen(scene, terms)) return;
  add(c, {"accelerations left out against " + c.against + ", in the mean", c.neglected.rms, limit,
          "outputs may be off by more than a tenth of their ranges"});
}

/// Whether the equations keep energy and momenta in balance themselves: nothing is truncated.
bool conserves(const Scene& scene) {
  const std::vector<Terms> terms = terms_in_use(scene);
  return std::all_of(terms.begin(), terms.end(),
                     [](const Terms& t) { return t.truncation == Truncation::none && t.products_of_speeds; });
}

/// A coarse run that is off the run by more than this part of a range may drift by another amount too: a rest of more
/// than a quarter of what it drifts by may be its own.
constexpr double another_drift = 0.1, rest_of_its_own = 0.25;

/// What a coarse run drifts by beyond the run is the error of its own steps, and with as much in what it has, no share
/// is known. Little of it may be that it is looked at elsewhere.
std::optional<DriftShare> split(double whole, double coarse) {
  if (coarse > (1 + rest_of_its_own) * whole) return {};
  return DriftShare{std::min(coarse, whole), std::abs(whole - coarse)};
}

/// Where the equations conserve, drifts are the integration's. Elsewhere the coarse run of the estimate, in the same
/// equations, drifts by what they leave out; what the run itself drifts by beside that is the integration's.
std::optional<DriftShares> shares_of(const Prepared& prepared, const Evidence& evidence) {
  const RunSummary& s = *evidence.summary;
  if (evidence.plan || s.status != RunStatus::completed) return {};
  const MomentumDrift& momentum = s.momentum;
  if (conserves(prepared.scene))
    return DriftShares{DriftShare{0, s.energy_drift}, DriftShare{0, momentum.linear}, DriftShare{0, momentum.angular}};
  if (!evidence.estimate || evidence.estimate->distances.until < evidence.estimate->end) return {};
  const Drifts& coarse = evidence.estimate->drifts;
  DriftShares shares{split(s.untruncated_drift, coarse.energy), split(momentum.linear, coarse.linear),
                     split(momentum.angular, coarse.angular)};
  const auto unclear = [&](const std::optional<DriftShare>& d) {
    return !d || (d->integration > rest_of_its_own * d->model && d->model > 0);
  };
  if (evidence.estimate->off > another_drift &&
      (unclear(shares.energy) || unclear(shares.linear) || unclear(shares.angular)))
    return {};
  // Of its own energy, which it conserves; without truncation that drifts by what the model leaves out.
  if (prepared.scene.formulation->terms().truncation == Truncation::symmetric)
    shares.energy = DriftShare{std::min(coarse.energy, s.untruncated_drift), s.energy_drift};
  return shares;
}

}  // namespace

std::vector<BodyFamilies> families_of(const Scene& scene) {
  std::vector<BodyFamilies> all;
  std::set<std::string> chosen;
  for (const BodyModes& body : scene.modes) {
    chosen.insert(body.body);
    for (const ModeCount& count : body.counts)
      if (count.modes > 0) all.push_back({body.body, count.strain, count.family_id(), count.modes});
  }
  for (const BodyNode& body : scene.model->bodies()) {
    const auto modes = static_cast<std::size_t>(body.body->shape().modes());
    if (modes > 0 && !body.segment && chosen.count(body.name) == 0) all.push_back({body.name, "", "", modes});
  }
  return all;
}

Certificate certify(const Prepared& prepared, Evidence evidence, Registry& registry) {
  const Scene& scene = prepared.scene;
  const RunSummary& summary = *evidence.summary;
  Certificate c;
  c.formulation = scene.formulation_name;
  c.meaning = formulation_words_of(scene, registry).meaning;
  c.own = own_formulations(scene, registry);
  const Rung* last = nullptr;  // what a run that changes its formulation ended in
  if (evidence.plan) {
    add_plan(c, prepared, std::move(*evidence.plan), summary.reached);
    last = &prepared.rungs[c.plan->stretches.back().stretch.rung];
  }
  c.compiled = (last != nullptr ? *last->equations : *prepared.equations).savings();
  c.energy_drift = summary.energy_drift;
  c.untruncated_drift = summary.untruncated_drift;
  c.momentum = summary.momentum;
  c.shares = shares_of(prepared, evidence);
  c.dropped = std::move(evidence.dropped);
  c.families = families_of(scene);
  const EquationsOfMotion& equations = last != nullptr ? *last->equations : *prepared.equations;
  c.samples = summary.validity.samples;
  c.bodies = summary.validity.bodies;
  for (BodyValidity& b : c.bodies)
    if (needs_no_modes(scene, b, summary)) b.highest.clear();
  if (evidence.beyond != nullptr) c.against = evidence.beyond->formulation;
  c.neglected = summary.validity.neglected;
  c.estimate = std::move(evidence.estimate);
  c.without_estimate = std::move(evidence.without_estimate);
  c.more_modes = std::move(evidence.more_modes);
  c.steps = step_limit(prepared, summary, registry);
  c.indicators = indicators(scene, summary, last != nullptr ? std::optional(last->terms) : std::nullopt);
  if (const auto vibrates = vibrations_followed(scene, equations, summary)) add(c, *vibrates);
  c.rounding = add_rounding(c.indicators, prepared.model(), equations, summary.final);
  add_neglected(c, scene, last != nullptr ? last->terms : scene.formulation->terms());
  add_common_velocity(c, part_of_common_velocity(prepared, evidence.beyond, summary));
  return c;
}

std::size_t greatest_share(const LoadRatio& load) {
  std::size_t most = 0;
  for (std::size_t k = 1; k < motion_terms; ++k)
    if (std::abs(load.shares[k]) > std::abs(load.shares[most])) most = k;
  return most;
}

}  // namespace withy::study
