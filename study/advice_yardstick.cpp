#include "withy/study/advice_yardstick.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "withy/scene/scene.hpp"
#include "withy/study/held_places.hpp"
#include "withy/study/pace.hpp"
#include "withy/study/third_order.hpp"
#include "withy/study/tip_moments.hpp"

namespace withy::study {
namespace {

/// The numbers of the search for a yardstick.
namespace policy {
/// Of the accuracy: what a reference's own error is to be, since nothing is chosen that needs this part of it.
constexpr double good_reference_use = 0.1;
/// The same where the search for a better one has taken this share of the time allowed.
constexpr double most_reference_use = 0.25, reference_patience = 0.1;
/// And where it has taken this share: what is left is better spent on models.
constexpr double late_reference_use = 0.5, last_patience = 0.35;
/// The same of a reference that has fewer modes than the richest candidate: what its next mode changes is then known.
constexpr double most_poor_reference_use = 0.25 * most_reference_use;
/// The same of the finest one there is where none of the levels is as good: less is left to what is chosen.
constexpr double last_reference_use = 0.7;
/// Also of one whose run took more than this share of the time that is left: a finer one takes what models need.
constexpr double dear_run = 0.25;
/// And where it is less than this of the finest, runs are held against it: one that is near it may hold the accuracy.
constexpr double any_reference_use = 1;
/// Of the time allowed: what the search for a reference may take; and where none is known well enough for any advice
/// by then, without which the rest would be for nothing.
constexpr double reference_time = 0.75, last_reference_time = 0.9;
/// Of the accuracy: what integration may add to each level, a fifth of what is aimed at; and the tolerance at which it
/// is measured.
constexpr double integration_use = 0.02, first_tolerance = 1e-2;
/// Levels of a reference, and the tightest tolerance.
constexpr int reference_levels = 14;
constexpr double tightest = 1e-9;
/// The same where tolerance is all that can be finer.
constexpr double finer_integration = 0.1, tightest_integration = 1e-12;
/// An accuracy beyond this share is nothing to propose.
constexpr double no_accuracy = 0.3;
/// Of the run: a time shorter than this is nothing to propose.
constexpr double worth_looking_at = 0.1;
}  // namespace policy

/// The search under way.
class YardstickSearch {
 public:
  YardstickSearch(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy, Advice& advice,
                  const Finding& finding)
      : evaluator_(evaluator), candidates_(candidates), accuracy_(accuracy), advice_(advice), finding_(finding) {}

  std::vector<Reference> find();
  bool refine(double own, const std::vector<Reference>& runs);

 private:
  [[nodiscard]] ReferenceGoal goal();
  [[nodiscard]] ReferenceFound search(const ReferenceGoal& goal);
  void explain(const ReferenceFound& found);
  void explain_bending(const Reference& r);
  void tell(const Reference& r);
  [[nodiscard]] double left() const;
  [[nodiscard]] bool affordable(const Walk& so_far, double whole);
  [[nodiscard]] Yardstick of(const Reference& r) const { return {r, accuracy_.limits(evaluator_.outputs(), r.scales)}; }
  [[nodiscard]] double own_use(const Reference& r) const { return of(r).own_use(); }

  Evaluator& evaluator_;
  const Candidates& candidates_;
  const Accuracy& accuracy_;
  Advice& advice_;
  const Finding& finding_;
  Pace pace_;                                                      ///< of the reference's run under way
  double least_use_ = std::numeric_limits<double>::infinity();     ///< of the accuracy: of the best reference so far
  double most_seconds_ = std::numeric_limits<double>::infinity();  ///< of CPU time, that all may have taken by the end
  double told_ = std::numeric_limits<double>::infinity();          ///< of the accuracy: the least told so far
};

/// What any search for a reference is told but for when it ends.
ReferenceGoal YardstickSearch::goal() {
  const bool modal = candidates_.modes.back() > 0;
  ReferenceGoal goal;
  ReferenceFamilies families = reference_families(candidates_, evaluator_.base());
  goal.families = std::move(families.others);
  goal.first = {"",
                std::move(families.first),
                modal ? 2 : 0,
                "dop853",
                std::clamp(policy::first_tolerance * accuracy_.share.value_or(1e-3), 1e-8, 1e-4),
                {},
                {}};
  goal.levels = policy::reference_levels;
  goal.kinds = kinds_of_modes(evaluator_.base().scene);
  goal.leaps = true;
  goal.finer = modal ? 1 : policy::finer_integration;
  goal.tightest = modal ? policy::tightest : policy::tightest_integration;
  goal.integration = [&](const Reference& r) { return own_use(r) / policy::integration_use; };
  goal.steady = [&](const Reference& r) { return own_use(r) <= policy::most_reference_use; };
  goal.left = [&] { return left(); };
  goal.afford = [&](const Walk& so_far, double whole) { return affordable(so_far, whole); };
  goal.ended = [&](const Walk& run) {
    pace_.note(run.time - evaluator_.base().scene.initial.time, run.seconds);
    pace_.end();
  };
  return goal;
}

ReferenceFound YardstickSearch::search(const ReferenceGoal& goal) {
  return find_reference([&](const Point& p) -> const ModelAt& { return evaluator_.model(p); }, evaluator_.registry(),
                        evaluator_.outputs(), goal, evaluator_.control());
}

std::vector<Reference> YardstickSearch::find() {
  ReferenceGoal goal = this->goal();
  const bool modal = candidates_.modes.back() > 0;
  const auto better_is_offered = [&](Point point) {
    for (const std::string& formulation : reference_formulations(evaluator_.registry())) {
      if (formulation == point.formulation) return false;
      Point richer = point;
      richer.formulation = formulation;
      if (!evaluator_.model(richer).refused()) return true;
    }
    return false;
  };
  const auto bent_too_far = [&](const Reference& r) {
    return !better_is_offered(r.point) &&
           r.third_order > policy::last_reference_use * accuracy_.share.value_or(policy::no_accuracy);
  };
  goal.enough = [&](const Reference& r) {
    if (bent_too_far(r)) return true;  // more modes would not help
    const double use = own_use(r);
    least_use_ = std::min(least_use_, use);
    tell(r);
    // Candidates are not to have more modes than the truth.
    const bool rich = !modal || r.point.modes >= candidates_.modes.back() || use < policy::most_poor_reference_use;
    const double gone = evaluator_.spent() / evaluator_.limit();
    const bool last = gone > policy::reference_time || r.walk.seconds > policy::dear_run * left();
    return use <= (last                                ? policy::last_reference_use
                   : gone > policy::last_patience      ? policy::late_reference_use
                   : gone > policy::reference_patience ? policy::most_reference_use
                                                       : policy::good_reference_use) &&
           rich;
  };
  ReferenceFound found = search(goal);
  advice_.interrupted = found.interrupted;
  if (found.reference && bent_too_far(*found.reference)) {
    explain_bending(*found.reference);
    return std::move(found.runs);
  }
  const double nearest_use = found.nearest ? own_use(*found.nearest) : std::numeric_limits<double>::infinity();
  if (!found.reference && nearest_use > policy::last_reference_use) explain(found);
  if (!found.reference && nearest_use < policy::any_reference_use) found.reference = std::move(found.nearest);
  if (found.reference) advice_.yardstick = of(*found.reference);
  return std::move(found.runs);
}

bool YardstickSearch::refine(double own, const std::vector<Reference>& runs) {
  most_seconds_ = 2 * evaluator_.spent();
  least_use_ = told_ = advice_.yardstick->own_use();
  ReferenceGoal goal = this->goal();
  goal.made = runs;
  goal.enough = [&](const Reference& r) {
    tell(r);
    return own_use(r) <= own;
  };
  ReferenceFound found = search(goal);
  advice_.interrupted = found.interrupted;
  if (!found.reference) found.reference = std::move(found.nearest);
  if (!found.reference || !(own_use(*found.reference) < advice_.yardstick->own_use())) return false;
  advice_.yardstick = of(*found.reference);
  return true;
}

/// What the reference's runs may still take of their share of the time [s].
double YardstickSearch::left() const {
  const bool none_yet = least_use_ > policy::last_reference_use;
  const double share = none_yet ? policy::last_reference_time : policy::reference_time;
  return std::min(share * evaluator_.limit(), most_seconds_) - evaluator_.spent();
}

/// Whether the reference's runs, this one gone on with at its pace or at what it is expected to cost, keep within their
/// share of the time.
bool YardstickSearch::affordable(const Walk& so_far, double whole) {
  const Scene& scene = evaluator_.base().scene;
  evaluator_.control().tell(evaluator_.spent(), evaluator_.limit());
  pace_.note(so_far.time - scene.initial.time, so_far.seconds);
  double rest = pace_.rest(evaluator_.end() - scene.initial.time);
  if (so_far.seconds < whole) rest = std::min(rest, whole - so_far.seconds);
  return may_go_on(so_far.seconds, rest, left() + so_far.seconds);
}

/// Why no reference will do, and what may be asked instead.
void YardstickSearch::explain(const ReferenceFound& found) {
  advice_.nearest = found.nearest;
  if (!found.nearest) {
    advice_.trouble = "no reference to measure against";
    if (!found.trouble.empty()) advice_.trouble += ": " + found.trouble;
    if (found.unaffordable) advice_.trouble += ". What to do: " + more_time_text(advice_);
    return;
  }
  const Reference& r = *found.nearest;
  const Yardstick yardstick = of(r);
  const double use = yardstick.own_use(), times = use / policy::last_reference_use;
  const bool askable = times * accuracy_.share.value_or(0) < policy::no_accuracy;
  const Scene& scene = evaluator_.base().scene;
  // Ranges are less up to there, and limits with them.
  Distances closely = yardstick.limits;
  for (double& limit : closely) limit *= policy::most_reference_use;
  const double agree = agree_until(evaluator_.outputs(), r.readings, r.coarser, closely);
  const bool long_enough =
      agree - scene.initial.time > policy::worth_looking_at * (evaluator_.end() - scene.initial.time);
  const std::string& worst = evaluator_.outputs().list()[yardstick.worst(r.own)].label;
  const char* const there_was_time = found.unaffordable ? " that there was time for" : "";
  const std::string known =
      r.point.modes > 0
          ? fmt::format("the finest{} ({}) is known to {:.2g} times what is asked, least well in {}", there_was_time,
                        r.text(), use, worst)
          : fmt::format(
                "the two finest runs{} (the finer one {}; the other has a digit of tolerance less) differ by "
                "{:.2g} times what is asked, most in {}",
                there_was_time, r.text(), use, worst);
  advice_.trouble = fmt::format(
      "no reference is exact enough to measure against: {}. What to do: {}ask {}for a shorter time (--set "
      "time.end={}), "
      "or for other outputs (--output)",
      known, found.unaffordable ? more_time_text(advice_) + "; or " : "",
      askable ? fmt::format("for --accuracy {}, which this one is good for, ", accuracy_.times(times).option()) : "",
      long_enough ? fmt::format("{:.3g}, up to which they agree", agree) : "...");
  if (!found.trouble.empty())
    advice_.trouble +=
        (found.unaffordable ? ". A finer one costs too much: " : ". There is no finer one: ") + found.trouble;
  // With functions that cannot bend as the body is held the models converge like 1/n.
  std::vector<Remark> remarks;
  look_at_held_places(evaluator_.base(), evaluator_.registry(), remarks);
  look_at_tip_moments(evaluator_.base(), evaluator_.registry(), remarks);
  for (const Remark& remark : remarks) advice_.trouble += fmt::format(". {}: {}", remark.place.path, remark.text);
}

/// What would give a body the kinematics that it lacks where it bends too far.
std::string for_exact_kinematics(const Model& model, const std::string& bent) {
  const auto& bodies = model.bodies();
  const auto node = std::find_if(bodies.begin(), bodies.end(), [&](const BodyNode& b) {
    return b.name == bent || (b.segment && b.segment->whole == bent);
  });
  const std::string lacking = without_exact_kinematics(model);
  const char* const parts = node != bodies.end() && node->segment ? "one in more segments" : "one in segments";
  if (node != bodies.end() && node->body->rod() != nullptr && !lacking.empty())
    return fmt::format(
        "for {0} that is better; '{1}' has 'exact', but references have one kinematics for all bodies. What to do: "
        "make '{1}' {2}, or what lacks 'exact' a beam or rigid",
        lacking, bent, parts);
  if (node == bodies.end() || !node->body->cut(0))
    return fmt::format("that is better. What to do: make '{}' a beam, which has 'exact' and may be one in segments",
                       bent);
  return fmt::format(
      "that is better. What to do: give '{}', whose modes move its root, a family that does not, as "
      "orthogonal-polynomials, with which a beam has 'exact', or make it {}",
      bent, parts);
}

/// Why what is offered is no truth for a body that bends so far.
void YardstickSearch::explain_bending(const Reference& r) {
  const double use = r.third_order / accuracy_.share.value_or(policy::no_accuracy) / policy::last_reference_use;
  const bool askable = use * accuracy_.share.value_or(0) < policy::no_accuracy;
  advice_.trouble = fmt::format(
      "no reference is exact enough to measure against: {} ('{}') are beyond what {} is "
      "good for: over a run that may come to {:.2g} % of the range of deflections, and no kinematics is offered {}{}; "
      "or ask for a shorter time (--set time.end=...)",
      bend_text(r.bend), r.bent, r.point.formulation, 100 * r.third_order,
      for_exact_kinematics(evaluator_.base().model(), r.bent),
      accuracy_.share && askable
          ? fmt::format("; or ask for --accuracy {}, which this one is good for", accuracy_.times(use).option())
          : "");
}

/// How far the truth is known by now, where that is better than what was told before.
void YardstickSearch::tell(const Reference& r) {
  const Yardstick yardstick = of(r);
  if (!finding_ || !(yardstick.own_use() < told_)) return;
  told_ = yardstick.own_use();
  finding_(fmt::format("reference so far: {}, known to {:.2g} times the accuracy asked, least well in {}", r.text(),
                       yardstick.own_use(), evaluator_.outputs().list()[yardstick.worst(r.own)].label));
}

}  // namespace

std::vector<Reference> find_yardstick(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy,
                                      Advice& advice, const Finding& finding) {
  return YardstickSearch(evaluator, candidates, accuracy, advice, finding).find();
}

bool refine_yardstick(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy, Advice& advice,
                      const Finding& finding, double own, const std::vector<Reference>& runs) {
  return YardstickSearch(evaluator, candidates, accuracy, advice, finding).refine(own, runs);
}

}  // namespace withy::study
