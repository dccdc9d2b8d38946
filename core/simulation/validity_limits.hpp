/// \file
/// Limits of validity (theory, section 5).
#pragma once

#include "withy/core/plugin/terms.hpp"

namespace withy {

/// Whether the second-order terms that motion and load bring to bear are in the equations. Kinetic energy of first
/// order has none of motion.
inline bool second_order(const Terms& terms) {
  return terms.strain != StrainOrder::linear &&
         (terms.truncation == Truncation::strict || terms.truncation == Truncation::none) && terms.products_of_speeds;
}

/// Rate of a body over its fundamental frequency beyond which frequencies of a truncation of linear kinematics are 1 %
/// wrong. A body with modes in one direction alone is taken to bend in the plane of rotation.
inline double rate_limit(const Terms& terms, bool one_direction) {
  if (terms.truncation == Truncation::ruthless || terms.truncation == Truncation::symmetric ||
      !terms.products_of_speeds)
    return one_direction ? 0.325 : 0.130;
  return 0.129;
}

/// Whether the gyroscopic moments of what spins on bodies that bend are left out of their equations.
inline bool without_gyroscopic(const Terms& terms) {
  return terms.truncation == Truncation::ruthless || !terms.products_of_speeds;
}

/// Moment of what spins on a body over what bends it (CarriedSpin) beyond which frequencies are 1 % wrong where it is
/// left out: half of the ratio, of a disk at the tip that is all moment of inertia.
inline constexpr double spin_limit = 0.02;

/// Load over buckling load up to which second-order terms may be left out.
inline constexpr double load_limit = 0.1;
/// Tip deflection over length up to which deflections are small.
inline constexpr double deflection_limit = 0.1;
/// Angle [rad] of a section of a bent body up to which angles are small: the one by which the end of an evenly bent
/// body has turned that is deflected as far as deflections are small.
inline constexpr double angle_limit = 2 * deflection_limit;

}  // namespace withy
