#include "withy/study/turning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include "withy/core/analysis/between_instants.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/study/felt_states.hpp"
#include "withy/study/narrow_loads.hpp"
#include "withy/study/time_laws.hpp"
#include "withy/study/timed_loads.hpp"
#include "withy/study/turning_ends.hpp"

namespace withy::study {
namespace {

NamedMode named(const CharacteristicMode& mode, std::string name) {
  return {mode.exponent, std::move(name), mode.share, mode.lines, mode.resolved};
}

FloquetModes floquet_of(const TurningForm& form, const Configuration& c) {
  const FloquetAnalysis found = floquet(form.A, form.masses);
  const std::vector<Eigen::Index> free = free_speeds(c.held());
  FloquetModes modes{{}, found.resolution, found.stable()};
  for (const CharacteristicMode& mode : found.modes)
    modes.modes.push_back(
        named(mode, c.layout().speed_names[static_cast<std::size_t>(free[static_cast<std::size_t>(mode.dominant)])]));
  return modes;
}

/// How many waves the pattern of a mode has round the rotor, less those that run backward: shares of kinetic energy.
double waves_of(const MultibladeForm& form, const CharacteristicMode& mode) {
  const std::complex<double> i(0, 1);
  double all = 0, turning = 0;
  for (Eigen::Index k = 0; k < form.masses.size(); ++k) {
    const MultibladeCoordinate& c = form.coordinates[static_cast<std::size_t>(k)];
    const double mass = std::abs(form.masses[k]);
    all += mass * std::norm(mode.shape[k]);
    if (c.kind != MultibladeCoordinate::Kind::cosine) continue;
    const std::complex<double> cosine = mode.shape[k], sine = mode.shape[c.partner];
    turning += 0.5 * mass * c.order * (std::norm(cosine + i * sine) - std::norm(cosine - i * sine));
  }
  return all > 0 ? turning / all : 0.0;
}

/// The first group of equal branches that turns; throws where there is none.
BladeModes blades_of(const TurningForm& form, const Configuration& c, const std::vector<std::string>& names) {
  const std::vector<Blades> groups = equal_branches(c.prepared().model(), names);
  std::string why = "there are no three equal blades on one body; name them: --blades NAME,NAME,NAME";
  for (const Blades& group : groups) {
    try {
      const MultibladeForm seen =
          multiblade_form(form, c.held(), c.layout().speed_names, c.layout().continuous_names, group);
      BladeModes found;
      found.blades = seen.blades.names;
      found.change = seen.A.change();
      found.rate = 2 * std::numbers::pi / seen.A.period();
      found.masses = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(seen.coordinates.size()));
      found.masses.head(seen.masses.size()) = seen.masses.cwiseAbs();
      for (const CharacteristicMode& mode : constant_modes(seen.A.mean(), seen.masses)) {
        found.modes.push_back(named(mode, pattern(seen, mode)));
        found.shapes.push_back(mode.shape);
        found.waves.push_back(waves_of(seen, mode));
      }
      return found;
    } catch (const std::domain_error& e) {
      why = e.what();
    }
  }
  throw std::domain_error(why);
}

/// "0.276 rad (z)", and of coordinates of other units the same.
std::string greatest_displacement(const Turn& turn, const Configuration& c) {
  struct Farthest {
    std::string unit, name;
    double by = 0;
  };
  std::vector<Farthest> all;
  const std::vector<double> greatest = greatest_excursions(turn);
  const auto meet = [&](const Column& coordinate, std::size_t at) {
    const double by = greatest[at];
    const auto same = [&](const Farthest& f) { return f.unit == coordinate.unit; };
    auto found = std::find_if(all.begin(), all.end(), same);
    if (found == all.end()) found = all.insert(all.end(), {coordinate.unit, {}, 0});
    if (by > found->by) found->by = by, found->name = coordinate.name;
  };
  const Layout& layout = c.layout();
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    if (c.held()[slot.speed] && !c.follows(slot.speed)) continue;
    const std::vector<Column> columns = coordinate_columns(c.prepared().model().hinges()[h]);
    for (std::size_t i = 0; i < slot.positions; ++i) meet(columns[i], slot.position + i);
  }
  for (const Slot& slot : layout.bodies)
    for (std::size_t i = 0; i < slot.positions; ++i) meet({layout.speed_names[slot.speed + i], {}}, slot.position + i);
  std::string text;
  for (const Farthest& f : all)
    if (f.by > 0)
      text += fmt::format("{}{:.3g}{}{} ({})", text.empty() ? "" : " and ", f.by, f.unit.empty() ? "" : " ", f.unit,
                          f.name);
  return text;
}

/// The first motion that is another a period later; empty where all repeat.
std::string motion_not_repeating(const Configuration& c, const State& steady, double period) {
  constexpr double rounding = 1e-9;
  for (const MotionNode& node : c.prepared().model().motions()) {
    if (node.motion->locks()) continue;
    double rate = 0, acceleration = 0, change = 0, jerk = 0;
    const auto compare = [&](double share) {
      const MotionPoint now = node.motion->at(steady.time + share * period),
                        later = node.motion->at(steady.time + (1 + share) * period);
      rate = std::max({rate, std::abs(now.rate), std::abs(later.rate)});
      acceleration = std::max({acceleration, std::abs(now.acceleration), std::abs(later.acceleration)});
      change = std::max(change, std::abs(later.rate - now.rate));
      jerk = std::max(jerk, std::abs(later.acceleration - now.acceleration));
    };
    for (int k = 0; k < 11; ++k) compare(k / 11.0);
    for (const double share : in_no_ratio) compare(share);
    // An acceleration counts by what it makes of the rate within the period.
    if (change > rounding * rate || jerk > rounding * (acceleration + rate / period)) return node.name;
  }
  return {};
}

/// The first load whose efforts are others a period later with everything as it was; empty where all repeat.
std::string not_repeating(const Configuration& c, const State& steady, const Turning& turning) {
  constexpr int instants = 11;
  constexpr double rounding = 1e-9;  // of the load's greatest effort: a sine at t and at t + T
  const Model& model = c.prepared().model();
  const EquationsOfMotion& equations = *c.prepared().equations;
  Work work = equations.make_work();
  std::vector<double> now(model.layout().speeds), later(now.size());
  for (std::size_t load = 0; load < model.loads().size(); ++load) {
    double greatest = 0, change = 0;
    for (int k = 0; k < 2 * instants; ++k) {
      const int instant = k / 2;
      State state = carried(model, turning, steady, turning.period * instant / instants);
      if (k % 2 == 1) state = displaced_anyhow(c, std::move(state));
      equations.load_efforts(state.time, state.y, static_cast<int>(load), now, work);
      equations.load_efforts(state.time + turning.period, state.y, static_cast<int>(load), later, work);
      for (std::size_t s = 0; s < now.size(); ++s) {
        greatest = std::max({greatest, std::abs(now[s]), std::abs(later[s])});
        change = std::max(change, std::abs(later[s] - now[s]));
      }
    }
    if (change > rounding * greatest) return model.loads()[load].name;
  }
  return {};
}

/// Why a whole turn is not looked at; empty where it is.
std::string no_whole_turn(const Configuration& c, const State& steady, const Turning& turning) {
  if (turning.period == 0)
    return turning.problem.empty() ? "nothing turns: spin a hinge (--spin), or give the period (--period)"
                                   : turning.problem;
  if (const std::string motion = motion_not_repeating(c, steady, turning.period); !motion.empty())
    return fmt::format(
        "motion '{}' moves otherwise {:.6g} s later, and no turn is like the next: give the period after which "
        "everything repeats (--period)",
        motion, turning.period);
  if (const std::string load = not_repeating(c, steady, turning); !load.empty())
    return fmt::format(
        "load '{}' acts otherwise {:.6g} s later, and no turn is like the next: {}give the period after which "
        "everything repeats (--period)",
        load, turning.period, take_away_text(taken_away_with(c.prepared().scene, {load}), 1, ", or "));
  return {};
}

/// Leaves those of sampled loads of which something free feels what they hold.
void leave_felt(const Configuration& c, const State& steady, const Turning& turning, SampledToCome& to_come) {
  if (to_come.moving.empty() && to_come.timed.empty()) return;
  const std::vector<bool> felt = felt_states(c, steady, turning).sampled;
  const std::vector<LoadSlot> slots = sampled_slots(c.prepared().model());
  const auto unfelt = [&](const std::string& name) {
    for (std::size_t k = 0; k < slots.size(); ++k)
      if (c.prepared().model().loads()[slots[k].load].name == name) return !felt[k];
    return false;
  };
  std::erase_if(to_come.moving, unfelt), std::erase_if(to_come.timed, unfelt);
}

/// Adds what becomes of what loads sample, which `check_turn` takes for held. \param pushed loads push with time
void meet_sampled_loads(const Configuration& c, const State& steady, double period, bool pushed, TurningModes& result) {
  if (!c.sampled()) return;
  SampledToCome to_come = sampled_to_come(c, steady, result.check.turning, pushed, period);
  leave_felt(c, steady, result.check.turning, to_come);
  const auto add = [](std::vector<std::string>& names, const std::vector<std::string>& more) {
    for (const std::string& name : more)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  if (!to_come.moving.empty()) result.check.steady = false;
  if (!to_come.turning.empty()) result.check.constant = false;
  add(result.timed, to_come.timed), add(result.shaking, to_come.shaking);
  result.commanding = std::move(to_come.moving);
  result.sampled = std::move(to_come.turning);
}

/// Loads by which time makes the state, or its small motions, those of an instant.
void meet_timed_loads(const Configuration& c, const State& steady, double period, TurningModes& result) {
  const Turning& turning = result.check.turning;
  bool pushed = false;
  if (period == 0) {
    TimedLoads timed = timed_loads(c, steady, turning, Shaken::growth);
    result.timed = std::move(timed.pushing), result.shaking = std::move(timed.shaking);
    pushed = timed.any_pushes;
  }
  meet_sampled_loads(c, steady, period, pushed, result);
  result.timed = with_the_time(c, steady, turning, result.timed);
  result.shaking = with_the_time(c, steady, turning, result.shaking);
  result.without_timed = taken_away_with(c.prepared().scene, result.timed);
}

/// Whether hinges move at rates or as motions drive them.
bool turns(const Model& model, const Turning& turning) {
  const std::vector<MotionNode>& motions = model.motions();
  return !turning.speeds.empty() ||
         std::any_of(motions.begin(), motions.end(), [](const MotionNode& node) { return !node.motion->locks(); });
}

}  // namespace

TurningWish turning_wish(bool floquet, const std::optional<std::vector<std::string>>& blades, double period) {
  if (!(period >= 0) || !std::isfinite(period))
    throw OptionError("period", fmt::format("got {:g} s; need a number above 0", period));
  TurningWish wish{.floquet = floquet, .blades = blades.has_value(), .names = {}, .period = period};
  if (blades)
    std::copy_if(blades->begin(), blades->end(), std::back_inserter(wish.names),
                 [](const std::string& name) { return name != "auto"; });
  return wish;
}

TurningModes turning_modes(const Configuration& c, const State& steady, const TurningWish& wish) {
  TurningModes result;
  try {
    result.check = check_turn(c.dynamics(), steady, c.held(), wish.period);
    if (wish.period == 0)
      for (const std::size_t m : uneven_motions(c.dynamics(), steady, c.held()))
        result.uneven.push_back(c.prepared().model().motions()[m].name);
    result.narrow = meet_narrow_loads(c, steady, result.check);
    meet_timed_loads(c, steady, wish.period, result);
    if (!result.check.steady) result.passing = moving_freely(c, steady);
    result.turns = turns(c.prepared().model(), result.check.turning);
    if (!wish.floquet && !wish.blades) return result;
    const Turning& turning = result.check.turning;
    result.problem = no_whole_turn(c, steady, turning);
    if (!result.problem.empty()) return result;
    const std::size_t least = instants_of_loads(c, steady, turning);
    const TurningForm form = turning_form(c.dynamics(), steady, c.held(), turning, static_cast<Eigen::Index>(least));
    result.moves = !form.turn.constant;
    result.greatest_displacement = greatest_displacement(form.turn, c);
    if (wish.floquet) result.floquet = floquet_of(form, c);
    if (!wish.blades) return result;
    try {
      result.blades = blades_of(form, c, wish.names);
    } catch (const std::domain_error& e) {
      result.blade_problem = e.what();
    } catch (const std::invalid_argument& e) {
      throw InputError(std::string("--blades: ") + e.what());
    }
  } catch (const std::domain_error& e) {
    result.problem = e.what();
  }
  return result;
}

std::vector<std::string> moving_freely(const Configuration& c, const State& state) {
  std::vector<std::string> hinges;
  for (const Slot& slot : c.layout().hinges) {
    bool moves = false;
    for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i)
      moves = moves || (!c.held()[i] && state.y[c.layout().positions + i] != 0);
    if (moves) hinges.push_back(slot.name);
  }
  return hinges;
}

}  // namespace withy::study
