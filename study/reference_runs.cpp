#include "withy/study/reference_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "withy/study/accuracy.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/third_order.hpp"

namespace withy::study {

ReferenceRuns::ReferenceRuns(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                             const Outputs& outputs, const ReferenceGoal& goal, const Control& control)
    : model_at_(model_at),
      registry_(registry),
      outputs_(outputs),
      goal_(goal),
      control_(control),
      integrations_(model_at, registry, outputs, goal) {
  for (const Reference& run : goal.made) runs_.emplace(run.point.key(), run);
}

void ReferenceRuns::measure_integrations() {
  const auto run = [&](const Point& point, double seconds) { return at(point, seconds); };
  integrations_.measure(run, [&] { return found_.interrupted; });
}

std::optional<Reference> ReferenceRuns::confirm(Reference& level, const std::function<bool(const Reference&)>& enough) {
  return integrations_.confirm(
      level, [&](const Point& point, double seconds) { return at(point, seconds); }, enough);
}

std::optional<Reference> ReferenceRuns::at(const Point& point) {
  const auto made = runs_.find(point.key());
  std::optional<Reference> reference = made != runs_.end() ? made->second : run(point);
  if (!reference) return {};
  if (made == runs_.end()) runs_.emplace(point.key(), *reference);
  integrations_.note(*reference);
  return reference;
}

std::optional<Reference> ReferenceRuns::at(const Point& point, double seconds) {
  const std::string trouble = found_.trouble;
  const bool unaffordable = found_.unaffordable;
  most_seconds_ = seconds;
  std::optional<Reference> reference = at(point);
  most_seconds_ = std::numeric_limits<double>::infinity();
  found_.trouble = trouble, found_.unaffordable = unaffordable;
  return reference;
}

std::optional<Reference> ReferenceRuns::run(const Point& point) {
  const ModelAt& model = model_at_(point);
  if (model.refused()) {
    found_.trouble = model.refusal;
    return {};
  }
  Reference r{.point = point, .readings = {}, .ranges = outputs_.none(), .scales = {}, .own = {}, .walk = {}};
  OutputReader reader(outputs_, model.prepared->model(), *model.prepared->equations, model.prepared->scene.outputs);
  ThirdOrder third_order(*model.prepared);
  const auto keep = [&](const State& s) {
    third_order.look(s);
    r.readings.times.push_back(s.time);
    r.readings.values.push_back(reader.read(s));
    r.energy = std::max(r.energy, reader.kinetic_energy());
    outputs_.raise_ranges(r.readings.values.back(), r.readings.values.front(), r.ranges);
    return true;
  };
  const double whole = integrations_.expected_seconds(point);
  const auto afford = [&](const Walk& so_far) {
    return so_far.seconds <= most_seconds_ && (!goal_.afford || goal_.afford(so_far, whole));
  };
  r.walk = walk(*model.prepared, *make_integrator(registry_, point.integrator, point.tolerance),
                {keep, afford, control_.interrupted});
  r.scales = scales(outputs_, r.ranges, r.energy);
  r.bend = third_order.bend();
  r.bent = third_order.body();
  r.third_order = third_order.over_a_run();
  return ended(point, std::move(r));
}

/// The run where it has come to its end, or why it has not.
std::optional<Reference> ReferenceRuns::ended(const Point& point, Reference r) {
  found_.cpu_seconds += r.walk.seconds;
  found_.interrupted = r.walk.end == Walk::End::interrupted;
  if (r.walk.end == Walk::End::reached) {
    if (goal_.ended) goal_.ended(r.walk);
    return r;
  }
  found_.unaffordable = r.walk.end == Walk::End::cut;
  found_.trouble =
      found_.unaffordable
          ? fmt::format("{}: at {:.4g} s of the run after {:.2g} s of CPU time, when the time for it ended",
                        point.text(), r.walk.time, r.walk.seconds)
          : fmt::format("{}: ends at {:.4g} s: {}", point.text(), r.walk.time, r.walk.reason);
  return {};
}

ReferenceFound ReferenceRuns::take_found() {
  for (auto& [key, run] : runs_) found_.runs.push_back(std::move(run));
  return std::move(found_);
}

}  // namespace withy::study
