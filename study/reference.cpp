#include "withy/study/reference.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/study/accuracy.hpp"
#include "withy/study/family_choice.hpp"
#include "withy/study/reference_runs.hpp"

namespace withy::study {
namespace {

/// Share of an evaluation's cost below which more modes are looked at in a lower rung at once.
constexpr double much_cheaper = 0.7;
/// Modes beyond the last level of the higher rung that are looked at in the lower one before it has its next level.
constexpr int most_modes_beyond = 8;
/// Modes that are looked at in any case: no motion needs more.
constexpr int most_modes = 48;
/// Times the cost of the last level of the higher rung: what more modes in the lower one may cost before the higher one
/// has its next level, which costs about that.
constexpr double next_level = 2;
/// Of what a sum may be off by, what the higher rung adds has changed by: with less the next of its levels would not
/// help.
constexpr double little_of_all = 0.25;
/// Of the time that is left: what the last level may have cost where levels begin anew in another family.
constexpr double level_share = 0.1, longest_level = 0.2;
constexpr double no_limit = std::numeric_limits<double>::infinity();

class ReferenceSearch {
 public:
  ReferenceSearch(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                  const Outputs& outputs, const ReferenceGoal& goal, const Control& control)
      : model_at_(model_at),
        registry_(registry),
        outputs_(outputs),
        goal_(goal),
        runs_(model_at, registry, outputs, goal, control),
        steps_(goal, runs_.integrations()),
        families_(model_at, registry, outputs, goal, runs_, steps_) {}

  /// Level after level, until one is known well enough or nothing more can be had.
  void find() {
    Point first = goal_.first;
    if (goal_.integration && first.modes > 0) runs_.measure_integrations();
    first = runs_.integrations().on(first);
    if (!found().interrupted) families_.begin(first), first.family = families_.family();
    coarse_ = found().interrupted ? std::nullopt : begin(first);
    if (!coarse_) return;
    series_.emplace(outputs_, goal_.kinds).add(coarse_->point.modes, coarse_->readings);
    found().trouble.clear();
    found().unaffordable = false;
    for (int level = 0; level < goal_.levels && go_on(); ++level) {
      if (found().reference || found().interrupted) return;
    }
    if (found().reference || !before_ || found().interrupted || !lower_affordable(*coarse_, *before_)) return;
    const std::string trouble = found().trouble;
    found().reference = add_to_lower(no_limit);
    if (!found().reference && found().trouble.empty()) found().trouble = trouble;
  }

  ReferenceFound take_found() { return runs_.take_found(); }

 private:
  /// The next level, and more modes in the lower rung where that is worth it. False where there is no finer one.
  bool go_on() {
    const Point next = steps_.finer(coarse_->point);
    // The same run again would agree with itself.
    if (next.key() == coarse_->point.key()) return false;
    std::optional<Reference> fine = runs_.at(next);
    if (!fine) return false;
    series_->add(next.modes, fine->readings);
    if (series_->size() > static_cast<std::size_t>(goal_.kinds) && known_by(*fine, *series_)) return true;
    before_ = std::move(coarse_), coarse_ = std::move(fine);
    if (much_cheaper_below(coarse_->point) && lower_affordable(*coarse_, *before_))
      found().reference = add_to_lower(next_level * coarse_->walk.seconds);
    if (found().reference || found().interrupted || !families_.look(*coarse_)) return true;
    begin_in_family();
    return true;
  }

  /// Whether a level is known well enough, which is the end of the search; what comes near it is kept.
  bool known_by(const Reference& level, const ModeSeries& series) {
    Reference reached = lead(level, series);
    add_third_order(reached, level);
    if (!settled(reached)) {
      keep_nearest(reached, series.limit_before());
      return false;
    }
    found().reference = std::move(reached);
    return true;
  }

  /// Levels anew in the family that is known better, with as many modes as the last; what a higher rung adds is left in
  /// the family so far where that costs much of the time that is left.
  void begin_in_family() {
    const double left = goal_.left ? goal_.left() : no_limit;
    if (coarse_->walk.seconds > level_share * left) return;
    Point there = coarse_->point;
    there.family = families_.family();
    const ModelAt &now = model_at_(coarse_->point), &then = model_at_(there);
    if (then.refused() || coarse_->walk.seconds * then.seconds > longest_level * left * now.seconds) return;
    ModeSeries anew(outputs_, goal_.kinds);
    std::optional<Reference> coarse, fine;
    for (const int modes : steps_.upper_half(coarse_->point.modes)) {
      Point point = coarse_->point;
      point.modes = modes, point.family = families_.family();
      coarse = std::move(fine);
      fine = runs_.at(runs_.integrations().on(point), longest_level * left);
      if (!fine) return;
      anew.add(modes, fine->readings);
    }
    coarse_ = std::move(fine), before_ = std::move(coarse);
    series_.emplace(std::move(anew));
    static_cast<void>(known_by(*coarse_, *series_));
  }

  /// The coarsest level, in the richest formulation that comes to the end.
  std::optional<Reference> begin(Point point) {
    for (const std::string& formulation : reference_formulations(registry_)) {
      point.formulation = formulation;
      if (auto reference = runs_.at(point)) return reference;
      if (found().interrupted) break;
    }
    return {};
  }

  [[nodiscard]] bool enough(const Reference& r) const { return !goal_.enough || goal_.enough(r); }
  /// The same with what integration adds to as many modes; where that is too much a tighter run is kept.
  bool settled(Reference& r) {
    tighter_.reset();
    if (!enough(r)) return false;
    tighter_ = runs_.confirm(r, [&](const Reference& confirmed) { return enough(confirmed); });
    return !tighter_;
  }

  /// The next run of the series of the lower rung. Where one with more modes would cost much of the time that is left,
  /// one half a step before the last comes first: of two shorter steps more may be known, for less.
  [[nodiscard]] Point next_in_lower(const Point& richest) const {
    Point next = steps_.finer(richest), between = steps_.between(richest);
    const bool enough_steps = families_.series().has(richest.family, between.modes);
    return enough_steps || steps_.costs_little(next) ? next : between;
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
    return (runs_.has(*low) ? more : base + more) <= goal_.left();
  }

  /// More modes in the rung below, with what the higher one adds at the last level. Nothing where there is no rung
  /// below, a run does not end, what is added changes too much or the modes cost more; the richest is then kept as
  /// nearest.
  /// \param seconds of CPU time that more modes may cost where what is added has a part in what the sum may be off by:
  /// the run under way is ended
  std::optional<Reference> add_to_lower(double seconds) {
    const Reference &fine = *coarse_, &coarse = *before_;
    const std::optional<Point> low = below(fine.point);
    if (!low || fine.point.modes == 0 || !goal_.steady) return {};
    const auto before = families_.run(*below(coarse.point));
    if (!before) return {};
    const auto base = families_.run(*low);
    if (!base) return {};
    // What the coarser level would have added.
    Reference added = fine;
    added.own =
        distances(outputs_, corrected(outputs_, base->readings, coarse.readings, before->readings), fine.readings)
            .first;
    Reference by_a_mode = added;
    for (double& d : by_a_mode.own) d /= fine.point.modes - coarse.point.modes;
    if (!goal_.steady(by_a_mode)) return {};
    const double began = found().cpu_seconds;
    bool little = false;
    while (true) {
      const Reference richest = *families_.series().richest(families_.family());
      if (richest.point.modes > fine.point.modes) {
        Reference reached = with_added(richest, added, *base);
        if (settled(reached)) return reached;
        keep_nearest(reached, {});
        if (tighter_) {
          families_.add(*std::exchange(tighter_, std::nullopt));
          continue;
        }
        if (families_.look(richest)) continue;
        little = relative_error(added.own, added.scales) < little_of_all * relative_error(reached.own, reached.scales);
      }
      const bool beyond = richest.point.modes >= fine.point.modes + most_modes_beyond;
      if (richest.point.modes >= most_modes || (!little && (beyond || found().cpu_seconds - began > seconds)))
        return {};
      if (!families_.run(next_in_lower(richest.point))) return {};
    }
  }

  /// Where the series of the lower rung leads to, with what a level of the higher one adds to the run with as many
  /// modes.
  [[nodiscard]] Reference with_added(const Reference& richest, const Reference& level, const Reference& base) const {
    const ModeSeries series = families_.series().series(richest.point.family);
    Reference reached = lead(richest, series);
    reached.added_by = level.point;
    reached.readings = corrected(outputs_, series.limit(), level.readings, base.readings);
    for (std::size_t k = 0; k < level.own.size(); ++k) reached.own[k] += level.own[k];
    add_third_order(reached, level);
    return reached;
  }

  /// What the kinematics of the highest rung that has a part in a reference lacks.
  static void add_third_order(Reference& reached, const Reference& highest) {
    reached.bend = highest.bend;
    reached.bent = highest.bent;
    reached.third_order = highest.third_order;
    for (std::size_t k = 0; k < reached.own.size(); ++k) reached.own[k] += highest.third_order * reached.scales[k];
  }

  /// The run that a series has come to, with the readings that it leads to.
  [[nodiscard]] Reference lead(Reference run, const ModeSeries& series) const {
    run.readings = series.limit();
    run.own = series.own();
    runs_.integrations().add_to(run);
    run.extrapolated = series.extrapolated();
    return run;
  }

  void keep_nearest(const Reference& r, const Readings& coarser) {
    // Where runs part by all they go through the finer one agrees for longer.
    const auto off = [](const Reference& of) { return std::min(relative_error(of.own, of.scales), 1.0); };
    if (found().nearest && off(r) > off(*found().nearest)) return;
    found().nearest = r;
    found().nearest->coarser = coarser;
  }

  /// The same in the next rung that truncates nothing.
  [[nodiscard]] std::optional<Point> below(Point point) const {
    const std::vector<std::string> all = reference_formulations(registry_);
    const auto own = std::find(all.begin(), all.end(), point.formulation);
    if (own == all.end() || own + 1 == all.end()) return {};
    point.formulation = *(own + 1);
    return point;
  }

  ReferenceFound& found() { return runs_.found(); }
  [[nodiscard]] const ReferenceFound& found() const { return runs_.found(); }

  const std::function<const ModelAt&(const Point&)>& model_at_;
  Registry& registry_;
  const Outputs& outputs_;
  const ReferenceGoal& goal_;
  ReferenceRuns runs_;
  std::optional<Reference> before_, coarse_;  ///< the last two levels
  std::optional<ModeSeries> series_;          ///< of levels
  std::optional<Reference> tighter_;          ///< of what was not settled for its integration alone, in the lowest rung
  LevelSteps steps_;
  FamilyChoice families_;  ///< with the runs of the lowest rung, where more modes are looked at
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
