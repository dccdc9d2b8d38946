/// \file
/// Where forces take a mechanism that rests far from what balances it.
#pragma once

#include <optional>

#include "withy/core/analysis/steady_state.hpp"

namespace withy {

struct Relaxation {
  State state;    ///< near a balance towards which small displacements go back
  int steps = 0;  ///< linear problems solved
};

/// Whether nothing pushes the free coordinates on from a balance once they are displaced: the symmetric part of K has
/// no negative eigenvalue but for rounding.
bool lasts(const TangentDynamics& dynamics, const State& state, const Held& held);

/// Follows the forces r of the free coordinates from a state: δ' = −r in units in which M_ii is 1, by linearly implicit
/// Euler steps that grow as r becomes less, which makes them Newton's in the end (pseudo-transient continuation, Kelley
/// & Keyes, SIAM J. Numer. Anal. 35, 1998), and ten times after each that changes r as K foretells. They are kept so
/// short that no hinge turns by more than 0.3 rad, and that 1/step + K is positive where K, its symmetric part, is not:
/// a step goes down in a potential. Rates stay those of the state, as in find_steady_state; states of loads stay.
/// Nothing where a hundred steps do not lead to a balance, a force is not finite, or over 300 coordinates are free.
/// \param start in which no mode moves
std::optional<Relaxation> relaxed(const TangentDynamics& dynamics, const State& start, const Held& held);

}  // namespace withy
