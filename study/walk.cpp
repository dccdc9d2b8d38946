#include "withy/study/walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// CPU time of one evaluation at the initial state [s]: the least of some batches, since other work only adds.
double seconds_per_evaluation(const Prepared& model) {
  const EquationsOfMotion& equations = *model.equations;
  const State& initial = model.scene.initial;
  Work work = equations.make_work();
  std::vector<double> rates(equations.size());
  double least = std::numeric_limits<double>::max();
  for (int batch = 0; batch < 5; ++batch) {
    constexpr int count = 40;
    const double began = thread_cpu_seconds();
    for (int i = 0; i < count; ++i) static_cast<void>(equations.derivatives(initial.time, initial.y, rates, work));
    least = std::min(least, (thread_cpu_seconds() - began) / count);
  }
  return least;
}

std::string reason_of(const StepResult& result, const Prepared& model) {
  const auto& bodies = model.model().bodies();
  const std::string body =
      result.body >= 0 ? " at body '" + bodies[static_cast<std::size_t>(result.body)].name + "'" : "";
  switch (result.outcome) {
    case StepResult::Outcome::nonfinite:
      return "the derivatives are not finite" + body;
    case StepResult::Outcome::singular:
      return "the mass matrix cannot be solved" + body;
    default:
      return "the accuracy asked for needs steps below the resolution of time";
  }
}

/// One walk under way.
class Walker {
 public:
  Walker(const Prepared& model, const Integrator& integrator, const WalkObserver& observer)
      : model_(model),
        observer_(observer),
        end_(end_of_run(model.scene)),
        clocks_(model.model()),
        sample_(started(clocks_, model.scene.initial)),
        stepper_(integrator.start(*model.equations, sample_)),
        times_(model.scene.initial.time, model.scene.output, end_) {}

  Walk walk() {
    std::vector<double> rates(model_.equations->size());
    Work work = model_.equations->make_work();
    sign_ = model_.equations->derivatives(sample_.time, sample_.y, rates, work).determinant_sign;
    if (!observer_.output(sample_)) return ended(Walk::End::cut);
    for (const double limit : landings(model_.model(), model_.scene.initial.time, end_)) {
      if (!walk_to(limit)) return walk_;
      stepper_->restart();
    }
    return ended(Walk::End::reached);
  }

 private:
  static State started(Clocks& clocks, State state) {
    clocks.begin(state);
    return state;
  }

  /// False where the walk has ended before.
  bool walk_to(double limit) {
    double began = thread_cpu_seconds();
    while (stepper_->state().time < limit) {
      const StepResult result = stepper_->step(std::min(limit, clocks_.next()));
      const bool turned = stepper_->statistics().determinant_sign != sign_;
      if (result.outcome != StepResult::Outcome::ok || turned) {
        walk_.seconds += thread_cpu_seconds() - began;
        walk_.reason = result.outcome != StepResult::Outcome::ok
                           ? reason_of(result, model_)
                           : "the determinant of the mass matrix changed its sign";
        ended(Walk::End::stopped);
        return false;
      }
      if (!worth_a_look()) continue;
      walk_.seconds += thread_cpu_seconds() - began;
      if (!look()) return false;
      began = thread_cpu_seconds();
    }
    walk_.seconds += thread_cpu_seconds() - began;
    return true;
  }

  [[nodiscard]] bool worth_a_look() const {
    constexpr std::size_t steps_between_looks = 64;
    const double t = stepper_->state().time;
    return times_.due(t) || t >= end_ || t >= clocks_.next() ||
           stepper_->statistics().accepted % steps_between_looks == 0;
  }

  /// Gives the outputs that are due and renews discrete states. False where the walk has ended.
  bool look() {
    if (observer_.interrupted && observer_.interrupted()) {
      ended(Walk::End::interrupted);
      return false;
    }
    tell();
    bool on = !observer_.afford || observer_.afford(walk_);
    for (; on && times_.due(stepper_->state().time); times_.pass()) {
      sample_.time = times_.next();
      stepper_->interpolate(sample_.time, sample_.y);
      on = observer_.output(sample_);
    }
    if (on && stepper_->state().time >= end_) on = observer_.output(stepper_->state());
    if (!on) {
      ended(Walk::End::cut);
      return false;
    }
    if (stepper_->state().time >= clocks_.next()) {
      sample_ = stepper_->state();
      clocks_.renew(sample_);
      clocks_.go_on_after(sample_.time);
      stepper_->jump(sample_);
    }
    return true;
  }

  void tell() {
    walk_.time = stepper_->state().time;
    walk_.steps = stepper_->statistics().accepted;
    walk_.evaluations = stepper_->statistics().evaluations;
  }

  const Walk& ended(Walk::End end) {
    tell();
    walk_.end = end;
    return walk_;
  }

  const Prepared& model_;
  const WalkObserver& observer_;
  double end_;
  Clocks clocks_;
  State sample_;
  std::unique_ptr<Stepper> stepper_;
  OutputTimes times_;
  int sign_ = 1;
  Walk walk_;
};

/// With loads that switch by the state: `simulate`, which finds the zeros of their functions.
Walk walk_as_a_run(const Prepared& model, const Integrator& integrator, const WalkObserver& observer) {
  bool on = true, interrupted = false;
  RunOptions options = run_options(model.scene);
  options.events.clear();
  options.interrupted = [&] {
    interrupted = interrupted || (observer.interrupted && observer.interrupted());
    return !on || interrupted;
  };
  const double began = thread_cpu_seconds();
  const auto output = [&](const State& state) {
    Walk so_far;
    so_far.time = state.time;
    so_far.seconds = thread_cpu_seconds() - began;
    on = on && (!observer.afford || observer.afford(so_far)) && observer.output(state);
  };
  const RunSummary s =
      withy::simulate(model.model(), *model.equations, integrator, model.scene.initial, options, output);
  Walk w{Walk::End::reached, s.message, s.final.time, s.steps.accepted, s.steps.evaluations, s.cpu_seconds};
  if (s.status == RunStatus::interrupted) {
    w.end = on ? Walk::End::interrupted : Walk::End::cut;
  } else if (s.status != RunStatus::completed) {
    w.end = Walk::End::stopped;
  }
  return w;
}

}  // namespace

ModelAt model_at(const Prepared& base, Registry& registry, const Point& point) {
  ModelAt m{point, {}, {}, 0, 0};
  try {
    Point any = point;  // a scene has an integrator, whatever is walked with
    any.integrator = "dop853";
    any.tolerance = 1e-6;
    m.prepared = prepare(values_at(base.values, base.scene, any), registry);
  } catch (const SceneError& e) {
    m.refusal = e.what();
  } catch (const InputError& e) {
    m.refusal = e.what();
  }
  if (m.refused()) return m;
  m.seconds = seconds_per_evaluation(*m.prepared);
  const EquationsOfMotion& equations = *m.prepared->equations;
  const State& initial = m.prepared->scene.initial;
  if (equations.layout().speeds <= largest_examined)
    m.fastest = fastest_mode(m.prepared->model(), equations.system(initial.time, initial.y));
  return m;
}

Walk walk(const Prepared& model, const Integrator& integrator, const WalkObserver& observer) {
  return has_switches(model.model()) ? walk_as_a_run(model, integrator, observer)
                                     : Walker(model, integrator, observer).walk();
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

}  // namespace withy::study
