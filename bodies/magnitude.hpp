/// \file
/// Whether doubles hold what a body's numbers come to together.
#pragma once

#include <initializer_list>

#include "withy/core/plugin/value.hpp"

namespace withy {

/// A number of a body in a scene, to a power.
struct Factor {
  const char* name;
  const Value* given;  ///< where it stands
  double value;        ///< positive: what is given, or the mean of a table
  int power = 1;
};

/// Sums of squares are taken of inertias, stiffness and squared frequencies: where the square of a product leaves the
/// range of doubles, what comes of it is zero, infinite or no number. Reports that at the factor that does it most,
/// with the bound that the others leave to it. \returns whether it is held
bool held(const char* what, std::initializer_list<Factor> product, Diagnostics& diagnostics);

}  // namespace withy
