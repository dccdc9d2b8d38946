/// \file
/// The common simplification that drops all inertia forces that are products of speeds [Padilla & von Flotow 1989,
/// section 3], with second-order kinematics in all else. It keeps no energy: it is there to be measured.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_rate_linear(Enrollment& enrollment) {
  constexpr Terms kept = {StrainOrder::quadratic, Truncation::none, false};
  enroll_terms<kept, aside<kept>>(enrollment, "rate-linear",
                                  "Second-order kinematics without Coriolis, centrifugal and gyroscopic terms");
}

}  // namespace withy
