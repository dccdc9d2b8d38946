/// \file
/// Eigenfunctions of the uniform beam clamped at the root and pinned at the tip, in bending:
/// cosh βξ − cos βξ − σ (sinh βξ − sin βξ), σ = (cosh β − cos β)/(sinh β − sin β), tan β = tanh β (Blevins 1979,
/// table 8-1); ∫₀ᴸ φ² dx = L. A pin says nothing of twist: there are no functions for torsion.
#include "mode_family_plugin.hpp"
#include "uniform_beam.hpp"

namespace withy {
namespace clamped_pinned {

std::unique_ptr<ShapeFunctions> bending(const BeamData& beam, std::size_t count) {
  return beam_waves(beam.length, count, EndCondition::clamped, EndCondition::pinned, &beam_roots::one_pinned,
                    [](double beta) { return clamped_wave(beta, h_of_held_tip(beta)); });
}

}  // namespace clamped_pinned

void enroll_clamped_pinned(Enrollment& enrollment) {
  enroll_family<&clamped_pinned::bending, &no_functions>(
      enrollment, "clamped-pinned", "Eigenfunctions of the uniform beam clamped at the root and pinned at the tip");
}

}  // namespace withy
