/// \file
/// Linear kinematics without truncation, a diagnostic: what widely used floating-frame models solve.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_linear(Enrollment& enrollment) {
  enroll_terms<Terms{StrainOrder::linear, Truncation::none}>(
      enrollment, "linear",
      "Linear kinematics, nothing truncated: the floating-frame model of most engines, for comparison");
}

}  // namespace withy
