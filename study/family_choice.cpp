#include "withy/study/family_choice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "withy/study/accuracy.hpp"

namespace withy::study {
namespace {

/// Times what the first family has: less is another one's merit, more may be chance.
constexpr double clearly_less = 0.5;
/// Times an evaluation with the first family in the highest rung: where another one's takes longer, levels there stay
/// with the first. What that rung adds hardly depends on the functions.
constexpr double dear_evaluation = 2;
/// Times the modes of one look at families: those of the next.
constexpr double until_next_look = 1.5;
/// Of the time that is left: what the richest run of each family may be expected to cost, and what it may cost.
constexpr double family_look_share = 0.075, longest_look = 0.15;

}  // namespace

void FamilyChoice::begin(const Point& first) {
  family_ = first.family;
  if (goal_.families.empty() || first.modes == 0) return;
  std::optional<double> least = first_change(first, first.family);
  for (const std::string& family : goal_.families) {
    if (family == first.family || dear(first, family)) continue;
    const std::optional<double> change = first_change(first, family);
    if (!change || (least && *change > clearly_less * *least)) continue;
    least = change;
    family_ = family;
  }
}

/// Whether functions cost much more in the highest rung, as those whose strains have kinks do in `exact`.
bool FamilyChoice::dear(Point first, const std::string& family) {
  first.formulation = reference_formulations(registry_).front();
  Point other = first;
  other.family = family;
  const ModelAt &one = model_at_(first), &another = model_at_(other);
  return !one.refused() && !another.refused() && another.seconds > dear_evaluation * one.seconds;
}

/// Whether modes have grown by half since the last look, and another would not cost much.
bool FamilyChoice::worth_a_look(const Reference& richest) {
  if (goal_.families.empty() || goal_.kinds > 1 || richest.point.modes < next_look_) return false;
  next_look_ = static_cast<int>(std::ceil(until_next_look * richest.point.modes));
  const double cost =
      richest.walk.seconds * model_at_(in_lowest(richest.point)).seconds / model_at_(richest.point).seconds;
  return !goal_.left || cost <= family_look_share * goal_.left();
}

bool FamilyChoice::look(const Reference& richest) {
  if (!worth_a_look(richest)) return false;
  const std::string before = family_;
  std::vector<std::string> families{before, goal_.first.family};
  families.insert(families.end(), goal_.families.begin(), goal_.families.end());
  std::optional<double> least;
  for (auto family = families.begin(); family != families.end(); ++family) {
    if (std::find(families.begin(), family, *family) != family) continue;
    const std::optional<double> known = known_in(*family, richest.point);
    if (!known && !least) return false;
    if (!known || (least && *known > clearly_less * *least)) continue;
    least = known;
    family_ = *family;
  }
  return family_ != before && may_leave(before);
}

/// Whether the family just chosen takes the place of one: a family that was left comes back where two looks in a row
/// say so. Steps of a series may be as large as those before them for some modes, and then shrink at once.
bool FamilyChoice::may_leave(const std::string& before) {
  const bool back = std::find(left_.begin(), left_.end(), family_) != left_.end();
  if (back && std::exchange(coming_back_, family_) != family_) {
    family_ = before;
    return false;
  }
  left_.push_back(before);
  return true;
}

/// By what part of the outputs' scales a mode more changes them; nothing where a run does not end.
std::optional<double> FamilyChoice::first_change(Point point, const std::string& family) {
  point.family = family;
  const std::optional<Reference> few = run(point), more = few ? run(steps_.finer(point)) : few;
  if (!more) return {};
  return relative_error(distances(outputs_, more->readings, few->readings).first, more->scales);
}

/// How well the limit of a family's series is known by runs with as many modes as one or down to half of them; nothing
/// where one does not end, or costs much of the time that is left.
std::optional<double> FamilyChoice::known_in(const std::string& family, Point point) {
  std::optional<Reference> last;
  const std::vector<int> all = steps_.upper_half(point.modes);
  for (const int modes : all) {
    point.modes = modes, point.family = family;
    last = goal_.left ? run(runs_.integrations().on(point), longest_look * goal_.left())
                      : run(runs_.integrations().on(point));
    if (!last) return {};
  }
  return relative_error(series_.series(family, all.front()).own(), last->scales);
}

Point FamilyChoice::in_lowest(Point point) const {
  point.formulation = reference_formulations(registry_).back();
  return point;
}

std::optional<Reference> FamilyChoice::run(Point point, double seconds) {
  point = in_lowest(std::move(point));
  std::optional<Reference> made = std::isinf(seconds) ? runs_.at(point) : runs_.at(point, seconds);
  if (made) series_.add(*made);
  return made;
}

}  // namespace withy::study
