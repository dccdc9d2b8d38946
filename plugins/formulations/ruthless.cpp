/// \file
/// Ruthless linearization [Padilla & von Flotow 1989, section 3.4]: inertia, velocity terms and loads of the undeformed
/// tree.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_ruthless(Enrollment& enrollment) {
  enroll_terms<StrainOrder::linear, Truncation::ruthless, InStudies::rung>(
      enrollment, "ruthless",
      "Elasticity enters by its own inertia, stiffness and damping alone (order zero): cheapest, for slow motion");
}

}  // namespace withy
