/// \file
/// Eigenfunctions of the uniform beam pinned at both ends, in bending: √2 sin kπx/L, ∫₀ᴸ φ² dx = L. The body frame's x
/// axis passes through both ends; the root section turns in it. No functions for torsion: a pin says nothing of twist.
#include "mode_family_plugin.hpp"
#include "uniform_beam.hpp"

namespace withy {
namespace pinned_pinned {

std::unique_ptr<ShapeFunctions> bending(const BeamData& beam, std::size_t count) {
  return beam_waves(
      beam.length, count, EndCondition::pinned, EndCondition::pinned,
      [](std::size_t k) { return beam_roots::half_waves(k, 0.0); },
      [](double beta) {
        return BeamWave{beta, 0, boost::math::constants::root_two<double>(), 0, 0};
      });
}

}  // namespace pinned_pinned

void enroll_pinned_pinned(Enrollment& enrollment) {
  enroll_family<&pinned_pinned::bending, &no_functions>(enrollment, "pinned-pinned",
                                                        "Eigenfunctions of the uniform beam pinned at root and tip");
}

}  // namespace withy
