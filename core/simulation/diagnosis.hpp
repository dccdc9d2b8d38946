/// \file
/// The physical reasons of a run that ends badly, in words.
#pragma once

#include <optional>
#include <string>

#include "withy/core/dynamics/equations.hpp"
#include "withy/core/model/model.hpp"

namespace withy {

/// Two times [s] between which det M changed its sign.
struct SignChange {
  double before = 0;
  double after = 0;
};

/// Models with more generalized speeds are run without looking at M as a whole, which costs the cube of their number.
inline constexpr std::size_t largest_examined = 200;

/// Short decimal text of a number, "%.4g" in the C locale's form.
std::string brief(double x);

/// Whether M, positive definite at the start, has lost that on the way.
bool lost_definiteness(const Conditioning& start, const Conditioning& end, const std::optional<SignChange>& change);

/// One or two sentences about M at the end of a run: sign of det M and where it changed, condition, smallest eigenvalue
/// of the symmetric part, and whose coordinates make up the weakest direction.
std::string describe_mass_matrix(const Layout& layout, const Conditioning& start, const Conditioning& end,
                                 const std::optional<SignChange>& change);

/// Names what is not finite at the state or, for loads, up to `ahead` seconds later: coordinates, loads, accelerations.
/// Empty where all of it is finite.
std::string describe_nonfinite(const Model& model, const EquationsOfMotion& equations, const State& state,
                               double ahead);

}  // namespace withy
