/// \file
/// Inconsistent linearization [Padilla & von Flotow 1989, section 3.3]: linear strain-displacement relations, then
/// first order.
#include "formulation_plugin.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  withy::enroll_formulation<withy::StrainOrder::linear, withy::Truncation::strict, withy::InStudies::aside>(
      enrollment, "inconsistent", "First order in the elastic coordinates, from linear strain-displacement relations");
}

}  // namespace

WITHY_PLUGIN(inconsistent, enroll);
