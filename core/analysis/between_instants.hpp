/// \file
/// A periodic motion between the instants at which it was found: the trigonometric polynomial through them.
#pragma once

#include "withy/core/analysis/turn.hpp"

namespace withy {

/// The motion at some time of the period, and whether it is one there.
struct Between {
  Tangents tangents;
  /// Greatest residual of a free speed, of the terms that make it up and of what a millimetre (a milliradian) of it at
  /// its frequency would need; of rates of states of loads, of what they are made of.
  double left = 0;
};

/// \param share of the period, from the start on \param frequencies [rad/s] of the free speeds
Between between_instants(const TangentDynamics& dynamics, const State& start, const Held& held, const Turning& turning,
                         const Turn& turn, double share, const Eigen::VectorXd& frequencies);

/// How far each position comes from where it is at the start, at any time of the period. Meaningless for coordinates
/// that turn.
std::vector<double> greatest_excursions(const Turn& turn);

}  // namespace withy
