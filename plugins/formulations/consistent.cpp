/// \file
/// Consistent linearization [Padilla & von Flotow 1989, section 3.2]: nonlinear strain-displacement relations, then
/// first order.
#include "formulation_plugin.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  withy::enroll_formulation<withy::StrainOrder::quadratic, withy::Truncation::strict>(
      enrollment, "consistent", "First order in the elastic coordinates, from nonlinear strain-displacement relations");
}

}  // namespace

WITHY_PLUGIN(consistent, enroll);
