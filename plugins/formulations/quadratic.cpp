/// \file
/// Second-order kinematics without truncation: the mass matrix is a Gram matrix Σ m JᵀJ.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_quadratic(Enrollment& enrollment) {
  enroll_terms<StrainOrder::quadratic, Truncation::none, InStudies::rung>(
      enrollment, "quadratic",
      "Second-order kinematics, nothing truncated: symmetric positive definite, conserves energy and momentum");
}

}  // namespace withy
