/// \file
/// The physical reasons of a run that ends badly, in words.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

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
  /// The least share of its inertia at the start that a motion has now: least |eigenvalue| of M_first⁻¹ M_last, where
  /// `compare_inertia` has looked; 1 where M was singular at the start.
  double least_share = 1;

  /// M is now singular to working accuracy, and was not at the start.
  [[nodiscard]] bool became_singular() const;
  /// M is so near to being singular that a motion has nothing left to be accelerated by but rounding and chance: with
  /// ½ λ q̇² bounded rates grow as 1/√λ, and come to where λ is zero in a finite time and with ever shorter steps.
  [[nodiscard]] bool nearly_singular() const;
  /// M is symmetric and not positive definite, or its determinant is negative: a motion has negative inertia, as in no
  /// structure. The strict formulations have no symmetric M; of one with a positive determinant the symmetric part says
  /// little.
  [[nodiscard]] bool has_negative_inertia() const;
  /// M, positive definite at the start, is or was something else since, or is about to be.
  [[nodiscard]] bool lost_definiteness() const;
};

/// Looks at M at both ends. For at most `largest_examined` generalized speeds.
MassMatrixHistory examine(const EquationsOfMotion& equations, const State& first, const State& last,
                          const std::optional<SignChange>& change);

/// Finds `least_share`, of a symmetric truncation: without truncation inertia may go to zero as in a structure, as that
/// about a hinge whose axis all mass comes onto.
void compare_inertia(MassMatrixHistory& history);

/// One or two sentences about M at the end of a run: sign of det M and where it changed, condition, smallest eigenvalue
/// of the symmetric part, and whose coordinates make up the direction of least (or of negative) mass. That direction is
/// found with each coordinate in the unit in which its own inertia at the start is one, so that it does not depend on
/// whether angles and modal coordinates are measured in radians, metres or inches.
std::string describe(const MassMatrixHistory& history, const Layout& layout);
/// In short, of a run that ended for another reason.
std::string describe_sound(const MassMatrixHistory& history);

/// Greatest √ of the eigenvalues of M⁻¹K [rad/s], K the stiffness of all bodies: how fast the modes retained can
/// vibrate in the tree. 0 where the symmetric part of M is not positive definite.
///
/// \param rows of closing equations there (closing_rows); the motions are those that keep loops closed
double fastest_mode(const Model& model, const DenseSystem& system, const Eigen::MatrixXd& rows = {});

/// Continuous states of loads whose rates are not finite from a state on, at the first such time found.
struct NonfiniteRates {
  std::vector<std::size_t> states;  ///< among those of all loads; empty where all rates are finite
  double time = 0;                  ///< [s]
};

/// Looks at the state and at times up to `ahead` seconds later.
NonfiniteRates nonfinite_rates(const Model& model, const State& state, double ahead);

/// The first of a state's numbers that is not finite, discrete states left out: "the coordinate 'elbow.0' is nan".
/// Empty where all are finite, or the state has another count of numbers than the layout.
std::string nonfinite_number(const Layout& layout, const State& state);

/// A hinge whose motion is not finite where its coordinates and rates are.
struct NonfiniteHinge {
  std::size_t hinge = 0;  ///< index in Model::hinges()
  std::string why;        ///< "the pose of hinge 'track' is not finite where its coordinate is 0.5"
};
/// The first at a state or where it comes to at its rates up to `ahead` seconds later; nothing where all are finite.
/// Hinges of known motion (Hinge::kernel) are not looked at.
std::optional<NonfiniteHinge> nonfinite_hinge(const Model& model, const State& state, double ahead);

/// Names what is not finite at the state or, for hinges and loads, up to `ahead` seconds later: hinges, loads, what
/// they hold, coordinates, speeds, accelerations. Empty where all of it is finite.
std::string describe_nonfinite(const Model& model, const EquationsOfMotion& equations, const State& state,
                               double ahead);

/// Whose coordinates make up a unit vector of generalized speeds, as "62 % modes of 'link1' (most of all
/// link1.bending_y[2]), 30 % hinge 'elbow'"; shares below 5 % are left out.
std::string owners_of(const Layout& layout, std::span<const double> unit_vector);

/// Short decimal text of a number, as "%.4g" without a locale.
std::string brief(double x);
/// "between t = 0.4853 and 0.4856 s": as short, and rounded outward, so that what is between the two times is between
/// those that are told. \param from before `to` [s]
std::string brief_interval(double from, double to);

}  // namespace withy
