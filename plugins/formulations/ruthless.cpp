/// \file
/// Ruthless linearization [Padilla & von Flotow 1989, section 3.4]: inertia, velocity terms and loads of the undeformed
/// tree.
#include "formulation_plugin.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  withy::enroll_formulation<withy::StrainOrder::linear, withy::Truncation::ruthless, withy::InStudies::rung>(
      enrollment, "ruthless", "Elastic terms dropped but for q̈, -Kq and -Dq̇ (order zero)");
}

}  // namespace

WITHY_PLUGIN(ruthless, enroll);
