#include "withy/study/turning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

/// The first group of equal branches that turns; throws where there is none.
BladeModes blades_of(const TurningForm& form, const Configuration& c, const std::vector<std::string>& names) {
  const std::vector<Blades> groups = equal_branches(c.prepared().model(), names);
  std::string why = "there are no three equal blades on one body; name them: --blades NAME,NAME,NAME";
  for (const Blades& group : groups) {
    try {
      const MultibladeForm seen = multiblade_form(form, c.held(), c.layout().speed_names, group);
      BladeModes found{seen.blades.names, {}, seen.A.change()};
      for (const CharacteristicMode& mode : constant_modes(seen.A.mean(), seen.masses))
        found.modes.push_back(named(mode, pattern(seen, mode)));
      return found;
    } catch (const std::domain_error& e) {
      why = e.what();
    }
  }
  throw std::domain_error(why);
}

double greatest_displacement(const Turn& turn, const Layout& layout) {
  double greatest = 0;
  const auto of = [&](const Slot& slot) {
    for (const State& state : turn.states) {
      for (std::size_t i = 0; i < slot.positions; ++i)
        greatest = std::max(greatest, std::abs(state.y[slot.position + i] - turn.states[0].y[slot.position + i]));
    }
  };
  for (const Slot& slot : layout.bodies) of(slot);
  return greatest;
}

}  // namespace

TurningModes turning_modes(const Configuration& c, const State& steady, const TurningWish& wish) {
  TurningModes result;
  try {
    result.check = check_turn(c.dynamics(), steady, c.held(), wish.period);
    if (!wish.floquet && !wish.blades) return result;
    const Turning& turning = result.check.turning;
    if (turning.period == 0) {
      result.problem = turning.problem.empty() ? "nothing turns: spin a hinge (--spin), or give the period (--period)"
                                               : turning.problem;
      return result;
    }
    const TurningForm form = turning_form(c.dynamics(), steady, c.held(), turning);
    result.moves = !form.turn.constant;
    result.greatest_displacement = greatest_displacement(form.turn, c.layout());
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

std::string turn_text(const TurnCheck& check) {
  const Turning& turning = check.turning;
  if (!turning.problem.empty())
    return "Whether the equations change as the hinges turn was not looked at: " + turning.problem + ".";
  if (turning.period == 0) return {};
  if (!check.periodic())
    return fmt::format("The hinges turn once in {:.6g} s, and the equations of small motions stay the same.",
                       turning.period);
  return fmt::format(
      "The equations of small motions change with the hinges' angle, over a turn of {:.6g} s by {:.2g} % of their "
      "greatest element{}: these are those of one frozen angle and tell no stability. --floquet looks at the whole "
      "turn, --blades at three or more equal blades from where the rotor does not turn.",
      turning.period, 100 * check.change, check.steady ? "" : ", and this state is balanced at this angle alone");
}

}  // namespace withy::study
