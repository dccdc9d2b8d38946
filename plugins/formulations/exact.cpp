/// \file
/// Exact kinematics of rods without truncation: no limit of small deflection, the same coordinates and stiffness.
#include "formulation_plugin.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  withy::enroll_formulation<withy::StrainOrder::exact, withy::Truncation::none, withy::InStudies::rung>(
      enrollment, "exact",
      "Inextensible rods whose strains are modal, kinematics not expanded: large deflections, conserves energy and "
      "momentum");
}

}  // namespace

WITHY_PLUGIN(exact, enroll);
