/// \file
/// Steady motions that repeat: hinges turn at constant rates or as motions drive them.
#pragma once

#include <array>
#include <cstddef>
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

}  // namespace withy
