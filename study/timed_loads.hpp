/// \file
/// Loads that change with time themselves.
#pragma once

#include <string>
#include <vector>

#include "withy/core/analysis/turn.hpp"
#include "withy/study/configuration.hpp"

namespace withy::study {

/// Names of loads that are functions of time themselves: a sine, a table, axes that turn.
struct TimedLoads {
  /// Their efforts on what is free change: nothing that is balanced now stays so.
  std::vector<std::string> pushing;
  /// They change the equations of small motions, whether they push at the state or not: growth and decay are those of
  /// one instant. A controller's reference and a force that only time changes leave these equations as they are.
  std::vector<std::string> shaking;
};

/// Looks at times up to the end of the run, with all that turns carried on and everything else as it is: what is as it
/// was from where a hinge has turned to, as axes that turn with a craft, does not change; nor does time change what
/// the angle alone does, as weight.
TimedLoads timed_loads(const Configuration& configuration, const State& state, const Turning& turning);

/// The state with everything that is free displaced and moving, no two alike: what a load makes of it shows in its
/// effort, also where it makes nothing of the state itself.
State displaced_anyhow(const Configuration& configuration, State state);

}  // namespace withy::study
