/// \file
/// Inconsistent linearization [Padilla & von Flotow 1989, section 3.3]: linear strain-displacement relations, then
/// first order.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_inconsistent(Enrollment& enrollment) {
  enroll_terms<StrainOrder::linear, Truncation::strict, InStudies::aside>(
      enrollment, "inconsistent",
      "First order from linear strains, which lacks stiffening of that same order: shows what goes wrong");
}

}  // namespace withy
