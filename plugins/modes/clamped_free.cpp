/// \file
/// Eigenfunctions of the uniform clamped-free beam in bending and of the clamped-free rod in torsion.
///
/// Bending: cosh βξ − cos βξ − σ (sinh βξ − sin βξ), σ = (cosh β + cos β)/(sinh β + sin β), cosh β cos β = −1 (Blevins
/// 1979, table 8-1), in a form that keeps its digits; ∫₀ᴸ φ² dx = L, φ_k(L) = ±2.
/// Torsion: sin((k − ½) π x/L): the twist at the tip is the sum of ±q_k.
#include "mode_family_plugin.hpp"
#include "uniform_beam.hpp"
#include "uniform_rod.hpp"

namespace withy {
namespace clamped_free {

std::unique_ptr<ShapeFunctions> bending(const BeamData& beam, std::size_t count) {
  return beam_waves(
      beam.length, count, EndCondition::clamped, EndCondition::free, &beam_roots::clamped_free, [](double beta) {
        const double e = std::exp(-beta);
        return clamped_wave(beta, (e + std::cos(beta) - std::sin(beta)) / (1 - e * e + 2 * e * std::sin(beta)));
      });
}

std::unique_ptr<ShapeFunctions> torsion(const BeamData& beam, std::size_t count) {
  return std::make_unique<RodWaves>(beam.length, RodWaves::Root::clamped, -0.5, count);
}

}  // namespace clamped_free

void enroll_clamped_free(Enrollment& enrollment) {
  enroll_family<&clamped_free::bending, &clamped_free::torsion, 200, true>(
      enrollment, "clamped-free", "Eigenfunctions of the uniform beam clamped at the root and free at the tip");
}

}  // namespace withy
