/// \file
/// The linear system with periodic coefficients that small motions about a periodic motion follow.
#pragma once

#include "withy/core/analysis/floquet.hpp"
#include "withy/core/analysis/turn.hpp"

namespace withy {

/// A of small motions about a periodic motion, of the free speeds, and the inertias M_ii of their displacements.
struct TurningForm {
  PeriodicMatrix A;  ///< of displacements, rates and the continuous states of loads, these in units that balance them
  Eigen::VectorXd masses;
  Turn turn;
};

/// With as many instants of the turn as it takes for A and the motion to be between them, at instants in no ratio of
/// whole numbers to these, what the trigonometric polynomial through them says: 15 to 1023. What it misses is A's
/// `unseen`. \param least of the instants, 15, 31, … 1023, where it is known that fewer do not show what acts
/// \throws std::domain_error as find_turn, and where the greatest count does not show them
TurningForm turning_form(const TangentDynamics& dynamics, const State& start, const Held& held, const Turning& turning,
                         Eigen::Index least = 15);

}  // namespace withy
