#include "withy/study/advice_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/scene/scene.hpp"

namespace withy::study {
namespace {

namespace policy {
/// Times the best cost so far: what is timed again before one is chosen.
constexpr double nearly_as_cheap = 1.5;
/// Of the time that is left: what a run may cost that is made before models are looked at.
constexpr double little = 0.1;
/// Runs that last longer [s] are timed once, shorter ones twice.
constexpr double long_run = 0.2;
}  // namespace policy

constexpr double infinite = std::numeric_limits<double>::infinity();

/// The cheapest probe that passed; null where none did.
const Probe* cheapest(const Evaluator& evaluator, const std::vector<Probe>& probes) {
  const Probe* best = nullptr;
  for (const Probe& p : probes)
    if (p.passed() && (best == nullptr || evaluator.cost(p) < evaluator.cost(*best))) best = &p;
  return best;
}

}  // namespace

std::vector<Point> Search::models_by_cost(const std::vector<int>& all_modes) const {
  std::vector<std::pair<double, Point>> order;
  for (const std::string& formulation : candidates_.formulations)
    for (const std::string& family : candidates_.families)
      for (const int modes : all_modes) {
        const Point point{formulation, family, modes, "", 0, {}, {}};
        // To make a model may take long, as where its motions are looked for.
        if (over()) {
          order.emplace_back(infinite, point);
          continue;
        }
        const ModelAt& m = evaluator_.model(point);
        // Explicit steps are as many as the fastest mode makes them.
        order.emplace_back(m.seconds * std::max(m.fastest, 1.0), m.point);
      }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Point> models;
  for (auto& [cost, model] : order) models.push_back(std::move(model));
  return models;
}

bool Search::over() const {
  return stopped() || evaluator_.out_of_time() || !(within_time({}, best_cost()).seconds > 0);
}

double Search::best_cost() const {
  const Probe* best = cheapest(evaluator_, advice_.probes);
  return best != nullptr ? evaluator_.cost(*best) : infinite;
}

/// What is new in a probe: a cheaper model that holds, or the first of a formulation that does not.
void Search::tell_probe(const Probe& probe, double best_before) {
  if (!finding_) return;
  const double cost = evaluator_.cost(probe);
  if (probe.passed() && cost < best_before) {
    const bool again = probe.point.key() == std::exchange(told_best_, probe.point.key());
    if (again) return;  // its cost alone is known better
    finding_(fmt::format("so far: {} holds the accuracy with {:.2g} of it, {:.2g} s a run", probe.point.text(),
                         probe.use, cost));
  } else if (probe.outcome == Probe::Outcome::inaccurate && told_.insert(probe.point.formulation).second) {
    finding_(fmt::format("{} does not hold: off by {:.2g} times the accuracy asked in {}{}", probe.point.text(),
                         probe.use, evaluator_.outputs().list()[yardstick().worst(probe.distances)].label,
                         probe.walk.end == Walk::End::reached ? "" : ", and the run is not over"));
  }
}

/// An allowance within what is left when the run of the cheapest so far, as a scene that says so is, is taken off.
Allowance Search::within_time(Allowance allowance, double best) const {
  if (best < infinite)
    allowance.seconds = std::min(allowance.seconds, advice_.limit_seconds - best - evaluator_.spent());
  return allowance;
}

const Probe& Search::run(const Point& point, const Allowance& allowance) {
  const double best_before = best_cost();
  const auto made =
      std::find_if(made_.begin(), made_.end(), [&](const Reference* run) { return run->point.key() == point.key(); });
  advice_.probes.push_back(made != made_.end()
                               ? evaluator_.judge(**made, yardstick())
                               : evaluator_.run(point, yardstick(), within_time(allowance, best_before)));
  advice_.interrupted = advice_.interrupted || advice_.probes.back().outcome == Probe::Outcome::interrupted;
  tell_probe(advice_.probes.back(), best_before);
  return advice_.probes.back();
}

bool Search::is_candidate(const Point& p) const {
  const Candidates& c = candidates_;
  return contains(c.formulations, p.formulation) && contains(c.families, p.family) &&
         (contains(c.modes, p.modes) || contains(c.more_modes, p.modes) || contains(c.most_modes, p.modes)) &&
         contains(c.integrators, p.integrator) && contains(c.tolerances, p.tolerance);
}

void Search::take(const std::vector<Reference>& runs) {
  for (const Reference& run : runs) {
    made_.push_back(&run);
    if (!is_candidate(run.point) || run.point.modes > yardstick().reference.point.modes) continue;
    Probe probe = evaluator_.judge(run, yardstick());
    if (!probe.passed()) continue;
    const double best_before = best_cost();
    advice_.probes.push_back(std::move(probe));
    tell_probe(advice_.probes.back(), best_before);
  }
}

/// Whether a model with so many modes holds the accuracy.
bool Search::passed(const std::vector<int>& modes) const {
  return std::any_of(advice_.probes.begin(), advice_.probes.end(),
                     [&](const Probe& p) { return p.passed() && contains(modes, p.point.modes); });
}

/// What runs of the reference have shown to hold may do so at looser tolerances: there may be no time for it later.
/// What costs much of the time that is left is left to the search for cheaper models.
void Search::loosen_taken() {
  std::vector<Probe> held;
  for (const Probe& p : advice_.probes)
    if (p.passed()) held.push_back(p);
  const auto cheaper = [&](const Probe& a, const Probe& b) { return evaluator_.cost(a) < evaluator_.cost(b); };
  std::stable_sort(held.begin(), held.end(), cheaper);
  for (const Probe& p : held) {
    const double left = advice_.limit_seconds - evaluator_.spent();
    if (over() || evaluator_.cost(p) > policy::little * left) return;
    Point model = p.point;
    model.integrator.clear(), model.tolerance = 0;
    try_integrations(model, p.point.integrator);
  }
}

/// Candidates that hold the accuracy themselves, but not with what the reference may be off by, and would cost clearly
/// less than the best.
std::vector<std::size_t> Search::near_misses() const {
  const double best = best_cost();
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < advice_.probes.size(); ++i) {
    const Probe& p = advice_.probes[i];
    if (p.outcome == Probe::Outcome::inaccurate && p.walk.end == Walk::End::reached && p.use < 1 &&
        is_candidate(p.point) && policy::nearly_as_cheap * evaluator_.cost(p) < best)
      near.push_back(i);
  }
  return near;
}

std::optional<double> Search::own_wanted() const {
  constexpr double part = 0.5;  // of what such a candidate leaves: a reference that is known better moves too
  std::optional<double> wanted;
  for (const std::size_t i : near_misses()) wanted = std::max(wanted.value_or(0), part * (1 - advice_.probes[i].use));
  return wanted;
}

void Search::judge_again() {
  std::vector<std::size_t> all = near_misses();
  for (std::size_t i = 0; i < advice_.probes.size(); ++i)
    if (advice_.probes[i].passed()) all.push_back(i);
  for (const std::size_t i : all) {
    if (stopped()) return;
    Probe& p = advice_.probes[i];
    const double best_before = best_cost();
    Probe again = evaluator_.run(p.point, yardstick(), within_time({}, 0));
    if (again.walk.end != Walk::End::reached) continue;
    p = std::move(again);
    tell_probe(p, best_before);
  }
}

void Search::try_models() {
  loosen_taken();
  // Runs of the reference may hold with more modes than were tried so far: there may be cheaper ones.
  try_models(candidates_.modes);
  if (over() || passed(candidates_.modes)) return;
  // All at once: many modes of a formulation that costs little come before few of one that costs much.
  try_known(candidates_.more_modes);
  if (over() || passed(candidates_.more_modes)) return;
  if (best_cost() == infinite) try_tightest();
  if (over() || passed(candidates_.modes)) return;
  try_known(candidates_.most_modes);
}

/// Where motions that begin alike part, as those of a chain that swings freely, an integration adds more than a look at
/// the model allows for.
void Search::try_tightest() {
  tightest_ = true;
  advice_.models = advice_.models_tried = 0;  // counted anew: they are the same
  try_models(candidates_.modes);
  tightest_ = false;
}

/// Those of these modes that the reference has: more would be measured against less.
void Search::try_known(const std::vector<int>& modes) {
  std::vector<int> known;
  for (const int n : modes)
    if (n <= yardstick().reference.point.modes) known.push_back(n);
  if (!known.empty()) try_models(known);
}

void Search::try_models(const std::vector<int>& modes) {
  const std::vector<Point> models = models_by_cost(modes);
  advice_.models += models.size();
  for (const Point& model : models) {
    if (over()) return;
    try_model(model);
    ++advice_.models_tried;
  }
}

/// Another whole run, from which the cost of an evaluation may be seen to be less.
void Search::time_again(const Probe& probe) {
  for (int i = 0; i < 2 && !over(); ++i)
    if (evaluator_.run(probe.point, yardstick()).walk.seconds > policy::long_run) return;
}

/// The cheapest that passed; those that are nearly as cheap are timed again first, since time is noisy.
void Search::choose() {
  advice_.choice.reset();
  const double best = best_cost();
  std::vector<Probe> near;
  for (const Probe& p : advice_.probes)
    if (p.passed() && evaluator_.cost(p) <= policy::nearly_as_cheap * best) near.push_back(p);
  for (const Probe& p : near) time_again(p);
  if (const Probe* p = cheapest(evaluator_, advice_.probes)) advice_.choice = *p;
}

/// Flexible bodies that need less than the rest: one after the other, the choice with that one in the lowest
/// rung too.
void Search::simplify_bodies() {
  std::optional<Probe>& choice = advice_.choice;
  const std::string least = formulation_rungs(evaluator_.registry()).front().id;
  if (!choice || choice->point.formulation == least || !contains(candidates_.formulations, least)) return;
  const std::vector<std::string> bodies = flexible_bodies(evaluator_.base().scene);
  if (bodies.size() < 2) return;  // all of them were tried
  for (const std::string& body : bodies) {
    if (over() || choice->point.bodies.size() + 1 == bodies.size()) return;
    Point point = choice->point;
    point.bodies.emplace_back(body, least);
    if (evaluator_.model(point).refused()) continue;
    const Probe mixed = run(point, {1, model_allowance * evaluator_.cost(*choice)});
    if (!mixed.passed()) continue;
    if (evaluator_.cost(mixed) >= evaluator_.cost(*choice)) time_again(mixed);
    if (evaluator_.cost(mixed) < evaluator_.cost(*choice)) choice = mixed;
  }
}

/// Measures a model above the choice by a whole run; what does not hold the accuracy is nothing to go up to.
bool Search::hold(const Point& above) {
  Probe p = evaluator_.run(above, yardstick());
  if (p.passed()) advice_.above.push_back(p);
  return p.passed();
}

/// The next formulation and the next number of modes above the choice that hold the accuracy.
void Search::look_up() {
  if (!flexible(evaluator_.base().model())) return;
  Point up = advice_.choice->point;
  if (!up.bodies.empty()) {
    up.bodies.clear();
    if (over() || hold(up)) up.formulation.clear();
  }
  while (!up.formulation.empty() && !over()) {
    const std::optional<std::string> above = next_rung(evaluator_.registry(), up.formulation);
    if (!above) break;
    up.formulation = *above;
    if (hold(up)) break;
  }
  constexpr int most_more = 2;
  Point more = advice_.choice->point;
  for (int i = 0; i < most_more && more.modes > 0 && !over(); ++i) {
    ++more.modes;
    if (hold(more)) break;
  }
}

}  // namespace withy::study
