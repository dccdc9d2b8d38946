// Whether a model holds the accuracy, and with which integrations.
#include <algorithm>
#include <cmath>
#include <optional>

#include "withy/study/advice_search.hpp"

namespace withy::study {
namespace {

namespace policy {
/// Of the accuracy: an error beyond this in an integration that is much more exact is the model's.
constexpr double clearly_inaccurate = 1.5;
/// The same of one that came to the end, the reference's own error on top: no other integration makes up for that.
constexpr double hardly_inaccurate = 1.05;
/// Of the accuracy: the tolerance at which an integration adds next to nothing.
constexpr double exact_enough = 1e-2;
/// Times the best cost so far, for a candidate: beyond it is costlier for sure.
constexpr double candidate_allowance = 1.25;
/// Evaluations of `dop853` at its stability limit beyond which a model is looked at with implicit steps, and the
/// tolerance of these over the accuracy: they are a tenth as many there.
constexpr double many_evaluations = 5000, implicit_enough = 0.1;
/// Times those: what is fewer was limited by stability.
constexpr double as_stability_asks = 2;
}  // namespace policy

/// Linearly implicit: a step costs little more than an explicit one.
constexpr const char* implicit_steps = "imex";
/// Those whose evaluations at the stability limit are known.
constexpr const char* explicit_steps = "dop853";

}  // namespace

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
    run(point, {policy::clearly_inaccurate, model_allowance * best_cost()});
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
    if (worth_trying(integrator, model) && !try_integrations(model, integrator)) return;
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

/// From the loosest tolerance on, until one passes or costs more than the best so far. False where a digit less changed
/// the error of a run by less than what is missing: then the model is off, together with what the reference may be, and
/// no integration helps.
bool Search::try_integrations(const Point& model, const std::string& integrator) {
  Point tried = model;
  tried.integrator = integrator;
  if (!tried_.insert(tried.key()).second) return true;
  std::optional<double> before;  // of the run before, where it came to its end
  const double known = exact_enough_tolerance(policy::exact_enough);
  for (const double tolerance : candidates_.tolerances) {
    if (over()) return true;
    if (integrator == explicit_steps && tolerance <= known && contains(candidates_.tolerances, known)) return true;
    Point point = model;
    point.integrator = integrator;
    point.tolerance = tolerance;
    const Probe& p = run(point, {1, policy::candidate_allowance * best_cost()});
    // Tighter ones cost more.
    if (p.passed() || p.outcome == Probe::Outcome::too_costly || p.outcome == Probe::Outcome::refused) return true;
    if (p.walk.end != Walk::End::reached) continue;
    if (before && std::abs(p.use - *before) < yardstick().use_with_own(p.distances) - 1) return false;
    before = p.use;
  }
  return true;
}

}  // namespace withy::study
