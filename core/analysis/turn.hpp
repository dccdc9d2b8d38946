/// \file
/// What a whole turn tells that a frozen angle cannot: whether the linearization changes as hinges turn, and the
/// periodic motion that the free coordinates follow.
#pragma once

#include <vector>

#include "withy/core/analysis/turning.hpp"

namespace withy {

/// Below it [rad, m] a displacement is nothing, whatever its size beside others.
inline constexpr double least_displacement = 1e-3;

/// What the rates of the continuous states of loads are made of: the greatest of their terms by states and speeds, of
/// what the least displacement does to them, and of the rates themselves. There is one such state or more.
double terms_of_rates(const Tangents& tangents, const State& state, const Layout& layout, const Eigen::VectorXd& rates);

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
