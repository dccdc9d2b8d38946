/// \file
/// Linear kinematics without truncation, a diagnostic: what widely used floating-frame models solve.
#include "formulation_plugin.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  withy::enroll_formulation<withy::StrainOrder::linear, withy::Truncation::none>(
      enrollment, "linear",
      "Linear kinematics, nothing truncated: the floating-frame model of most engines, for comparison");
}

}  // namespace

WITHY_PLUGIN(linear, enroll);
