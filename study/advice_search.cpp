#include "withy/study/advice_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/scene/scene.hpp"

namespace withy::study {
namespace {

/// The numbers of the search. Costs are CPU times, which other work on the machine makes longer by some tens of per
/// cent: what is within such a margin is not told apart by one run.
namespace policy {
/// Of the accuracy: an error beyond this in an integration that is much more exact is the model's.
constexpr double clearly_inaccurate = 1.5;
/// The same of one that came to the end, the reference's own error on top: no other integration makes up for that.
constexpr double hardly_inaccurate = 1.05;
/// Of the accuracy: the tolerance at which an integration adds next to nothing.
constexpr double exact_enough = 1e-2;
/// Times the best cost so far: what finding out about a model may cost, since a looser integration of it may cost less.
constexpr double model_allowance = 4;
/// The same for a candidate: beyond it is costlier for sure.
constexpr double candidate_allowance = 1.25;
/// The same for what is timed again before one is chosen.
constexpr double nearly_as_cheap = 1.5;
/// Evaluations of `dop853` at its stability limit beyond which a model is looked at with implicit steps, and the
/// tolerance of these over the accuracy: they are a tenth as many there.
constexpr double many_evaluations = 5000, implicit_enough = 0.1;
/// Times those: what is fewer was limited by stability.
constexpr double as_stability_asks = 2;
/// Of the time that is left: what a run may cost that is made before models are looked at.
constexpr double little = 0.1;
/// Runs that last longer [s] are timed once, shorter ones twice.
constexpr double long_run = 0.2;
}  // namespace policy

/// Linearly implicit: a step costs little more than an explicit one.
constexpr const char* implicit_steps = "imex";
/// Those whose evaluations at the stability limit are known.
constexpr const char* explicit_steps = "dop853";

constexpr double infinite = std::numeric_limits<double>::infinity();

template <class T>
bool contains(const std::vector<T>& all, const T& value) {
  return std::find(all.begin(), all.end(), value) != all.end();
}

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

/// That part of the accuracy asked for, or the next candidate below it.
double Search::exact_enough_tolerance(double part) const {
  if (tightest_) return candidates_.tolerances.back();
  double share = policy::exact_enough;
  const Reference& r = yardstick().reference;
  for (std::size_t i = 0; i < r.scales.size(); ++i)
    if (r.scales[i] > 0) share = std::min(share, yardstick().limits[i] / r.scales[i]);
  const double wanted = part * share * (1 + 1e-9);
  for (const double t : candidates_.tolerances)
    if (t <= wanted) return t;
  return std::max(wanted, 1e-8);
}

/// Whether explicit steps would be many for stability alone.
bool Search::limited_by_stability(const Point& model) const {
  if (!contains<std::string>(candidates_.integrators, implicit_steps)) return false;
  return explicit_evaluations(evaluator_.model(model)) > policy::many_evaluations;
}

/// Whether the model itself may be good enough: an integration that adds next to nothing tells, cut when it is clear.
bool Search::model_holds(const Point& model) {
  const auto look = [&](const std::string& integrator, double part) -> Probe& {
    Point point = model;
    point.integrator = integrator;
    point.tolerance = exact_enough_tolerance(part);
    run(point, {policy::clearly_inaccurate, policy::model_allowance * best_cost()});
    Probe& p = advice_.probes.back();
    const bool candidate =
        contains(candidates_.integrators, point.integrator) && contains(candidates_.tolerances, point.tolerance);
    if (!candidate && p.passed()) p.outcome = Probe::Outcome::no_candidate;
    return p;
  };
  const auto wrong = [&](const Probe& p) {
    return p.outcome == Probe::Outcome::inaccurate && p.use > policy::clearly_inaccurate;
  };
  // By how much a run that came to its end is off by more than another integration makes up for.
  const auto beyond = [&](const Probe& p) {
    return p.outcome == Probe::Outcome::inaccurate ? yardstick().use_with_own(p.distances) - policy::hardly_inaccurate
                                                   : 0;
  };
  if (limited_by_stability(model)) {
    // Where equations are stiff beyond what `imex` folds in, levels of the reference have shown it.
    const std::string& levels = yardstick().reference.point.integrator;
    const std::string implicit = levels == explicit_steps ? implicit_steps : levels;
    const Probe& p = look(implicit, policy::implicit_enough);
    // A run that the reference had made has not been cut.
    if (wrong(p)) return false;
    if (p.outcome != Probe::Outcome::refused && p.walk.end != Walk::End::reached) return true;
    // Not as exact as the other: what a digit less of tolerance changes is what integration may have added.
    const double use = p.use, too_much = beyond(p);
    if (too_much > 0) return std::abs(look(implicit, 10 * policy::implicit_enough).use - use) > too_much;
    if (p.outcome != Probe::Outcome::refused) return true;
  }
  const Probe& p = look(explicit_steps, policy::exact_enough);
  return p.walk.end == Walk::End::reached ? !(beyond(p) > 0) : !wrong(p);
}

void Search::try_model(const Point& model) {
  if (evaluator_.model(model).refused()) {
    run(model, {});
    return;
  }
  // A run that holds the accuracy has told, and an integration that is more exact may be further off: implicit steps
  // damp what a model has too much of.
  const bool held = std::any_of(advice_.probes.begin(), advice_.probes.end(),
                                [&](const Probe& p) { return p.passed() && p.point.same_model(model); });
  if (!held && !model_holds(model)) return;
  for (const std::string& integrator : candidates_.integrators) {
    if (over()) return;
    if (worth_trying(integrator, model)) try_integrations(model, integrator);
  }
}

/// Implicit steps pay where stability, not accuracy, limits explicit ones: there the loosest tolerance is exact enough
/// already, or costs too much, or a tighter one takes hardly more evaluations than stability asks. `imex` costs little
/// more than an explicit step and is always tried.
bool Search::worth_trying(const std::string& integrator, const Point& model) const {
  const auto limit =
      make_integrator(evaluator_.registry(), integrator, candidates_.tolerances.front())->stability_limit();
  if (integrator == implicit_steps || (limit && std::isfinite(*limit))) return true;
  bool tried = false;
  const double stable = policy::as_stability_asks * explicit_evaluations(evaluator_.model(model));
  for (const Probe& p : advice_.probes) {
    if (!p.point.same_model(model)) continue;
    if (p.passed() && p.point.integrator == explicit_steps && static_cast<double>(p.walk.evaluations) < stable)
      return true;
    if (p.point.tolerance != candidates_.tolerances.front()) continue;
    if (p.passed() || p.outcome == Probe::Outcome::too_costly) return true;
    tried = true;
  }
  return !tried;
}

/// From the loosest tolerance on, until one passes or costs more than the best so far.
void Search::try_integrations(const Point& model, const std::string& integrator) {
  Point tried = model;
  tried.integrator = integrator;
  if (!tried_.insert(tried.key()).second) return;
  const double known = exact_enough_tolerance(policy::exact_enough);
  for (const double tolerance : candidates_.tolerances) {
    if (over()) return;
    if (integrator == explicit_steps && tolerance <= known && contains(candidates_.tolerances, known)) return;
    Point point = model;
    point.integrator = integrator;
    point.tolerance = tolerance;
    const Probe& p = run(point, {1, policy::candidate_allowance * best_cost()});
    // Tighter ones cost more.
    if (p.passed() || p.outcome == Probe::Outcome::too_costly || p.outcome == Probe::Outcome::refused) return;
  }
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
    const Probe mixed = run(point, {1, policy::model_allowance * evaluator_.cost(*choice)});
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
