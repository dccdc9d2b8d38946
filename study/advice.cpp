#include "withy/study/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/scene/value_path.hpp"
#include "withy/study/advice_search.hpp"
#include "withy/study/advice_yardstick.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/own_instants.hpp"

namespace withy::study {
namespace {

/// Of the time allowed: the rest is for running what is chosen as a scene that says so is.
constexpr double search_share = 0.9;

/// The choice, run as a scene that says so is: a deflection past the scene's limit shows there alone.
RunSummary confirm(Evaluator& evaluator, const Point& choice) {
  const Prepared& model = *evaluator.model(choice).prepared;
  RunOptions options = run_options(model.scene);
  options.interrupted = evaluator.control().interrupted;
  return simulate(model.model(), *model.equations,
                  *make_integrator(evaluator.registry(), choice.integrator, choice.tolerance), model.scene.initial,
                  options, {});
}

/// Where events end the run of the scene, its time is over: what comes after has other ranges, which the run never
/// goes through, and costs what it never does. The time is that in `quadratic`, and one for all models, though each
/// meets the event at its own: what they are measured against has to last as long as they do. \param seconds of CPU
/// time that are given to it \returns Advice::until
std::string end_at_stop(Evaluator& evaluator, double seconds) {
  const Prepared& base = evaluator.base();
  const auto stops = [](const RunEvent& event) { return event.stops; };
  if (std::none_of(base.scene.events.begin(), base.scene.events.end(), stops)) return {};
  const ModelAt quadratic = model_at(base, evaluator.registry(), {"quadratic", "", 0, "", 0, {}, {}});
  if (quadratic.refused()) return {};
  const Prepared& model = *quadratic.prepared;
  RunOptions options = run_options(model.scene);
  const double until = thread_cpu_seconds() + seconds;
  options.interrupted = [&] {
    const auto& interrupted = evaluator.control().interrupted;
    return (interrupted && interrupted()) || thread_cpu_seconds() > until;
  };
  const RunSummary run =
      simulate(model.model(), *model.equations, *base.scene.integrator, model.scene.initial, options, {});
  if (evaluator.control().stop()) return {};
  if (run.status == RunStatus::interrupted)
    return fmt::format(
        "a run up to an event that ends it was cut at {:.4g} s, for it had taken {:.2g} s of CPU time: everything is "
        "measured as if no event ended the run",
        run.reached, seconds);
  if (!run.ended_by_event || !(run.reached > model.scene.initial.time)) return {};
  evaluator.end_at(run.reached);
  return fmt::format("event '{}' ends the run at {:.4g} s, and everything is measured up to there",
                     run.events.empty() ? "" : run.events.back().name, run.reached);
}

/// 20 times the CPU time of the scene's run in `quadratic` [s], or 10 s if that is more. A run that is clearly longer
/// than the share of it that is looked at is judged by that share.
double time_limit(Evaluator& evaluator) {
  constexpr double runs = 20, least = 10;
  const ModelAt& quadratic = evaluator.model({"quadratic", "", 0, "", 0, {}, {}});
  if (quadratic.refused()) return least;
  const Prepared& model = *quadratic.prepared;
  const auto on = [](const State&) { return true; };
  const auto afford = [](const Walk& so_far) { return so_far.seconds <= least / runs; };
  const Walk w = walk(model, *evaluator.base().scene.integrator, {on, afford, evaluator.control().interrupted});
  if (w.end != Walk::End::cut) return std::max(least, runs * w.seconds);
  const double start = model.scene.initial.time, gone = w.time - start;
  return gone > 0 ? std::max(least, runs * w.seconds * (evaluator.end() - start) / gone) : least;
}

/// Fills the advice of a search that has a choice.
void finish(Search& search, Evaluator& evaluator, Advice& advice) {
  while (advice.choice && !search.stopped()) {
    advice.confirmed = confirm(evaluator, advice.choice->point);
    if (advice.confirmed.status == RunStatus::completed || search.stopped()) break;
    const std::string key = advice.choice->point.key();
    for (Probe& p : advice.probes) {
      if (p.point.key() != key) continue;
      p.outcome = Probe::Outcome::stopped;
      p.reason = advice.confirmed.message;
    }
    search.choose();
  }
  for (Probe& p : advice.probes) p.cost = evaluator.cost(p);
  if (!advice.choice || search.stopped()) return;
  Probe& choice = *advice.choice;
  choice.cost = evaluator.cost(choice);
  const Prepared& model = *evaluator.model(choice.point).prepared;
  const auto integrator = make_integrator(evaluator.registry(), choice.point.integrator, choice.point.tolerance);
  advice.steps = step_limit(model, *integrator, absolute_tolerance(choice.point.tolerance), advice.confirmed);
  advice.indicators = indicators(model.scene, advice.confirmed);
  search.look_up();
  for (Probe& p : advice.above) p.cost = evaluator.cost(p);
}

/// Goes on with the reference where what would cost clearly less than the best holds the accuracy itself, but not with
/// what the reference may be off by.
void refine(Search& search, Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy,
            Advice& advice, const Finding& finding, const std::vector<Reference>& runs) {
  if (search.over()) return;
  const std::optional<double> own = search.own_wanted();
  if (!own || *own >= advice.yardstick->own_use()) return;
  if (refine_yardstick(evaluator, candidates, accuracy, advice, finding, *own, runs)) search.judge_again();
}

}  // namespace

Advice advise(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy, const Finding& finding,
              std::optional<double> seconds) {
  if (seconds && !(*seconds > 0 && std::isfinite(*seconds)))
    throw OptionError("seconds", fmt::format("got {:g} s; need a finite time above 0", *seconds));
  const Scene& scene = evaluator.base().scene;
  if (has_switches(*scene.model))
    throw InputError(fmt::format(
        "{}: {}; runs that are measured against each other need common instants here. 'withy trade' and 'withy "
        "compare' take it",
        scene.file, own_instants(*scene.model)));
  accuracy.require_something_of(evaluator.outputs());
  require_a_run(scene);
  Advice advice;
  constexpr double given = 10, share = 0.25;  // of the time that is asked for
  advice.until = end_at_stop(evaluator, seconds ? share * *seconds : given);
  if (finding && !advice.until.empty()) finding(advice.until);
  advice.limit_seconds = seconds ? *seconds : time_limit(evaluator);
  evaluator.limit(search_share * advice.limit_seconds);
  if (finding)
    finding(fmt::format("the search takes {:.3g} s of CPU time at most{}", advice.limit_seconds,
                        seconds ? "" : ", the longer of 10 s and 20 runs in quadratic"));
  const std::vector<Reference> runs = find_yardstick(evaluator, candidates, accuracy, advice, finding);
  Search search(evaluator, candidates, advice, finding);
  if (advice.yardstick && !search.stopped()) {
    search.take(runs);
    search.try_models();
    refine(search, evaluator, candidates, accuracy, advice, finding, runs);
    search.choose();
    search.simplify_bodies();
    finish(search, evaluator, advice);
  }
  advice.interrupted = search.stopped();
  if (advice.interrupted) advice.choice.reset();
  if (advice.choice)
    advice.trouble.clear(), advice.nearest.reset();
  else if (!advice.trouble.empty())
    advice.yardstick.reset();
  advice.cpu_seconds = evaluator.spent();
  evaluator.limit(std::numeric_limits<double>::infinity());
  return advice;
}

std::string more_time_text(const Advice& advice) {
  constexpr double times = 3;
  return fmt::format("give the search more time (--seconds {:.3g})", times * advice.limit_seconds);
}

std::vector<Change> new_changes(const Scene& scene, const Point& choice, Registry& registry) {
  const auto says = [&](const Change& change) {
    const Value* at = value_at(scene.source, change.path);
    if (at == nullptr || at->kind() != change.value.kind()) return false;
    return (at->kind() == Value::Kind::number && at->number() == change.value.number()) ||
           (at->kind() == Value::Kind::text && at->text() == change.value.text());
  };
  std::vector<Change> all{{"formulation", Value(choice.formulation)}};
  for (Change& change : changes_at(scene, choice, registry))
    if (!says(change)) all.push_back(std::move(change));
  // The integrator beside the formulation.
  std::stable_partition(all.begin(), all.end(),
                        [](const Change& c) { return c.path == "formulation" || c.path == "integrator"; });
  return all;
}

}  // namespace withy::study
