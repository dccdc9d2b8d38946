/// \file
/// Craig–Bampton modes of the uniform beam clamped at the root (Craig & Bampton, AIAA J. 6 (1968) 1313): static
/// constraint modes of the tip, then the modes of the beam with its tip fixed.
///
/// Bending, ξ = x/L: φ₁ = 3ξ² − 2ξ³ (unit deflection of the tip, no slope), φ₂ = ξ³ − ξ² (slope 1/L, no deflection),
/// then the clamped-clamped functions with ∫₀ᴸ φ² dx = L. So q₁ is the deflection of the tip and q₂ its slope times L,
/// the constraint modes keeping that meaning rather than the others' normalization. Torsion: φ₁ = ξ, q₁ the twist of
/// the tip; then sin kπξ.
#include "mode_family_plugin.hpp"
#include "uniform_beam.hpp"
#include "uniform_rod.hpp"

namespace withy {
namespace craig_bampton {

/// Value, slope and curvature of a constraint mode at ξ for L = 1.
struct Static {
  double phi, slope, curvature;
};

/// Constraint modes before the fixed-interface modes; null `fixed` where there is none of those.
template <std::size_t constraints>
class ConstrainedFunctions final : public ShapeFunctions {
 public:
  using ConstraintMode = Static (*)(std::size_t k, double xi);
  ConstrainedFunctions(double length, std::size_t count, ConstraintMode constraint,
                       std::unique_ptr<ShapeFunctions> fixed)
      : length_(length), count_(count), constraint_(constraint), fixed_(std::move(fixed)) {}
  std::size_t count() const override { return count_; }
  /// Cubics and lines vary no faster than half a wave over the length.
  double wave_number() const override {
    return fixed_ ? fixed_->wave_number() : boost::math::constants::pi<double>() / length_;
  }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    const std::size_t statics = std::min(count_, constraints);
    for (std::size_t k = 0; k < statics; ++k) {
      const Static s = constraint_(k, x / length_);
      phi[k] = s.phi;
      slope[k] = s.slope / length_;
      curvature[k] = s.curvature / (length_ * length_);
    }
    if (fixed_) fixed_->evaluate(x, phi.subspan(statics), slope.subspan(statics), curvature.subspan(statics));
  }

 private:
  double length_;
  std::size_t count_;
  ConstraintMode constraint_;
  std::unique_ptr<ShapeFunctions> fixed_;
};

Static cubic(std::size_t k, double xi) {
  if (k == 0) return {xi * xi * (3 - 2 * xi), 6 * xi * (1 - xi), 6 - 12 * xi};
  return {xi * xi * (xi - 1), xi * (3 * xi - 2), 6 * xi - 2};
}

std::unique_ptr<ShapeFunctions> bending(const BeamData& beam, std::size_t count) {
  auto fixed = count > 2 ? clamped_clamped_beam(beam.length, count - 2) : nullptr;
  return std::make_unique<ConstrainedFunctions<2>>(beam.length, count, &cubic, std::move(fixed));
}

std::unique_ptr<ShapeFunctions> torsion(const BeamData& beam, std::size_t count) {
  auto fixed = count > 1 ? std::make_unique<RodWaves>(beam.length, RodWaves::Root::clamped, 0.0, count - 1) : nullptr;
  const auto line = [](std::size_t, double xi) { return Static{xi, 1, 0}; };
  return std::make_unique<ConstrainedFunctions<1>>(beam.length, count, line, std::move(fixed));
}

}  // namespace craig_bampton

void enroll_craig_bampton(Enrollment& enrollment) {
  enroll_family<&craig_bampton::bending, &craig_bampton::torsion, 200, true>(
      enrollment, "craig-bampton",
      "Static deflection, slope and twist of the tip, and the modes of the beam with its tip fixed");
}

}  // namespace withy
