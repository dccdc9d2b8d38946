#include "withy/study/equilibrium.hpp"

#include "withy/core/analysis/sliding.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/study/at_limits.hpp"
#include "withy/study/bent.hpp"
#include "withy/study/sampled_steady.hpp"
#include "withy/study/turning.hpp"

namespace withy::study {

Equilibrium find_equilibrium(const Configuration& c, const Holding& holding, Registry& registry) {
  Equilibrium found;
  found.steady = steady_state_of(c);
  const State& state = found.steady.state;
  const Tangents tangents = c.dynamics().tangents(state.time, state.y, c.dynamics().steady_accelerations(state.time));
  found.derivatives = derivatives_text(tangents);
  // The rate of change at this angle may vanish where weight is at its greatest: a turn tells.
  const TurningModes turn = turning_modes(c, state, {});
  found.stays = stays_steady(c.dynamics(), tangents, state, c.held()) && turn.check.steady && turn.uneven.empty() &&
                turn.timed.empty();
  found.problem = no_steady_state(c, found.steady);
  for (const Tip& tip : measured_ends(c.prepared().model())) {
    if (tip.flexible)
      found.deflections.emplace_back(tip.body + '.' + tip.station, deflection(*c.prepared().equations, state.y, tip));
  }
  if (found.steady.converged) found.bent = bent_text(c, state), found.limited = at_limits(c, state);
  found.against = deflections_against_next(c, found.steady, holding, registry);
  if (found.stays) {
    Configuration about = c;
    about.set_state(state);
    if (found.steady.converged) found.stability = stability_of(about);
    return found;
  }
  found.passing = moving_freely(c, state);
  found.instant = !found.passing.empty() || !turn.uneven.empty() || !turn.timed.empty();
  found.changing =
      !found.passing.empty()     ? passing_text(found.passing)
      : !turn.uneven.empty()     ? uneven_text(turn.uneven)
      : !turn.timed.empty()      ? timed_text(turn)
      : !turn.commanding.empty() ? commanding_text(turn.commanding)
      : !turn.narrow.empty()
          ? "The load '" + turn.narrow + "' acts in a narrow part of a turn: this state is steady beside it alone."
      : slides(c.dynamics(), state)
          ? "Hinges slide and what acts on the free coordinates changes on the way: this state is steady "
            "at this place alone."
          : "The hinges turn and what acts on the free coordinates turns with them (gravity in the plane "
            "of rotation, as a rule): this state is steady at this angle alone.";
  return found;
}

}  // namespace withy::study
