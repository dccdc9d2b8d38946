/// \file
/// Consistent linearization [Padilla & von Flotow 1989, section 3.2]: nonlinear strain-displacement relations, then
/// first order.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_consistent(Enrollment& enrollment) {
  enroll_terms<Terms{StrainOrder::quadratic, Truncation::strict}>(
      enrollment, "consistent", "First order in the elastic coordinates, from nonlinear strain-displacement relations");
}

}  // namespace withy
