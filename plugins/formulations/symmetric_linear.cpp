/// \file
/// First order of the kinetic energy with linear strain-displacement relations, a diagnostic: it separates what order
/// is kept from which relations.
#include "formulation_plugin.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  withy::enroll_formulation<withy::StrainOrder::linear, withy::Truncation::symmetric, withy::InStudies::aside>(
      enrollment, "symmetric-linear",
      "Kinetic energy to first order in the elastic coordinates, from linear strain-displacement relations");
}

}  // namespace

WITHY_PLUGIN(symmetric_linear, enroll);
