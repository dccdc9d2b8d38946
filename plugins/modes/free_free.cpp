/// \file
/// Elastic eigenfunctions of the uniform free-free beam.
///
/// Bending: cosh βξ + cos βξ − σ (sinh βξ + sin βξ), σ = (cosh β − cos β)/(sinh β − sin β), cosh β cos β = 1 (Blevins
/// 1979, table 8-1); ∫₀ᴸ φ² dx = L. Torsion: cos kπx/L. They are orthogonal to the rigid motions, which are the
/// hinge's: the body frame is the mean-axis frame of the beam, ∫ φ dx = ∫ x φ dx = 0, and the root section moves and
/// turns in it.
#include "mode_family_plugin.hpp"
#include "uniform_beam.hpp"
#include "uniform_rod.hpp"

namespace withy {
namespace free_free {

/// With h = ½ (σ − 1) exp β: cosh βξ − σ sinh βξ is (1 + h e^(−β)) e^(−βξ) − h e^(−β(1−ξ)).
BeamWave wave(double beta) {
  const double e = std::exp(-beta);
  const double h = h_of_held_tip(beta);
  return {beta, 1, -(1 + 2 * h * e), 1 + h * e, -h};
}

std::unique_ptr<ShapeFunctions> bending(const BeamData& beam, std::size_t count) {
  return beam_waves(beam.length, count, EndCondition::free, EndCondition::free, &beam_roots::alike, &wave);
}

std::unique_ptr<ShapeFunctions> torsion(const BeamData& beam, std::size_t count) {
  return std::make_unique<RodWaves>(beam.length, RodWaves::Root::free, 0.0, count);
}

}  // namespace free_free

void enroll_free_free(Enrollment& enrollment) {
  enroll_family<&free_free::bending, &free_free::torsion>(
      enrollment, "free-free", "Elastic eigenfunctions of the uniform beam free at root and tip");
}

}  // namespace withy
