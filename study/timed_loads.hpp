/// \file
/// Loads that change with time themselves.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "withy/core/analysis/adaptive_difference.hpp"
#include "withy/core/analysis/turn.hpp"
#include "withy/study/configuration.hpp"

namespace withy::study {

/// Names of loads that are functions of time themselves: a sine, a table, axes that turn.
struct TimedLoads {
  /// Their efforts on what is free change, or the rates of those of their own states that what is free feels: nothing
  /// that is balanced now stays so.
  std::vector<std::string> pushing;
  bool any_pushes = false;  ///< also where nothing free feels it
  /// They change the equations of small motions, whether they push at the state or not: growth and decay are those of
  /// one instant. A controller's reference and a force that only time changes leave these equations as they are, and so
  /// does what changes of the square of a displacement. Each load is held against itself, whatever else is stiff.
  std::vector<std::string> shaking;
};

/// Of which equations loads are named that change them.
enum class Shaken {
  all,    ///< of all that small motions have: what goes in, and what is seen, may be of one instant
  growth  ///< but for what states that nothing free feels take from others, which leaves growth and decay as they are
};

/// Looks at times up to the end of the run, with all that turns carried on and everything else as it is: what is as it
/// was from where a hinge has turned to, as axes that turn with a craft, does not change; nor does time change what
/// the angle alone does, as weight.
TimedLoads timed_loads(const Configuration& configuration, const State& state, const Turning& turning, Shaken shaken);

/// Times after a state [s] at which what may change with time is looked at: near ones, for what is fast, the longest
/// first, and ones all over the rest of the run, in no ratio to each other, for what begins late or is the same after a
/// period.
std::vector<double> times_after(const Configuration& configuration, const State& state);
/// Of these (indices, the end excluded) those at which small motions are looked at of a load that pushes: far from
/// where a law is by then, a controller is at its limit.
inline constexpr std::size_t first_soon = 7, end_of_soon = 20;

/// Derivatives of what is read off states are others where they change by more than this share of themselves.
inline constexpr double differenced_equations = 1e-6;
/// Where a load pushes with time, as a controller whose reference moves: what its limit, which is smooth, makes of that
/// by then is no change of the law with time.
inline constexpr double pushed_equations = 1e-4;

/// The state with everything that is free displaced and moving, no two alike: what a load makes of it shows in its
/// effort, also where it makes nothing of the state itself. Loads' own states are displaced too. \param times one: by 5
/// to 15 mrad or mm, and as much a second; states of loads by half a percent to 1.5 percent of themselves and of one
State displaced_anyhow(const Configuration& configuration, State state, double times = 1);

/// Derivatives of what is read off states, by `times` of displaced_anyhow at none.
Differenced slopes_anyhow(const Configuration& configuration, const State& state,
                          const std::function<Eigen::VectorXd(const State&)>& reading);

/// By how much derivatives are others, one a number, beyond what differences leave open: zero where that is all.
Eigen::VectorXd other_slopes(const Differenced& here, const Differenced& there);
/// Of derivatives of efforts, and of rates of states, one each: whether it is by more than a share of itself, or of a
/// size [N m, N] a displacement where that is greater, and by more than rounding of the greatest of them.
Eigen::Array<bool, Eigen::Dynamic, 1> other_equations(const Differenced& here, const Differenced& there, double share,
                                                      const Eigen::VectorXd& sizes);

}  // namespace withy::study
