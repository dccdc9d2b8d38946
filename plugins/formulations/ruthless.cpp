/// \file
/// Ruthless linearization [Padilla & von Flotow 1989, section 3.4]: inertia, velocity terms and loads of the undeformed
/// tree.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_ruthless(Enrollment& enrollment) {
  constexpr Terms kept = {StrainOrder::linear, Truncation::ruthless};
  enroll_terms<kept, rung<kept>>(enrollment, "ruthless", "Elastic terms dropped but for q̈, -Kq and -Dq̇ (order zero)");
}

}  // namespace withy
