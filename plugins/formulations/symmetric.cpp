/// \file
/// First order of the kinetic energy, from nonlinear strain-displacement relations.
#include "formulation_plugin.hpp"

namespace {

void enroll(withy::Enrollment& enrollment) {
  withy::enroll_formulation<withy::StrainOrder::quadratic, withy::Truncation::symmetric, withy::InStudies::aside>(
      enrollment, "symmetric",
      "Kinetic energy to first order in the elastic coordinates, from nonlinear strain-displacement relations, and all "
      "equations from it");
}

}  // namespace

WITHY_PLUGIN(symmetric, enroll);
