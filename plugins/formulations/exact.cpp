/// \file
/// Exact kinematics of rods without truncation: no limit of small deflection, the same coordinates and stiffness.
#include "formulation_plugin.hpp"

namespace {

constexpr withy::Terms kept = {withy::StrainOrder::exact, withy::Truncation::none};

void enroll(withy::Enrollment& enrollment) {
  withy::enroll_formulation<kept, withy::rung<kept>>(
      enrollment, "exact",
      "Inextensible rods whose strains are modal, kinematics not expanded: large deflections, conserves energy and "
      "momentum");
}

}  // namespace

WITHY_PLUGIN(exact, enroll);
