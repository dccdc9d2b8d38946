/// \file
/// Exact kinematics of rods without truncation: no limit of small deflection, the same coordinates and stiffness.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_exact(Enrollment& enrollment) {
  constexpr Terms kept = {StrainOrder::exact, Truncation::none};
  enroll_terms<kept, rung<kept>>(
      enrollment, "exact",
      "Inextensible rods whose strains are modal, kinematics not expanded: large deflections, conserves energy and "
      "momentum");
}

}  // namespace withy
