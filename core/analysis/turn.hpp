/// \file
/// Steady motions that repeat: hinges turn at constant rates or as motions drive them, and the linearization turns with
/// them. What a frozen angle cannot tell is told by a whole turn.
#pragma once

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "withy/core/analysis/steady_state.hpp"

namespace withy {

inline constexpr double full_turn = 2 * std::numbers::pi;  ///< [rad]
/// Shares of a period in no ratio of whole numbers to it or to each other: √2 − 1, √3 − 1 and the golden section. A
/// harmonic may be the same at all of any number of equal intervals, as their multiple is, and not at these too.
inline constexpr std::array<double, 3> in_no_ratio = {std::numbers::sqrt2 - 1, std::numbers::sqrt3 - 1,
                                                      std::numbers::phi - 1};

/// How the hinges of a model move about a state, and how long it takes them to come back.
struct Turning {
  /// Rates of hinges that do not vanish, of those that no motion drives: their coordinates grow with them.
  std::vector<std::size_t> speeds;
  double period = 0;    ///< [s]; 0: nothing moves, or `problem` says why there is none
  std::string problem;  ///< empty where there is a period or nothing moves
};

/// Rates in ratios of whole numbers up to 24 have a common period. \param period [s] known to the caller, as where
/// motions or loads repeat in time; 0: found from the rates alone.
Turning turning(const Model& model, const State& state, double period = 0);

/// `start` carried on for `after` seconds: hinges turn with their rates or as motions drive them, all else is as it
/// was.
State carried(const Model& model, const Turning& turning, const State& start, double after);

/// [s] the period, or where there is no common one a turn of the coordinate that turns slowest; 0: nothing goes round
/// by its rate.
double one_turn(const Model& model, const Turning& turning, const State& state);

/// Motions that do not go on at the rate that they have at the state, of hinges whose motion the free speeds feel:
/// indices into the model's. What is balanced at that instant does not stay so.
std::vector<std::size_t> uneven_motions(const TangentDynamics& dynamics, const State& state, const Held& held);

/// What changes over one turn, from fourteen angles.
struct TurnCheck {
  Turning turning;
  /// Greatest change of an element of A (FirstOrderForm), of the greatest element, coordinates scaled to unit inertia.
  double change = 0;
  bool steady = true;    ///< the free coordinates stay balanced at every angle
  bool constant = true;  ///< masses, stiffnesses and what depends on speeds are the same at every angle, each by itself

  /// Whether the linearization changes as hinges turn. Where the turning has a problem it has no period.
  [[nodiscard]] bool periodic() const { return change > 1e-8 || !steady || !constant; }
};

/// Compares the linearization at eleven equal angles of a turn and at three in no ratio to these, the free coordinates
/// as in `steady`. \throws std::domain_error where the mass matrix of the free speeds is singular.
TurnCheck check_turn(const TangentDynamics& dynamics, const State& steady, const Held& held, double period = 0);

/// A periodic motion at equal intervals of its period, with its linearization there.
struct Turn {
  double period = 0;             ///< [s]
  std::vector<State> states;     ///< an odd count; the first at the start
  std::vector<Tangents> points;  ///< the derivatives there, at the accelerations of the motion
  bool constant = true;          ///< the free coordinates do not move
  int iterations = 0;            ///< of Newton's method
};

/// The motion of period `turning.period` that the free coordinates follow: constant where that balances them at every
/// angle; else the trigonometric polynomial through `count` (odd) instants that satisfies the equations of motion there
/// (collocation), by Newton's method with the exact derivatives from `start` on.
/// \throws std::domain_error with the reason where there is none: nothing converges, a free hinge turns, or free
/// rotations are quaternions.
Turn find_turn(const TangentDynamics& dynamics, const State& start, const Held& held, const Turning& turning,
               Eigen::Index count);

}  // namespace withy
