#include "withy/study/walk.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/loop_following.hpp"
#include "withy/core/simulation/loop_watch.hpp"
#include "withy/core/simulation/stepping.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/remedy.hpp"
#include "withy/study/search_time.hpp"

namespace withy::study {
namespace {

std::string reason_of(const StepResult& result, const Prepared& model, double time) {
  const auto& bodies = model.model().bodies();
  const std::string body =
      result.body >= 0 ? " at body '" + bodies[static_cast<std::size_t>(result.body)].name + "'" : "";
  switch (result.outcome) {
    case StepResult::Outcome::nonfinite:
      return "the derivatives are not finite" + body;
    case StepResult::Outcome::singular:
      return "the mass matrix cannot be solved" + body;
    default:
      return "the accuracy asked for needs steps below " +
             std::string(least_step(model.scene, time) != nullptr ? "min_step" : "the resolution of time");
  }
}

/// Watches a walk: gives outputs, counts what stepping costs, and ends it.
class Watch final : public SteppingObserver {
 public:
  /// \param sign of the mass matrix's determinant at the start
  Watch(const Prepared& model, const WalkObserver& observer, LoopWatch loops, int sign)
      : model_(model), observer_(observer), loops_(std::move(loops)), sign_(sign) {}

  bool output(const State& state) override {
    pause();
    walk.time = state.time;
    const bool on = may_go_on() && seen(observer_.output(state));
    began_ = time_.now();
    return on;
  }

  bool after_step(const Stepper& stepper, bool) override {
    constexpr std::size_t steps_between_looks = 64;
    count(stepper);
    if (stepper.statistics().determinant_sign != sign_) {
      walk.end = Walk::End::stopped;
      walk.reason = "the determinant of the mass matrix changed its sign";
      return false;
    }
    if (const std::string fault = loops_.fault(stepper); !fault.empty()) {
      stop(fault);
      return false;
    }
    if (stepper.statistics().accepted % steps_between_looks != 0) return true;
    pause();
    walk.time = stepper.state().time;
    const bool on = may_go_on();
    began_ = time_.now();
    return on;
  }

  /// What is known when stepping has ended.
  void finish(const Stepping& loop, const SteppingEnd& ended) {
    count(loop.stepper());
    pause();
    walk.time = loop.state().time;
    if (ended.cause == SteppingEnd::Cause::reached) static_cast<void>(seen(observer_.output(loop.state())));
    if (ended.cause == SteppingEnd::Cause::failed)
      stop(ended.reason.empty() ? reason_of(ended.step, model_, loop.state().time) : ended.reason);
    if (ended.cause == SteppingEnd::Cause::crowded)
      stop("loads switch or events act again and again without time between the instants");
  }

  Walk walk;

 private:
  void count(const Stepper& stepper) {
    walk.steps = stepper.statistics().accepted;
    time_.evaluated(model_, stepper.statistics().evaluations - walk.evaluations);
    walk.evaluations = stepper.statistics().evaluations;
  }
  void pause() { walk.seconds += time_.now() - began_; }
  void stop(std::string why) {
    walk.end = Walk::End::stopped;
    walk.reason = std::move(why);
  }
  bool may_go_on() {
    if (observer_.interrupted && observer_.interrupted()) {
      walk.end = Walk::End::interrupted;
      return false;
    }
    return !observer_.afford || seen(observer_.afford(walk));
  }
  bool seen(bool on) {
    if (!on) walk.end = Walk::End::cut;
    return on;
  }

  const Prepared& model_;
  const WalkObserver& observer_;
  LoopWatch loops_;
  int sign_;
  SearchTime& time_ = search_time();
  double began_ = time_.now();
};

}  // namespace

ModelAt model_at(const Prepared& base, Registry& registry, const Point& point, const ModelAt* alike) {
  ModelAt m{point, {}, {}, 0, 0};
  try {
    Point any = point;  // a scene has an integrator, whatever is walked with
    any.integrator = "dop853";
    any.tolerance = 1e-6;
    m.prepared = prepare(values_at(base.values, base.scene, any, registry), registry);
  } catch (const SceneError& e) {
    m.refusal = e.what();
  } catch (const InputError& e) {
    m.refusal = e.what();
  }
  if (m.refused()) return m;
  m.seconds = search_time().of_evaluation(*m.prepared);
  const EquationsOfMotion& equations = *m.prepared->equations;
  const State& initial = m.prepared->scene.initial;
  if (alike != nullptr)
    m.fastest = alike->fastest;
  else if (equations.layout().speeds <= largest_examined)
    m.fastest = fastest_mode(m.prepared->model(), equations.system(initial.time, initial.y),
                             closing_rows(equations, initial.y));
  return m;
}

double explicit_evaluations(const ModelAt& model) {
  constexpr double stages = 12, stable = 5.96;  // of dop853
  const Scene& scene = model.prepared->scene;
  return stages / stable * model.fastest * (end_of_run(scene) - scene.initial.time);
}

Walk walk(const Prepared& model, const Integrator& integrator, const WalkObserver& observer) {
  const EquationsOfMotion& equations = *model.equations;
  const State start = begun(model.model(), equations, model.scene.initial);
  EventActions actions(model.model(), equations, {});
  const double interval = observer.interval > 0 ? observer.interval : model.scene.output;
  Stepping loop(model.model(), equations, start_stepper(integrator, equations, start),
                {.end = end_of_run(model.scene), .output = interval, .events = actions.watched(), .actions = &actions});
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  Watch watch(model, observer, LoopWatch(equations, start),
              equations.derivatives(start.time, start.y, rates, work).determinant_sign);
  if (watch.output(start)) {
    SteppingEnd ended = loop.run(watch);
    while (ended.cause == SteppingEnd::Cause::event) ended = loop.run(watch);  // what stops a run stops no walk
    watch.finish(loop, ended);
  }
  return watch.walk;
}

std::pair<Distances, double> distances(const Outputs& outputs, const Readings& a, const Readings& b) {
  Distances greatest = outputs.none();
  double until = 0;
  for (std::size_t i = 0; i < std::min(a.times.size(), b.times.size()); ++i) {
    // The last output of a run that stopped need not be at a common time.
    if (a.times[i] != b.times[i]) break;
    outputs.raise(a.values[i], b.values[i], greatest);
    until = a.times[i];
  }
  return {greatest, until};
}

double agree_until(const Outputs& outputs, const Readings& a, const Readings& b, const Distances& limits) {
  Distances greatest = outputs.none();
  double until = 0;
  for (std::size_t i = 0; i < std::min(a.times.size(), b.times.size()) && a.times[i] == b.times[i]; ++i) {
    outputs.raise(a.values[i], b.values[i], greatest);
    for (std::size_t k = 0; k < greatest.size(); ++k)
      if (greatest[k] > limits[k]) return until;
    until = a.times[i];
  }
  return until;
}

}  // namespace withy::study
