#include "withy/study/probe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "withy/study/check_loads.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/search_time.hpp"

namespace withy::study {
namespace {

std::string cost_key(const Point& p) {
  return fmt::format("{} {} {} {} {}", p.formulation_text(), p.family, p.modes, p.integrator, p.tolerance);
}

/// Without what outputs have been over the run, which says nothing before its end.
Distances on_the_way(const Outputs& outputs, Distances distances) {
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (outputs.list()[i].over_a_run()) distances[i] = 0;
  return distances;
}

Probe::Outcome outcome_of(const Probe& p, const Yardstick& yardstick, bool afforded) {
  switch (p.walk.end) {
    case Walk::End::reached:
      return yardstick.use_with_own(p.distances) <= 1 ? Probe::Outcome::passed : Probe::Outcome::inaccurate;
    case Walk::End::cut:
      return afforded ? Probe::Outcome::inaccurate : Probe::Outcome::too_costly;
    case Walk::End::stopped:
      return Probe::Outcome::stopped;
    case Walk::End::interrupted:
      break;
  }
  return Probe::Outcome::interrupted;
}

}  // namespace

double Yardstick::use(const Distances& distances) const {
  if (distances.empty()) return 0;
  const std::size_t i = worst(distances);
  return std::isfinite(limits[i]) ? distances[i] / limits[i] : 0;
}

double Yardstick::use_with_own(const Distances& distances) const {
  Distances all = distances;
  for (std::size_t i = 0; i < std::min(all.size(), reference.own.size()); ++i) all[i] += reference.own[i];
  return use(all);
}

std::size_t Yardstick::worst(const Distances& distances) const {
  std::size_t worst = 0;
  double most = -1;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const double use = std::isfinite(limits[i]) ? distances[i] / limits[i] : -1;
    if (use <= most) continue;
    most = use;
    worst = i;
  }
  return worst;
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
    case Probe::Outcome::no_candidate:
      return "no-candidate";
    case Probe::Outcome::interrupted:
      return "interrupted";
  }
  return "unknown";
}

Evaluator::Evaluator(const Prepared& base, Registry& registry, const Outputs& outputs, Control control)
    : base_(base), registry_(registry), outputs_(outputs), control_(std::move(control)), began_(search_time().now()) {
  check_loads(base);
}

double Evaluator::spent() const { return search_time().now() - began_; }

const ModelAt& Evaluator::model(const Point& point) {
  for (const auto& m : models_)
    if (m->point.same_model(point)) return *m;
  Point plain = point;
  plain.formulation = reference_formulations(registry_).back();
  plain.bodies.clear();
  const ModelAt* const alike = plain.same_model(point) ? nullptr : &model(plain);
  models_.push_back(std::make_unique<ModelAt>(
      model_at(base_, registry_, point, alike != nullptr && !alike->refused() ? alike : nullptr)));
  ModelAt& made = *models_.back();
  if (end_ && made.prepared) made.prepared->scene.end = *end_;
  return made;
}

Probe Evaluator::run(const Point& point, const Yardstick& yardstick, const Allowance& allowance) {
  Probe p;
  p.point = point;
  const ModelAt& at = model(point);
  if (at.refused()) {
    p.reason = at.refusal;
    return p;
  }
  p.distances = outputs_.none();
  const Readings& truth = yardstick.reference.readings;
  OutputReader reader(outputs_, at.prepared->model(), *at.prepared->equations, at.prepared->scene.outputs);
  std::size_t next = 0;
  bool afforded = true;
  const auto measure = [&](const State& s) {
    if (next >= truth.values.size()) return false;
    outputs_.raise(reader.read(s), truth.values[next++], p.distances);
    p.use = yardstick.use(next < truth.values.size() ? on_the_way(outputs_, p.distances) : p.distances);
    return p.use <= allowance.use;
  };
  const auto afford = [&](const Walk& so_far) {
    control_.tell(spent(), limit_);
    return afforded = so_far.seconds <= allowance.seconds && !out_of_time();
  };
  try {
    p.walk = walk(*at.prepared, *make_integrator(registry_, point.integrator, point.tolerance),
                  {measure, afford, control_.interrupted});
  } catch (const std::invalid_argument& e) {
    p.reason = e.what();  // the integrator cannot treat these equations
    return p;
  }
  p.reason = p.walk.reason;
  p.outcome = outcome_of(p, yardstick, afforded);
  note_cost(p);
  return p;
}

Probe Evaluator::judge(const Reference& run, const Yardstick& yardstick) {
  Probe p;
  p.point = run.point;
  p.walk = run.walk;
  p.distances = study::distances(outputs_, run.readings, yardstick.reference.readings).first;
  p.use = yardstick.use(p.distances);
  p.outcome = outcome_of(p, yardstick, true);
  note_cost(p);
  return p;
}

void Evaluator::note_cost(const Probe& probe) {
  if (probe.walk.end != Walk::End::reached) return;  // the start is not like the rest
  const double seconds = probe.walk.seconds / static_cast<double>(probe.walk.evaluations);
  const auto [known, is_new] = unit_costs_.emplace(cost_key(probe.point), seconds);
  if (!is_new) known->second = std::min(known->second, seconds);
}

double Evaluator::cost(const Probe& probe) const {
  const auto known = unit_costs_.find(cost_key(probe.point));
  return known != unit_costs_.end() ? known->second * static_cast<double>(probe.walk.evaluations) : probe.walk.seconds;
}

}  // namespace withy::study
