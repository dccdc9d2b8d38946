/// \file
/// States that stay as they are: static equilibrium, and steady spin with hinges held at constant rates.
#pragma once

#include <vector>

#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy {

/// Which generalized speeds are held: their coordinates follow the rates that the state gives them, by whatever effort
/// that takes. One a speed. Hinges that a motion drives are to be among them.
using Held = std::vector<bool>;

/// Indices of the speeds that are not held.
std::vector<Eigen::Index> free_speeds(const Held& held);

/// Accelerations at a state: of held speeds zero or as a motion prescribes, of the free ones those that follow.
/// \throws std::domain_error where the mass matrix of the free speeds is singular.
Eigen::VectorXd accelerations(const TangentDynamics& dynamics, const State& state, const Held& held);

struct SteadyState {
  State state;  ///< the steady state, or the best found
  bool converged = false;
  int iterations = 0;   ///< of Newton's method
  int relaxations = 0;  ///< steps along the forces before these
  /// [rad] by which a hinge is turned from the start where the forces lead nowhere, and what Newton's method ends at by
  /// itself stands: any balance of many. Else 0.
  double strayed = 0;
  Eigen::VectorXd efforts;  ///< [N m, N] that held speeds need beside the loads; of the free ones what is left over
  Eigen::VectorXd rates;    ///< of the continuous states of loads: what is left over
  Eigen::VectorXd renewed;  ///< of what sampled loads hold: what a sample still changes; empty where none are looked at
  Eigen::VectorXd step;     ///< what Newton's method would still change, one a speed; it measures the error
  /// Where the tangent stiffness is singular a direction that nothing holds, along which what is left over pushes: unit
  /// vector of displacements. Else empty.
  Eigen::VectorXd neutral;
};

/// Displaces the free coordinates, and changes the continuous states of loads, until accelerations and the rates of
/// these states vanish, with the accelerations that motions prescribe, all
/// speeds constant: those of modes zero, those of hinges as `start` has them. Newton's method with exact derivatives,
/// its steps shortened until the next simplified step is smaller (the affine-invariant test of Deuflhard 2004,
/// section 3.3); where the stiffness is singular, the shortest step in the least-squares sense, so that neutral
/// coordinates stay where they are. Where that leads nowhere, turns a hinge by half a turn or more, or by more than 0.5
/// rad to a balance that does not last, the forces are followed first (`relaxed`): to where a damped mechanism would
/// come to rest. Where that leads nowhere, what Newton's method found stands.
SteadyState find_steady_state(const TangentDynamics& dynamics, const State& start, const Held& held);

/// Whether a state in which no mode moves is such a state: what Newton's method would still change is less than a
/// billionth of the coordinates, since data are seldom typed more exactly.
bool is_steady_state(const TangentDynamics& dynamics, const State& state, const Held& held);

/// Whether what the free speeds feel begins to change as the hinges turn with the state's rates: it does where gravity
/// or a load turns in the rotating frame, but where these are at their greatest; check_turn looks at a whole turn. And
/// whether it is the same further along where hinges slide.
bool stays_steady(const TangentDynamics& dynamics, const Tangents& tangents, const State& state, const Held& held);

}  // namespace withy
