/// \file
/// Eigenfunctions of the uniform beam clamped at both ends.
///
/// Bending: cosh βξ − cos βξ − σ (sinh βξ − sin βξ), σ = (cosh β − cos β)/(sinh β − sin β), cosh β cos β = 1 (Blevins
/// 1979, table 8-1); ∫₀ᴸ φ² dx = L. Torsion: sin kπx/L. The tip stays where it is: alone, they are no basis for a beam
/// whose tip moves.
#include "mode_family_plugin.hpp"
#include "uniform_beam.hpp"
#include "uniform_rod.hpp"

namespace withy {
namespace clamped_clamped {

std::unique_ptr<ShapeFunctions> bending(const BeamData& beam, std::size_t count) {
  return clamped_clamped_beam(beam.length, count);
}

std::unique_ptr<ShapeFunctions> torsion(const BeamData& beam, std::size_t count) {
  return std::make_unique<RodWaves>(beam.length, RodWaves::Root::clamped, 0.0, count);
}

}  // namespace clamped_clamped

void enroll_clamped_clamped(Enrollment& enrollment) {
  enroll_family<&clamped_clamped::bending, &clamped_clamped::torsion>(
      enrollment, "clamped-clamped", "Eigenfunctions of the uniform beam clamped at root and tip");
}

}  // namespace withy
