/// \file
/// The formulation that a run chooses and changes as its motion asks (core/simulation/escalation.hpp). Where nothing
/// runs it is `quadratic`, which holds wherever the ladder begins.
#include "formulation_plugin.hpp"

namespace withy {

void enroll_automatic(Enrollment& enrollment) {
  constexpr Terms kept = {StrainOrder::quadratic, Truncation::none};
  enroll_terms<kept, aside<kept>>(
      enrollment, "auto",
      "The least of ruthless, quadratic and exact whose validity holds, changed along a run where it does not; "
      "quadratic where nothing runs");
}

}  // namespace withy
