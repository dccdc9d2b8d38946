/// \file
/// Second-order kinematics without truncation: the mass matrix is a Gram matrix Σ m JᵀJ.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_quadratic(Enrollment& enrollment) {
  constexpr Terms kept = {StrainOrder::quadratic, Truncation::none};
  enroll_terms<kept, rung<kept>>(
      enrollment, "quadratic",
      "Second-order kinematics, nothing truncated: symmetric positive definite, conserves energy and momentum");
}

}  // namespace withy
