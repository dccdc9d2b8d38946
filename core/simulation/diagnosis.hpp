/// \file
/// The physical reasons of a run that ends badly, in words.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

/// Models with more generalized speeds are run without looking at M as a whole, which costs the cube of their number.
inline constexpr std::size_t largest_examined = 200;

/// Two times [s] between which det M changed its sign.
struct SignChange {
  double before = 0;
  double after = 0;
};

/// M at the start and at the end of a run.
struct MassMatrixHistory {
  DenseSystem first, last;
  Conditioning start, end;
  std::optional<SignChange> change;

  /// M is now singular to working accuracy, and was not at the start.
  [[nodiscard]] bool became_singular() const;
  /// M, positive definite at the start, is or was something else since.
  [[nodiscard]] bool lost_definiteness() const;
};

/// Looks at M at both ends. For at most `largest_examined` generalized speeds.
MassMatrixHistory examine(const EquationsOfMotion& equations, const State& first, const State& last,
                          const std::optional<SignChange>& change);

/// One or two sentences about M at the end of a run: sign of det M and where it changed, condition, smallest eigenvalue
/// of the symmetric part, and whose coordinates make up the direction of least (or of negative) mass. That direction is
/// found with each coordinate in the unit in which its own inertia at the start is one, so that it does not depend on
/// whether angles and modal coordinates are measured in radians, metres or inches.
std::string describe(const MassMatrixHistory& history, const Layout& layout);
/// In short, of a run that ended for another reason.
std::string describe_sound(const MassMatrixHistory& history);

/// Greatest √ of the eigenvalues of M⁻¹K [rad/s], K the stiffness of all bodies: how fast the modes retained can
/// vibrate in the tree. 0 where the symmetric part of M is not positive definite.
double fastest_mode(const Model& model, const DenseSystem& system);

/// Names what is not finite at the state or, for loads, up to `ahead` seconds later: loads, speeds, accelerations.
/// Empty where all of it is finite.
std::string describe_nonfinite(const Model& model, const EquationsOfMotion& equations, const State& state,
                               double ahead);

/// Whose coordinates make up a unit vector of generalized speeds, as "62 % modes of 'link1' (most of all
/// link1.bending_y[2]), 30 % hinge 'elbow'"; shares below 5 % are left out.
std::string owners_of(const Layout& layout, std::span<const double> unit_vector);

/// Short decimal text of a number, as "%.4g" without a locale.
std::string brief(double x);

}  // namespace withy
