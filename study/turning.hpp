/// \file
/// Small motions about a state that turns: whether their equations are periodic, and then what a whole turn says of
/// them.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/analysis/multiblade.hpp"
#include "withy/study/configuration.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {

/// A motion e^{λt} p(t) by the names of what moves.
struct NamedMode {
  std::complex<double> exponent;  ///< [1/s]
  std::string dominated_by;       ///< a speed, or of equal blades a pattern, as "blade1.bending_z[1] forward"
  double share = 1;               ///< of the strongest harmonic
  std::vector<std::pair<double, double>> lines;  ///< frequencies [rad/s] that are seen, and shares, strongest first
  bool resolved = true;  ///< false: it decays in a turn to what rounding leaves, its exponent is a bound
};

/// Characteristic exponents, most unstable first.
struct FloquetModes {
  std::vector<NamedMode> modes;
  double resolution = 0;  ///< [1/s] of real parts
  bool stable = false;
};

/// Equal blades seen from where the rotor does not turn, in the order of |λ|.
struct BladeModes {
  std::vector<std::string> blades;  ///< in their order
  std::vector<NamedMode> modes;     ///< of the equations averaged over a turn
  /// Of each mode: displacements in multi-blade coordinates, then states of loads; what dominates is 1.
  std::vector<Eigen::VectorXcd> shapes;
  Eigen::VectorXd masses;  ///< that weigh shapes; zero for the states of loads
  double rate = 0;         ///< of the rotor [rad/s]
  /// Of each mode the waves of its pattern round the rotor, weighed by kinetic energy; below 0 where it runs backward.
  std::vector<double> waves;
  std::vector<std::size_t> branches;  ///< along a sweep, of each mode; empty where nobody followed them
  double change = 0;                  ///< what the average leaves out: greatest change of an element, of the greatest
};

struct TurningModes {
  TurnCheck check;
  bool moves = false;  ///< the free coordinates follow a periodic motion, and are not at rest in the turning frames
  std::string greatest_displacement;  ///< what moves farthest from the state at the start: of each unit one coordinate
  std::optional<FloquetModes> floquet;
  std::optional<BladeModes> blades;
  /// Hinges that move and that nothing holds at their rates, where this balances at one angle alone: the state is an
  /// instant of a motion, and none that stays.
  std::vector<std::string> passing;
  /// Motions that do not go on at the rate they have, of hinges that what is free feels, where no period is given: an
  /// instant likewise.
  std::vector<std::string> uneven;
  /// Loads that are functions of time themselves, where what is free feels it and no period is given: an instant
  /// likewise. What measures such a load acts with time, and is not named.
  std::vector<std::string> timed;
  /// What to take away for these to go, that the rest is a scene (taken_away_with); empty: nothing.
  std::vector<std::string> without_timed;
  /// Those that change the equations of small motions of what is free, where no period is given: growth and decay are
  /// of one instant.
  std::vector<std::string> shaking;
  /// Sampled loads whose commands at the state change as hinges turn, so that it is balanced at one angle alone.
  std::vector<std::string> commanding;
  /// Sampled loads of which what they make of small motions does.
  std::vector<std::string> sampled;
  /// A load that acts in a narrow part of a turn alone, where all else is constant; empty: there is none.
  std::string narrow;
  bool turns = false;         ///< hinges move at rates or as motions drive them
  std::string problem;        ///< why there are no exponents; empty where there are
  std::string blade_problem;  ///< why no blades are seen; empty where they are, or nobody asked
};

struct TurningWish {
  bool floquet = false;
  bool blades = false;             ///< multi-blade transform
  std::vector<std::string> names;  ///< of the blades; empty: found
  double period = 0;               ///< [s]; 0: found from the rates
};

/// \param blades names of equal blades, `auto` for those that are found; nothing: they are not asked for
/// \param period [s]; 0: found from the rates \throws OptionError where that is negative or not finite
TurningWish turning_wish(bool floquet, const std::optional<std::vector<std::string>>& blades, double period);

/// What a turn says about small motions about a steady state of the configuration.
TurningModes turning_modes(const Configuration& configuration, const State& steady, const TurningWish& wish);

/// One sentence: that the equations of small motions are constant over a turn, or how they change, or why that is not
/// known; empty where nothing turns and no load changes them.
std::string turn_text(const TurningModes& turn);

/// Hinges that are not held and whose rates do not vanish.
std::vector<std::string> moving_freely(const Configuration& configuration, const State& state);
/// That a state does not stay with motions that do not go on at the rates they have, and what to do.
std::string uneven_text(const std::vector<std::string>& motions);
/// That a state does not stay with loads that change with time themselves (TurningModes::timed), and what to do.
std::string timed_text(const TurningModes& turn);
/// "take it away with what measures it (--set loads.a=null --set loads.b=null)" and what is behind it; empty where
/// nothing is to be taken away. \param meant of the loads, how many were to go: the others measure them
std::string take_away_text(const std::vector<std::string>& loads, std::size_t meant, const char* behind);
/// "the load 'base' changes the equations of small motions with time".
std::string shaking_text(const std::vector<std::string>& loads);
/// That a state does not stay with sampled loads whose commands change as hinges turn.
std::string commanding_text(const std::vector<std::string>& loads);
/// That a state with such hinges does not stay, and what to do.
std::string passing_text(const std::vector<std::string>& hinges);

}  // namespace withy::study
