#include "withy/apps/withy/probe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/apps/withy/beyond.hpp"
#include "withy/apps/withy/progress.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/run_times.hpp"

namespace withy::app {
namespace {

/// CPU time of one evaluation at the initial state [s]: the least of some batches, since other work only adds.
double seconds_per_evaluation(const Scene& scene, const EquationsOfMotion& equations) {
  Work work = equations.make_work();
  std::vector<double> rates(equations.size());
  double least = std::numeric_limits<double>::max();
  for (int batch = 0; batch < 5; ++batch) {
    constexpr int count = 40;
    const double began = thread_cpu_seconds();
    for (int i = 0; i < count; ++i)
      static_cast<void>(equations.derivatives(scene.initial.time, scene.initial.y, rates, work));
    least = std::min(least, (thread_cpu_seconds() - began) / count);
  }
  return least;
}

std::string reason_of(const StepResult& result, const ProbedModel& model) {
  const auto& bodies = model.scene.model->bodies();
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

}  // namespace

std::vector<std::string> overrides_at(const SceneArguments& base, const Scene& scene, const TradePoint& point) {
  std::vector<std::string> overrides = arguments_at(base, scene, point).options.overrides;
  for (const auto& [name, body] : scene.source.at("bodies").members()) {
    const auto own = std::find_if(point.bodies.begin(), point.bodies.end(),
                                  [&name = name](const auto& b) { return b.first == name; });
    if (own != point.bodies.end()) {
      overrides.push_back("bodies." + name + ".formulation=" + own->second);
    } else if (body.has("formulation")) {
      overrides.push_back("bodies." + name + ".formulation=" + point.formulation);
    }
  }
  return overrides;
}

ProbedModel probed_model(const Engine& engine, const SceneArguments& base, const TradePoint& point) {
  ProbedModel m;
  m.point = point;
  try {
    SceneOptions options = base.options;
    options.formulation = point.formulation;
    options.integrator.clear();
    TradePoint any = point;  // a scene has an integrator, whatever the probes take
    any.integrator = "dop853";
    any.tolerance = 1e-6;
    options.overrides = overrides_at(base, engine.scene(), any);
    m.scene = read_scene(base.scene, engine.registry(), options);
    m.equations = m.scene.formulation->compile(m.scene.model);
  } catch (const SceneError& e) {
    m.refusal = e.what();
  } catch (const std::invalid_argument& e) {
    m.refusal = e.what();
  }
  if (m.refused()) return m;
  m.seconds = seconds_per_evaluation(m.scene, *m.equations);
  if (m.equations->layout().speeds <= largest_examined)
    m.fastest = fastest_mode(*m.scene.model, m.equations->system(m.scene.initial.time, m.scene.initial.y));
  return m;
}

std::unique_ptr<Integrator> integrator_at(Registry& registry, const TradePoint& point) {
  return make_integrator(registry, point.integrator,
                         Value::map({{"rtol", Value(point.tolerance)}, {"atol", Value(1e-2 * point.tolerance)}}));
}

Walk walk(const ProbedModel& model, const Integrator& integrator, const std::function<bool(const State&)>& output,
          const std::function<bool(const Walk&)>& afford) {
  const Scene& scene = model.scene;
  const double end = end_of_run(scene);
  Walk w;
  Clocks clocks(*scene.model);
  State sample = scene.initial;
  clocks.begin(sample);
  const auto stepper = integrator.start(*model.equations, sample);
  std::vector<double> rates(model.equations->size());
  Work work = model.equations->make_work();
  const Evaluation first = model.equations->derivatives(sample.time, sample.y, rates, work);
  OutputTimes times(scene.initial.time, scene.output, end);
  const auto told = [&] {
    w.time = stepper->state().time;
    w.steps = stepper->statistics().accepted;
    w.evaluations = stepper->statistics().evaluations;
  };
  if (!output(sample)) {
    w.end = Walk::End::cut;
    return w;
  }
  double began = thread_cpu_seconds();
  const auto pause = [&] { w.seconds += thread_cpu_seconds() - began; };
  for (const double limit : landings(*scene.model, scene.initial.time, end)) {
    while (stepper->state().time < limit) {
      const StepResult result = stepper->step(std::min(limit, clocks.next()));
      if (result.outcome != StepResult::Outcome::ok ||
          stepper->statistics().determinant_sign != first.determinant_sign) {
        pause();
        told();
        w.end = Walk::End::stopped;
        w.reason = result.outcome != StepResult::Outcome::ok ? reason_of(result, model)
                                                             : "the determinant of the mass matrix changed its sign";
        return w;
      }
      const bool last = stepper->state().time >= end;
      const bool instant = stepper->state().time >= clocks.next();
      const bool look = stepper->statistics().accepted % 64 == 0;
      if (!times.due(stepper->state().time) && !last && !instant && !look) continue;
      pause();
      told();
      if (interrupted()) {
        w.end = Walk::End::interrupted;
        return w;
      }
      bool on = !afford || afford(w);
      for (; on && times.due(stepper->state().time); times.pass()) {
        sample.time = times.next();
        stepper->interpolate(sample.time, sample.y);
        on = output(sample);
      }
      if (on && last) on = output(stepper->state());
      if (!on) {
        w.end = Walk::End::cut;
        return w;
      }
      if (instant) {
        sample = stepper->state();
        clocks.renew(sample);
        clocks.go_on_after(sample.time);
        stepper->jump(sample);
      }
      began = thread_cpu_seconds();
    }
    stepper->restart();
  }
  told();
  return w;
}

double Reference::use(const PerMeasure& distances) const {
  double most = 0;
  for (std::size_t m = 0; m < measures; ++m)
    if (std::isfinite(limits[m])) most = std::max(most, distances[m] / limits[m]);
  return most;
}

const char* outcome_name(Probe::Outcome outcome) {
  switch (outcome) {
    case Probe::Outcome::passed:
      return "passed";
    case Probe::Outcome::inaccurate:
      return "inaccurate";
    case Probe::Outcome::too_costly:
      return "too-costly";
    case Probe::Outcome::stopped:
      return "stopped";
    case Probe::Outcome::refused:
      return "refused";
    case Probe::Outcome::interrupted:
      return "interrupted";
  }
  return "unknown";
}

Probe probe(const Engine& engine, const ProbedModel& model, const TradePoint& point, const MeasuredOutputs& outputs,
            const Reference& reference, double most_use, double most_seconds) {
  Probe p;
  p.point = point;
  if (model.refused()) {
    p.reason = model.refusal;
    return p;
  }
  std::vector<double> values;
  std::size_t next = 0;
  bool afforded = true;
  try {
    const auto integrator = integrator_at(engine.registry(), point);
    p.walk = walk(
        model, *integrator,
        [&](const State& s) {
          if (next >= reference.values.size()) return false;
          values.clear();
          outputs.read(*model.scene.model, *model.equations, s.y, values);
          outputs.compare(values, reference.values[next++], p.distances);
          p.use = reference.use(p.distances);
          return p.use <= most_use;
        },
        [&](const Walk& so_far) { return afforded = so_far.seconds <= most_seconds; });
  } catch (const std::invalid_argument& e) {
    p.reason = e.what();
    return p;
  }
  p.reason = p.walk.reason;
  switch (p.walk.end) {
    case Walk::End::reached:
      p.outcome = p.use + reference.own_use() <= 1 ? Probe::Outcome::passed : Probe::Outcome::inaccurate;
      break;
    case Walk::End::cut:
      p.outcome = afforded ? Probe::Outcome::inaccurate : Probe::Outcome::too_costly;
      break;
    case Walk::End::stopped:
      p.outcome = Probe::Outcome::stopped;
      break;
    case Walk::End::interrupted:
      p.outcome = Probe::Outcome::interrupted;
      break;
  }
  return p;
}

}  // namespace withy::app
