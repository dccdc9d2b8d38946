#include "withy/study/reference.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/study/accuracy.hpp"

namespace withy::study {
namespace {

class ReferenceSearch {
 public:
  ReferenceSearch(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                  const Outputs& outputs, const std::function<bool(const Walk&)>& afford, const Control& control)
      : model_at_(model_at), registry_(registry), outputs_(outputs), afford_(afford), control_(control) {}

  /// The coarsest level, in the richest formulation that comes to the end.
  std::optional<Reference> begin(Point point) {
    for (const std::string& formulation : reference_formulations(registry_)) {
      point.formulation = formulation;
      if (auto reference = at(point)) return reference;
      if (found.interrupted) break;
    }
    return {};
  }

  std::optional<Reference> at(const Point& point) {
    const ModelAt& model = model_at_(point);
    if (model.refused()) {
      found.trouble = model.refusal;
      return {};
    }
    Reference r{.point = point, .readings = {}, .ranges = outputs_.none(), .scales = {}, .own = {}, .walk = {}};
    OutputReader reader(outputs_, model.prepared->model(), *model.prepared->equations, model.prepared->scene.outputs);
    const auto keep = [&](const State& s) {
      r.readings.times.push_back(s.time);
      r.readings.values.push_back(reader.read(s));
      r.energy = std::max(r.energy, reader.kinetic_energy());
      outputs_.raise(r.readings.values.back(), r.readings.values.front(), r.ranges);
      return true;
    };
    r.walk = walk(*model.prepared, *make_integrator(registry_, point.integrator, point.tolerance),
                  {keep, afford_, control_.interrupted});
    r.scales = scales(outputs_, r.ranges, r.energy);
    found.cpu_seconds += r.walk.seconds;
    found.interrupted = r.walk.end == Walk::End::interrupted;
    if (r.walk.end == Walk::End::reached) return r;
    found.unaffordable = r.walk.end == Walk::End::cut;
    if (found.unaffordable) {
      found.trouble = fmt::format("{}: at {:.4g} s of the run after {:.2g} s of CPU time, when the time for it ended",
                                  point.text(), r.walk.time, r.walk.seconds);
      return {};
    }
    found.trouble = fmt::format("{}: ends at {:.4g} s: {}", point.text(), r.walk.time, r.walk.reason);
    return {};
  }

  ReferenceFound found;

 private:
  const std::function<const ModelAt&(const Point&)>& model_at_;
  Registry& registry_;
  const Outputs& outputs_;
  const std::function<bool(const Walk&)>& afford_;
  const Control& control_;
};

}  // namespace

std::vector<std::string> reference_formulations(Registry& registry) {
  std::vector<std::string> ids;
  for (const RankedFormulation& rung : formulation_rungs(registry))
    if (rung.formulation->terms().truncation == Truncation::none) ids.insert(ids.begin(), rung.id);
  return ids;
}

ReferenceFound find_reference(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                              const Outputs& outputs, const ReferenceGoal& goal, const Control& control) {
  ReferenceSearch search(model_at, registry, outputs, goal.afford, control);
  std::optional<Reference> coarse = search.begin(goal.first);
  if (coarse) {
    search.found.trouble.clear();
    search.found.unaffordable = false;
  }
  for (int level = 0; coarse && level < goal.levels; ++level) {
    Point point = coarse->point;
    if (point.modes > 0) ++point.modes;
    point.tolerance = std::max(goal.finer * point.tolerance, goal.tightest);
    std::optional<Reference> fine = search.at(point);
    if (!fine) break;
    fine->own = distances(outputs, fine->readings, coarse->readings).first;
    if (!goal.enough || goal.enough(*fine)) {
      search.found.reference = std::move(fine);
      return std::move(search.found);
    }
    coarse = std::move(fine);
  }
  if (coarse && !coarse->own.empty()) search.found.nearest = std::move(coarse);
  return std::move(search.found);
}

}  // namespace withy::study
