/// \file
/// Elastic eigenfunctions of the uniform beam pinned at the root and free at the tip, in bending:
///   φ = n (sin βξ + C sinh βξ), C = sin β/sinh β, tan β = tanh β, n = √(2/(1 − C²)) for ∫₀ᴸ φ² dx = L
/// (Blevins 1979, table 8-1, there from the free end). They are orthogonal to the rigid rotation about the root, which
/// is the hinge's: the body frame turns with the mean line of the beam, ∫ x φ dx = 0, the root section turns in it.
/// No functions for torsion: a pin says nothing of twist.
#include "mode_family_plugin.hpp"
#include "uniform_beam.hpp"

namespace withy {
namespace pinned_free {

BeamWave wave(double beta) {
  const double e = std::exp(-beta);
  const double half_exponent = std::sin(beta) / (1 - e * e);  // ½ C exp β
  const double C = 2 * e * half_exponent;
  const double n = std::sqrt(2 / ((1 - C) * (1 + C)));
  return {beta, 0, n, -n * half_exponent * e, n * half_exponent};
}

std::unique_ptr<ShapeFunctions> bending(const BeamData& beam, std::size_t count) {
  return beam_waves(beam.length, count, EndCondition::pinned, EndCondition::free, &beam_roots::one_pinned, &wave);
}

}  // namespace pinned_free

void enroll_pinned_free(Enrollment& enrollment) {
  enroll_family<&pinned_free::bending, &no_functions>(
      enrollment, "pinned-free", "Elastic eigenfunctions of the uniform beam pinned at the root and free at the tip");
}

}  // namespace withy
