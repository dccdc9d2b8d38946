/// \file
/// First order of the kinetic energy, from nonlinear strain-displacement relations.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_symmetric(Enrollment& enrollment) {
  enroll_terms<StrainOrder::quadratic, Truncation::symmetric>(
      enrollment, "symmetric",
      "Kinetic energy to first order in the elastic coordinates, from nonlinear strain-displacement relations, and all "
      "equations from it");
}

}  // namespace withy
