/// \file
/// First order of the kinetic energy with linear strain-displacement relations, a diagnostic: it separates what order
/// is kept from which relations.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_symmetric_linear(Enrollment& enrollment) {
  enroll_terms<StrainOrder::linear, Truncation::symmetric, InStudies::aside>(
      enrollment, "symmetric-linear",
      "Kinetic energy to first order in the elastic coordinates, from linear strain-displacement relations");
}

}  // namespace withy
