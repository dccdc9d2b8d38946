/// \file
/// Consistent linearization [Padilla & von Flotow 1989, section 3.2]: nonlinear strain-displacement relations, then
/// first order.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_consistent(Enrollment& enrollment) {
  enroll_terms<StrainOrder::quadratic, Truncation::strict>(
      enrollment, "consistent",
      "All terms of first order in the elastic coordinates, and no others: its mass matrix may turn singular");
}

}  // namespace withy
