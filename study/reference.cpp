#include "withy/study/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/study/accuracy.hpp"
#include "withy/study/level_integrations.hpp"
#include "withy/study/output_reader.hpp"

namespace withy::study {
namespace {

/// Share of an evaluation's cost below which more modes are looked at in a lower rung at once.
constexpr double much_cheaper = 0.7;
/// Times the change by the first family's: less is another one's merit, more may be chance.
constexpr double clearly_less = 0.5;
/// Modes beyond the last level of the higher rung that are looked at in the lower one.
constexpr int most_modes_beyond = 8;
/// Times the cost of the last level of the higher rung: what more modes in the lower one may cost before the higher one
/// has its next level, which costs about that.
constexpr double next_level = 2;

class ReferenceSearch {
 public:
  ReferenceSearch(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                  const Outputs& outputs, const ReferenceGoal& goal, const Control& control)
      : model_at_(model_at),
        registry_(registry),
        outputs_(outputs),
        goal_(goal),
        control_(control),
        integrations_(model_at, registry, outputs, goal) {
    for (const Reference& run : goal.made) runs_.emplace(run.point.key(), run);
  }

  /// Level after level, until one is known well enough or nothing more can be had.
  void find() {
    Point first = goal_.first;
    if (goal_.integration && first.modes > 0) measure_integrations();
    first = integrations_.on(first);
    if (!found_.interrupted) first.family = best_family(first);
    std::optional<Reference> before, coarse = found_.interrupted ? std::nullopt : begin(first);
    if (!coarse) return;
    ModeSeries series(outputs_, goal_.kinds);
    series.add(coarse->point.modes, coarse->readings);
    found_.trouble.clear();
    found_.unaffordable = false;
    for (int level = 0; level < goal_.levels; ++level) {
      const Point next = finer(coarse->point);
      // The same run again would agree with itself.
      if (next.key() == coarse->point.key()) break;
      std::optional<Reference> fine = at(next);
      if (!fine) break;
      series.add(next.modes, fine->readings);
      if (series.size() > static_cast<std::size_t>(goal_.kinds) && known_by(*fine, series)) return;
      before = std::move(coarse), coarse = std::move(fine);
      if (much_cheaper_below(coarse->point) && lower_affordable(*coarse, *before))
        found_.reference = add_to_lower(*coarse, *before, next_level * coarse->walk.seconds);
      if (found_.reference || found_.interrupted) return;
    }
    if (!before || found_.interrupted || !lower_affordable(*coarse, *before)) return;
    const std::string trouble = found_.trouble;
    found_.reference = add_to_lower(*coarse, *before, std::numeric_limits<double>::infinity());
    if (!found_.reference && found_.trouble.empty()) found_.trouble = trouble;
  }

  ReferenceFound take_found() {
    for (auto& [key, run] : runs_) found_.runs.push_back(std::move(run));
    return std::move(found_);
  }

 private:
  /// Whether a level is known well enough, which is the end of the search; what comes near it is kept.
  bool known_by(const Reference& level, const ModeSeries& series) {
    Reference reached = lead(level, series);
    if (!enough(reached)) {
      keep_nearest(reached, series.limit_before());
      return false;
    }
    found_.reference = std::move(reached);
    return true;
  }

  /// The family whose series of modes begins best.
  std::string best_family(const Point& first) {
    std::string best = first.family;
    if (goal_.families.empty() || first.modes == 0) return best;
    std::optional<double> least = first_change(first, best);
    for (const std::string& family : goal_.families) {
      if (family == best) continue;
      const std::optional<double> change = first_change(first, family);
      if (!change || (least && *change > clearly_less * *least)) continue;
      least = change;
      best = family;
    }
    return best;
  }

  /// A run that is not worth its time is no trouble.
  void measure_integrations() {
    const std::string trouble = found_.trouble;
    const auto run = [&](const Point& point, double seconds) {
      most_seconds_ = seconds;
      return at(point);
    };
    integrations_.measure(run, [&] { return found_.interrupted; });
    most_seconds_ = std::numeric_limits<double>::infinity();
    found_.trouble = trouble, found_.unaffordable = false;
  }

  /// The coarsest level, in the richest formulation that comes to the end.
  std::optional<Reference> begin(Point point) {
    for (const std::string& formulation : reference_formulations(registry_)) {
      point.formulation = formulation;
      if (auto reference = at(point)) return reference;
      if (found_.interrupted) break;
    }
    return {};
  }

  /// A run, made once; nothing where it does not come to its end.
  std::optional<Reference> at(const Point& point) {
    const auto made = runs_.find(point.key());
    std::optional<Reference> reference = made != runs_.end() ? made->second : run(point);
    if (!reference) return {};
    if (made == runs_.end()) runs_.emplace(point.key(), *reference);
    integrations_.note(*reference);
    return reference;
  }

  [[nodiscard]] bool enough(const Reference& r) const { return !goal_.enough || goal_.enough(r); }
  [[nodiscard]] Point finer(Point point) const {
    if (point.modes > 0) ++point.modes;
    point.tolerance = std::max(goal_.finer * point.tolerance, goal_.tightest);
    return integrations_.on(point);
  }

  /// Whether an evaluation costs a fraction in the rung below.
  [[nodiscard]] bool much_cheaper_below(const Point& point) {
    const std::optional<Point> low = below(point);
    return low && model_at_(*low).seconds < much_cheaper * model_at_(point).seconds;
  }

  /// Whether there is time for a mode more in the rung below: for the run with as many modes, where it is not made, and
  /// for one that costs more as the finer of two levels does.
  [[nodiscard]] bool lower_affordable(const Reference& fine, const Reference& coarse) {
    const std::optional<Point> low = below(fine.point);
    if (!low || !goal_.left) return true;
    const double base = fine.walk.seconds * model_at_(*low).seconds / model_at_(fine.point).seconds,
                 more = base * std::max(1.0, fine.walk.seconds / coarse.walk.seconds);
    return (runs_.contains(low->key()) ? more : base + more) <= goal_.left();
  }

  /// More modes in the rung below, with what the higher one adds at the finer of two levels. Nothing where there is no
  /// rung below, a run does not end, what is added changes too much or the modes cost more; the richest is then kept as
  /// nearest.
  /// \param seconds of CPU time that more modes may cost; the run under way is ended
  std::optional<Reference> add_to_lower(const Reference& fine, const Reference& coarse, double seconds) {
    const std::optional<Point> low = below(fine.point);
    if (!low || fine.point.modes == 0 || !goal_.steady) return {};
    const auto before = at(*below(coarse.point));
    if (!before) return {};
    const auto base = at(*low);
    if (!base) return {};
    beside_.insert_or_assign(before->point.modes, *before);
    beside_.insert_or_assign(base->point.modes, *base);
    // What the coarser level would have added.
    const Distances changed =
        distances(outputs_, corrected(outputs_, base->readings, coarse.readings, before->readings), fine.readings)
            .first;
    Reference added = fine;
    added.own = changed;
    if (!goal_.steady(added)) return {};
    extend_lower(*before, *base);
    const double began = found_.cpu_seconds;
    while (true) {
      if (richest_->point.modes > fine.point.modes) {
        Reference reached = lead(*richest_, *lower_);
        reached.added_by = fine.point;
        reached.readings = corrected(outputs_, lower_->limit(), fine.readings, base->readings);
        for (std::size_t k = 0; k < changed.size(); ++k) reached.own[k] += changed[k];
        if (enough(reached)) return reached;
        keep_nearest(reached, {});
      }
      if (richest_->point.modes >= fine.point.modes + most_modes_beyond || found_.cpu_seconds - began > seconds)
        return {};
      Point point = richest_->point;
      ++point.modes;
      const std::optional<Reference> richer = at(integrations_.on(point));
      if (!richer) return {};
      extend_lower(*richest_, *richer);
    }
  }

  /// Adds a run to the series of the lower rung, which goes on from level to level of the higher one and may be ahead
  /// of it; where the run does not follow its last, it begins anew with those that were made beside levels.
  void extend_lower(const Reference& before, const Reference& run) {
    if (lower_ && richest_->point.modes >= run.point.modes) return;
    if (!lower_ || richest_->point.modes != before.point.modes) {
      lower_.emplace(outputs_, goal_.kinds);
      int first = before.point.modes;
      while (beside_.contains(first - 1)) --first;
      for (; first < before.point.modes; ++first) lower_->add(first, beside_.at(first).readings);
      lower_->add(before.point.modes, before.readings);
    }
    lower_->add(run.point.modes, run.readings);
    richest_ = run;
  }

  /// The run that a series has come to, with the readings that it leads to.
  [[nodiscard]] Reference lead(Reference run, const ModeSeries& series) const {
    run.readings = series.limit();
    run.own = series.own();
    integrations_.add_to(run);
    run.extrapolated = series.extrapolated();
    return run;
  }

  void keep_nearest(const Reference& r, const Readings& coarser) {
    // Where runs part by all they go through the finer one agrees for longer.
    const auto off = [](const Reference& of) { return std::min(relative_error(of.own, of.scales), 1.0); };
    if (found_.nearest && off(r) > off(*found_.nearest)) return;
    found_.nearest = r;
    found_.nearest->coarser = coarser;
  }

  std::optional<Reference> run(const Point& point) {
    const ModelAt& model = model_at_(point);
    if (model.refused()) {
      found_.trouble = model.refusal;
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
    const double whole = integrations_.expected_seconds(point);
    const auto afford = [&](const Walk& so_far) {
      return so_far.seconds <= most_seconds_ && (!goal_.afford || goal_.afford(so_far, whole));
    };
    r.walk = walk(*model.prepared, *make_integrator(registry_, point.integrator, point.tolerance),
                  {keep, afford, control_.interrupted});
    r.scales = scales(outputs_, r.ranges, r.energy);
    found_.cpu_seconds += r.walk.seconds;
    found_.interrupted = r.walk.end == Walk::End::interrupted;
    if (r.walk.end == Walk::End::reached) {
      if (goal_.ended) goal_.ended(r.walk);
      return r;
    }
    found_.unaffordable = r.walk.end == Walk::End::cut;
    if (found_.unaffordable) {
      found_.trouble = fmt::format("{}: at {:.4g} s of the run after {:.2g} s of CPU time, when the time for it ended",
                                   point.text(), r.walk.time, r.walk.seconds);
      return {};
    }
    found_.trouble = fmt::format("{}: ends at {:.4g} s: {}", point.text(), r.walk.time, r.walk.reason);
    return {};
  }

  /// By what part of the outputs' scales a mode more changes them in the lowest rung; nothing where a run does not end.
  [[nodiscard]] std::optional<double> first_change(Point point, const std::string& family) {
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
  ReferenceFound found_;
  std::optional<ModeSeries> lower_;   ///< of the rung below, where more modes are looked at
  std::map<int, Reference> beside_;   ///< runs in that rung with as many modes as levels, by modes
  std::optional<Reference> richest_;  ///< the last of its runs
  LevelIntegrations integrations_;
  double most_seconds_ = std::numeric_limits<double>::infinity();  ///< that a run may cost
  std::map<std::string, Reference> runs_;                          ///< that came to their end, by the point's key
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
  search.find();
  return search.take_found();
}

}  // namespace withy::study
