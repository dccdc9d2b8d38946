/// \file
/// Exact kinematics of rods without truncation: no limit of small deflection, the same coordinates and stiffness.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_exact(Enrollment& enrollment) {
  enroll_terms<StrainOrder::exact, Truncation::none, InStudies::rung>(
      enrollment, "exact",
      "Rods whose strains are modal, kinematics not expanded: large deflections, conserves energy and "
      "momentum");
}

}  // namespace withy
