/// \file
/// Second-order kinematics without truncation: the mass matrix is a Gram matrix Σ m JᵀJ.
#include "formulation_plugin.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  withy::enroll_formulation<withy::StrainOrder::quadratic, withy::Truncation::none, withy::InStudies::rung>(
      enrollment, "quadratic",
      "Second-order kinematics, nothing truncated: symmetric positive definite, conserves energy and momentum");
}

}  // namespace

WITHY_PLUGIN(quadratic, enroll);
