/// \file
/// What accuracy rounding leaves the accelerations, and which direction of the mass matrix takes the rest: nearly
/// massless ones are found, named and valued before a run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

/// M with every coordinate in the unit in which its own inertia M_ii is one: of all units those whose κ is at most n
/// times the smallest there is (van der Sluis, Numer. Math. 14 (1969) 14), so that it does not depend on what angles
/// and deflections are measured in. Prescribed speeds do not take part.
struct AttainableAccuracy {
  double condition = 0;  ///< κ of M so scaled; infinite where a coordinate has no inertia of its own
  double accuracy = 0;  ///< κ·2⁻⁵²: a bound of what rounding may do; recursions stay far below it on long chains
  /// Unit vector of the scaled coordinates, all speeds, along which M acts least, and how much of the coordinates' own
  /// inertia is left along it, > 0 where M is positive definite.
  std::vector<double> weakest;
  double share = 0;
};

AttainableAccuracy attainable_accuracy(const DenseSystem& system);

/// What rounding does to the accelerations at a state.
struct RoundingError {
  double relative = 0;    ///< greatest error of a coordinate over the greatest acceleration, by their own inertia
  std::size_t speed = 0;  ///< where it is greatest
};

/// Estimated by taking accelerations to efforts and back, by the two recursions that a run uses: the first multiplies
/// with M and the second solves, so that what comes back lacks what rounding takes in this tree, of whatever size.
/// The accelerations are those at the state and, where there are none or `any`, others of equal size in all
/// coordinates. Where the equations take no efforts it is κ·2⁻⁵², of at most `largest_examined` speeds. Infinite where
/// M is singular, and κ·2⁻⁵² where that is 1 or more in a model of at most `largest_examined` speeds: M is singular to
/// rounding. What making the tree's constants has lost already is not seen: of a hinged beam with a tip of its own mass
/// the error is 30 times the estimate, a tenth of κ·2⁻⁵². In time proportional to the number of speeds beyond those.
enum class Probing { these, any };
RoundingError rounding_error(const Model& model, const EquationsOfMotion& equations, const State& state,
                             Probing probing = Probing::these);

/// A direction of the modes that moves nearly no mass and therefore vibrates fast.
struct MasslessDirection {
  double share = 0;      ///< of the coordinates' own inertia that is left along it
  double frequency = 0;  ///< [rad/s], √(vᵀKv/vᵀMv); 0 where nothing holds it elastically
  std::string owners;    ///< whose coordinates make it up: "62 % modes of 'link1' (most of all link1.bending_y[2])"
};

/// Directions along which less than `share` of the coordinates' own inertia is left, weakest first, that are made up
/// of modes for the greater part.
std::vector<MasslessDirection> massless_directions(const Model& model, const DenseSystem& system, double share);

/// A mode that may be left out: the highest of its family on its body.
struct Removal {
  std::string mode;      ///< as "link1.bending_y[2]"
  double condition = 0;  ///< AttainableAccuracy::condition of what is left
};

/// The highest mode of a body without which the mass matrix is best conditioned; nothing where there are no modes.
std::optional<Removal> best_removal(const Model& model, const DenseSystem& system);

/// What leaving out a mode does to the steps of an explicit integrator.
struct Slowing {
  std::string mode;    ///< as "link1.bending_y[2]"
  double fastest = 0;  ///< [rad/s], the fastest vibration of what is left; 0 where nothing vibrates
};

/// The highest mode of a body without which the fastest vibration is slowest, of those that are not prescribed; nothing
/// where there are none.
/// \param rows as fastest_mode
std::optional<Slowing> best_slowing(const Model& model, const DenseSystem& system, const Eigen::MatrixXd& rows = {});

/// A hinge for a rate of which the equations cannot be solved, whatever the accuracy.
struct UnsolvableRate {
  std::size_t hinge = 0;
  /// That its motion is not finite there, or that it moves no mass beyond rounding, or inertia beyond the range of
  /// numbers.
  std::string why;
  /// It moves mass, but not together with others, as the first and last axis of a wrist in one line do against each
  /// other: elsewhere the equations may be solved.
  bool together = false;
};
/// The first at a state; nothing where there is none. Inertia is looked at of at most `largest_examined` speeds.
std::optional<UnsolvableRate> unsolvable_rate(const Model& model, const EquationsOfMotion& equations,
                                              const State& state);

/// Why a relative tolerance cannot be had at a state: the error of its accelerations, the coordinate without inertia or
/// the direction with least (of at most `largest_examined` speeds), what may be done. Empty where it can.
std::string unattainable(const Model& model, const EquationsOfMotion& equations, const State& state, double tolerance);

}  // namespace withy
