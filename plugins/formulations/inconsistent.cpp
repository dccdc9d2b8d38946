/// \file
/// Inconsistent linearization [Padilla & von Flotow 1989, section 3.3]: linear strain-displacement relations, then
/// first order.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_inconsistent(Enrollment& enrollment) {
  constexpr Terms kept = {StrainOrder::linear, Truncation::strict};
  enroll_terms<kept, aside<kept>>(enrollment, "inconsistent",
                                  "First order in the elastic coordinates, from linear strain-displacement relations");
}

}  // namespace withy
