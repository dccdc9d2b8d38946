#include "withy/study/advice_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/core/plugin/formulation_ladder.hpp"

namespace withy::study {
namespace {

/// The numbers of the search. Costs are CPU times, which other work on the machine makes longer by some tens of per
/// cent: what is within such a margin is not told apart by one run.
namespace policy {
/// Of the accuracy: what a reference's own error may be, so that three quarters are left to what is chosen.
constexpr double most_reference_use = 0.25;
/// The same of a reference that has fewer modes than the richest candidate: what its next mode changes is then known.
constexpr double most_poor_reference_use = 0.25 * most_reference_use;
/// Of the accuracy: an error beyond this in an integration that is much more exact is the model's.
constexpr double clearly_inaccurate = 1.5;
/// Of the accuracy: the tolerance at which an integration adds next to nothing.
constexpr double exact_enough = 1e-2;
/// Times the best cost so far: what finding out about a model may cost, since a looser integration of it may cost less.
constexpr double model_allowance = 4;
/// The same for a candidate: beyond it is costlier for sure.
constexpr double candidate_allowance = 1.25;
/// The same for what is timed again before one is chosen.
constexpr double nearly_as_cheap = 1.3;
/// Runs that last longer [s] are timed once, shorter ones twice.
constexpr double long_run = 0.2;
/// Levels of a reference, and its tightest tolerance.
constexpr int reference_levels = 5;
constexpr double tightest = 1e-9;
}  // namespace policy

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

void Search::find_yardstick() {
  const bool modal = candidates_.modes.back() > 0;
  ReferenceGoal goal;
  goal.first = {"",
                reference_family(candidates_),
                modal ? 2 : 0,
                "dop853",
                std::clamp(1e-3 * accuracy_.share.value_or(1e-3), 1e-8, 1e-5),
                {},
                {}};
  goal.levels = policy::reference_levels;
  goal.tightest = policy::tightest;
  goal.enough = [&](const Reference& r) {
    const double use = Yardstick{r, accuracy_.limits(evaluator_.outputs(), r.ways)}.own_use();
    // Candidates are not to have more modes than the truth.
    const bool rich = !modal || r.point.modes >= candidates_.modes.back() || use < policy::most_poor_reference_use;
    return use <= policy::most_reference_use && rich;
  };
  const ReferenceFound found = find_reference([&](const Point& p) -> const ModelAt& { return evaluator_.model(p); },
                                              evaluator_.registry(), evaluator_.outputs(), goal, evaluator_.control());
  evaluator_.spend(found.cpu_seconds);
  advice_.interrupted = found.interrupted;
  if (found.reference)
    advice_.yardstick = Yardstick{*found.reference, accuracy_.limits(evaluator_.outputs(), found.reference->ways)};
  else
    explain(found);
}

void Search::explain(const ReferenceFound& found) {
  if (!found.trouble.empty()) {
    advice_.trouble = "no reference to measure against: " + found.trouble;
  } else if (found.nearest) {
    const Reference& r = *found.nearest;
    const double use = Yardstick{r, accuracy_.limits(evaluator_.outputs(), r.ways)}.own_use();
    advice_.trouble = fmt::format(
        "no reference is exact enough: two runs that differ by a mode and a digit, the finer {}, are still {:.2g} of "
        "the accuracy apart. Ask for {:.2g} times that accuracy, a shorter time (--set time.end=…) or fewer outputs",
        r.point.text(), use, std::ceil(10 * use / policy::most_reference_use) / 10);
  }
}

std::vector<Point> Search::models_by_cost() const {
  std::vector<std::pair<double, Point>> order;
  for (const std::string& formulation : candidates_.formulations)
    for (const std::string& family : candidates_.families)
      for (const int modes : candidates_.modes) {
        const ModelAt& m = evaluator_.model({formulation, family, modes, "", 0, {}, {}});
        // Explicit steps are as many as the fastest mode makes them.
        order.emplace_back(m.seconds * std::max(m.fastest, 1.0), m.point);
      }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Point> models;
  for (auto& [cost, model] : order) models.push_back(std::move(model));
  return models;
}

double Search::best_cost() const {
  const Probe* best = cheapest(evaluator_, advice_.probes);
  return best != nullptr ? evaluator_.cost(*best) : infinite;
}

const Probe& Search::run(const Point& point, const Allowance& allowance) {
  advice_.probes.push_back(evaluator_.run(point, yardstick(), allowance));
  advice_.interrupted = advice_.interrupted || advice_.probes.back().outcome == Probe::Outcome::interrupted;
  return advice_.probes.back();
}

/// A hundredth of the accuracy asked for, or the next candidate below it.
double Search::exact_enough_tolerance() const {
  double share = policy::exact_enough;
  const Reference& r = yardstick().reference;
  for (std::size_t i = 0; i < r.ways.size(); ++i)
    if (r.ways[i] > 0) share = std::min(share, yardstick().limits[i] / r.ways[i]);
  const double wanted = policy::exact_enough * share * (1 + 1e-9);
  for (const double t : candidates_.tolerances)
    if (t <= wanted) return t;
  return std::max(wanted, 1e-8);
}

/// Whether the model itself may be good enough: an integration that adds next to nothing tells, cut when it is clear.
bool Search::model_holds(const Point& model) {
  Point point = model;
  point.integrator = "dop853";
  point.tolerance = exact_enough_tolerance();
  const bool candidate =
      contains(candidates_.integrators, point.integrator) && contains(candidates_.tolerances, point.tolerance);
  run(point, {policy::clearly_inaccurate, policy::model_allowance * best_cost()});
  Probe& p = advice_.probes.back();
  if (!candidate && p.passed()) p.outcome = Probe::Outcome::no_candidate;
  return !(p.outcome == Probe::Outcome::inaccurate && p.use > policy::clearly_inaccurate);
}

void Search::try_model(const Point& model) {
  if (evaluator_.model(model).refused()) {
    run(model, {});
    return;
  }
  if (!model_holds(model)) return;
  const double known = exact_enough_tolerance();
  for (const std::string& integrator : candidates_.integrators) {
    for (const double tolerance : candidates_.tolerances) {
      if (stopped()) return;
      if (integrator == "dop853" && tolerance <= known && contains(candidates_.tolerances, known)) break;
      Point point = model;
      point.integrator = integrator;
      point.tolerance = tolerance;
      const Probe& p = run(point, {1, policy::candidate_allowance * best_cost()});
      // Tighter ones cost more.
      if (p.passed() || p.outcome == Probe::Outcome::too_costly || p.outcome == Probe::Outcome::refused) break;
    }
  }
}

void Search::try_models() {
  for (const Point& model : models_by_cost()) {
    if (stopped()) return;
    try_model(model);
  }
}

/// Another whole run, from which the cost of an evaluation may be seen to be less.
void Search::time_again(const Probe& probe) {
  for (int i = 0; i < 2 && !stopped(); ++i)
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
    if (stopped() || choice->point.bodies.size() + 1 == bodies.size()) return;
    Point point = choice->point;
    point.bodies.emplace_back(body, least);
    if (evaluator_.model(point).refused()) continue;
    const Probe mixed = run(point, {1, policy::model_allowance * evaluator_.cost(*choice)});
    if (!mixed.passed()) continue;
    if (evaluator_.cost(mixed) >= evaluator_.cost(*choice)) time_again(mixed);
    if (evaluator_.cost(mixed) < evaluator_.cost(*choice)) choice = mixed;
  }
}

/// Measures what stands one step above the choice, by whole runs.
void Search::look_up() {
  if (!flexible(evaluator_.base().model())) return;
  const Point& choice = advice_.choice->point;
  std::vector<Point> points;
  const std::optional<std::string> above = next_rung(evaluator_.registry(), choice.formulation);
  if (!choice.bodies.empty() || above) {
    points.push_back(choice);
    if (choice.bodies.empty()) points.back().formulation = *above;
    points.back().bodies.clear();
  }
  if (choice.modes > 0) {
    points.push_back(choice);
    ++points.back().modes;
  }
  for (const Point& point : points) {
    if (stopped()) return;
    advice_.above.push_back(evaluator_.run(point, yardstick()));
  }
}

}  // namespace withy::study
