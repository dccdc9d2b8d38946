#include "withy/study/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/study/accuracy.hpp"
#include "withy/study/output_reader.hpp"

namespace withy::study {
namespace {

/// Share of an evaluation's cost below which more modes are looked at in a lower rung at once.
constexpr double much_cheaper = 0.7;
/// Times the change by the first family's: less is another one's merit, more may be chance.
constexpr double clearly_less = 0.5;
/// Modes beyond the last level of the higher rung that are looked at in the lower one.
constexpr int most_modes_beyond = 8;

/// To one digit, and no more.
double rounded_down(double x) {
  const double unit = std::pow(10, std::floor(std::log10(x)));
  return unit * std::floor(x / unit);
}

class ReferenceSearch {
 public:
  ReferenceSearch(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                  const Outputs& outputs, const ReferenceGoal& goal, const Control& control)
      : model_at_(model_at), registry_(registry), outputs_(outputs), goal_(goal), control_(control) {}

  /// The family whose series of modes begins best.
  std::string best_family() {
    std::string best = goal_.first.family;
    if (goal_.families.empty() || goal_.first.modes == 0) return best;
    std::optional<double> least = first_change(best);
    for (const std::string& family : goal_.families) {
      if (family == best) continue;
      const std::optional<double> change = first_change(family);
      if (!change || (least && *change > clearly_less * *least)) continue;
      least = change;
      best = family;
    }
    return best;
  }

  /// The tolerance at which integration adds as much as it may. Errors of `dop853` are as its tolerance.
  double measured_tolerance(Point point) {
    constexpr double ten_times = 10;
    const double given = point.tolerance;
    point.formulation = reference_formulations(registry_).back();
    const std::optional<Reference> loose = at(point);
    point.tolerance = given / ten_times;
    const std::optional<Reference> tight = loose ? at(point) : loose;
    if (!tight) return given;
    Reference added = *tight;
    added.own = distances(outputs_, tight->readings, loose->readings).first;
    const double use = goal_.integration(added);
    double tolerance = ten_times * given;
    if (!(tolerance / given * use <= 1)) tolerance = rounded_down(std::max(given / use, goal_.tightest));
    tolerance = std::max(tolerance, goal_.tightest);
    integration_ = added.own;
    for (double& d : integration_) d *= tolerance / given;
    return tolerance;
  }

  /// The coarsest level, in the richest formulation that comes to the end.
  std::optional<Reference> begin(Point point) {
    for (const std::string& formulation : reference_formulations(registry_)) {
      point.formulation = formulation;
      if (auto reference = at(point)) return reference;
      if (found.interrupted) break;
    }
    return {};
  }

  /// A run, made once; nothing where it does not come to its end.
  std::optional<Reference> at(const Point& point) {
    const auto made = runs_.find(point.key());
    if (made != runs_.end()) return made->second;
    std::optional<Reference> reference = run(point);
    if (reference) runs_.emplace(point.key(), *reference);
    return reference;
  }

  [[nodiscard]] bool enough(const Reference& r) const { return !goal_.enough || goal_.enough(r); }
  [[nodiscard]] Point finer(Point point) const {
    if (point.modes > 0) ++point.modes;
    point.tolerance = std::max(goal_.finer * point.tolerance, goal_.tightest);
    return point;
  }

  /// Whether an evaluation costs a fraction in the rung below.
  [[nodiscard]] bool much_cheaper_below(const Point& point) {
    const std::optional<Point> low = below(point);
    return low && model_at_(*low).seconds < much_cheaper * model_at_(point).seconds;
  }

  /// More modes in the rung below, with what the higher one adds at the finer of two levels. Nothing where there is no
  /// rung below, a run does not end or what is added changes too much; the richest is then kept as nearest.
  std::optional<Reference> add_to_lower(const Reference& fine, const Reference& coarse) {
    const std::optional<Point> low = below(fine.point);
    if (!low || fine.point.modes == 0 || !goal_.steady) return {};
    const auto before = at(*below(coarse.point));
    if (!before) return {};
    const auto base = at(*low);
    if (!base) return {};
    // What the coarser level would have added.
    const Distances changed =
        distances(outputs_, corrected(outputs_, base->readings, coarse.readings, before->readings), fine.readings)
            .first;
    Reference added = fine;
    added.own = changed;
    if (!goal_.steady(added)) return {};
    ModeSeries series(outputs_, goal_.kinds);
    series.add(coarse.point.modes, before->readings);
    series.add(fine.point.modes, base->readings);
    Point point = *low;
    for (int i = 0; i < most_modes_beyond; ++i) {
      ++point.modes;  // integration added little to the finer level, which has this tolerance
      const std::optional<Reference> rich = at(point);
      if (!rich) return {};
      series.add(point.modes, rich->readings);
      Reference reached = lead(*rich, series);
      reached.added_by = fine.point;
      reached.readings = corrected(outputs_, series.limit(), fine.readings, base->readings);
      for (std::size_t k = 0; k < changed.size(); ++k) reached.own[k] += changed[k];
      if (enough(reached)) return reached;
      keep_nearest(reached, {});
    }
    return {};
  }

  /// The run that a series has come to, with the readings that it leads to.
  [[nodiscard]] Reference lead(Reference run, const ModeSeries& series) const {
    run.readings = series.limit();
    run.own = series.own();
    for (std::size_t k = 0; k < std::min(run.own.size(), integration_.size()); ++k) run.own[k] += integration_[k];
    run.extrapolated = series.extrapolated();
    return run;
  }

  void keep_nearest(const Reference& r, const Readings& coarser) {
    // Where runs part by all they go through the finer one agrees for longer.
    const auto off = [](const Reference& of) { return std::min(relative_error(of.own, of.scales), 1.0); };
    if (found.nearest && off(r) > off(*found.nearest)) return;
    found.nearest = r;
    found.nearest->coarser = coarser;
  }

  ReferenceFound found;

 private:
  std::optional<Reference> run(const Point& point) {
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
      outputs_.raise_ranges(r.readings.values.back(), r.readings.values.front(), r.ranges);
      return true;
    };
    r.walk = walk(*model.prepared, *make_integrator(registry_, point.integrator, point.tolerance),
                  {keep, goal_.afford, control_.interrupted});
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

  /// By what part of the outputs' scales a mode more changes them in the lowest rung; nothing where a run does not end.
  [[nodiscard]] std::optional<double> first_change(const std::string& family) {
    Point point = goal_.first;
    point.family = family;
    point.formulation = reference_formulations(registry_).back();
    const std::optional<Reference> few = at(point), more = few ? at(finer(point)) : few;
    if (!more) return {};
    return relative_error(distances(outputs_, more->readings, few->readings).first, more->scales);
  }
  /// The same in the next rung that truncates nothing.
  [[nodiscard]] std::optional<Point> below(Point point) const {
    const std::vector<std::string> all = reference_formulations(registry_);
    const auto own = std::find(all.begin(), all.end(), point.formulation);
    if (own == all.end() || own + 1 == all.end()) return {};
    point.formulation = *(own + 1);
    return point;
  }

  const std::function<const ModelAt&(const Point&)>& model_at_;
  Registry& registry_;
  const Outputs& outputs_;
  const ReferenceGoal& goal_;
  const Control& control_;
  Distances integration_;                  ///< what integration adds to each level, as measured; empty: not known
  std::map<std::string, Reference> runs_;  ///< that came to their end, by the point's key
};

}  // namespace

std::vector<std::string> reference_formulations(Registry& registry) {
  std::vector<std::string> ids;
  for (const RankedFormulation& rung : formulation_rungs(registry))
    if (rung.formulation->terms().truncation == Truncation::none) ids.insert(ids.begin(), rung.id);
  return ids;
}

std::string Reference::text() const {
  std::string text = point.text();
  if (extrapolated) text += ", extrapolated";
  if (added_by)
    text += ", with what " + added_by->formulation + " adds at " + std::to_string(added_by->modes) + " modes";
  return text;
}

int kinds_of_modes(const Scene& scene) {
  constexpr int of_a_surface = 3;
  for (const BodyModes& body : scene.modes)
    for (const ModeCount& count : body.counts)
      if (count.modes > 0 && count.strain.empty()) return of_a_surface;
  return 1;
}

ReferenceFound find_reference(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                              const Outputs& outputs, const ReferenceGoal& goal, const Control& control) {
  ReferenceSearch search(model_at, registry, outputs, goal, control);
  ReferenceFound& found = search.found;
  Point first = goal.first;
  first.family = search.best_family();
  if (goal.integration && first.modes > 0 && !found.interrupted) first.tolerance = search.measured_tolerance(first);
  std::optional<Reference> before, coarse = found.interrupted ? std::nullopt : search.begin(first);
  ModeSeries series(outputs, goal.kinds);
  if (coarse) {
    series.add(coarse->point.modes, coarse->readings);
    found.trouble.clear();
    found.unaffordable = false;
  }
  bool tried = false;  // this pair of levels with a lower rung
  for (int level = 0; coarse && level < goal.levels; ++level) {
    const Point finer = search.finer(coarse->point);
    // The same run again would agree with itself.
    if (finer.key() == coarse->point.key()) break;
    std::optional<Reference> fine = search.at(finer);
    if (!fine) break;
    series.add(finer.modes, fine->readings);
    Reference reached = search.lead(*fine, series);
    const bool known = series.size() > static_cast<std::size_t>(goal.kinds);
    if (known && search.enough(reached)) {
      found.reference = std::move(reached);
      return std::move(found);
    }
    if (known) search.keep_nearest(reached, series.limit_before());
    before = std::move(coarse), coarse = std::move(fine);
    tried = search.much_cheaper_below(coarse->point);
    if (tried) found.reference = search.add_to_lower(*coarse, *before);
    if (found.reference || found.interrupted) return std::move(found);
  }
  if (before && !tried && !found.interrupted) {
    const std::string trouble = found.trouble;
    found.reference = search.add_to_lower(*coarse, *before);
    if (!found.reference && found.trouble.empty()) found.trouble = trouble;
  }
  return std::move(found);
}

}  // namespace withy::study
