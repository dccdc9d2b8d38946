/// \file
/// Bending eigenfunctions of the uniform Euler–Bernoulli beam, φ⁗ = (β/L)⁴ φ, without loss of digits.
///
/// Textbooks (Blevins 1979, table 8-1) write them with cosh βξ and sinh βξ, ξ = x/L, and subtract numbers as large as
/// exp β: every digit is lost beyond mode 12. Here the four solutions are
///   φ = a cos βξ + b sin βξ + c e^(−βξ) + d e^(−β(1−ξ)),
/// none of which exceeds 1, and c, d are found without differences of large numbers: 1e-12 for 200 functions.
#pragma once

#include <boost/math/constants/constants.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "withy/core/plugin/mode_family.hpp"

namespace withy {

/// What an end of the beam holds: clamped φ = φ′ = 0, pinned φ = φ″ = 0, free φ″ = 0 (and φ‴ = 0), loaded none of
/// these.
enum class EndCondition { clamped, pinned, free, loaded };

/// One eigenfunction, its coefficients as above.
struct BeamWave {
  double beta;          ///< β = kL of the wave number k
  double cosine, sine;  ///< a, b
  double root, tip;     ///< c, d: of the solutions that decay from the root and from the tip
};

/// Eigenfunctions in rising order of β, with what the ends hold: there it holds exactly, not to rounding, for a section
/// that does not move must be seen not to.
class BeamWaves final : public ShapeFunctions {
 public:
  BeamWaves(double length, EndCondition root, EndCondition tip, std::vector<BeamWave> waves)
      : length_(length), root_(root), tip_(tip), waves_(std::move(waves)) {}

  std::size_t count() const override { return waves_.size(); }
  double wave_number() const override { return waves_.back().beta / length_; }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    const double xi = x / length_;
    for (std::size_t k = 0; k < waves_.size(); ++k) {
      const auto [beta, a, b, c, d] = waves_[k];
      const double wave_number = beta / length_;
      const double sine = a * std::cos(beta * xi) + b * std::sin(beta * xi);
      const double sine_slope = b * std::cos(beta * xi) - a * std::sin(beta * xi);
      const double from_root = c * std::exp(-beta * xi);
      const double from_tip = d * std::exp(-beta * (1 - xi));
      phi[k] = sine + from_root + from_tip;
      slope[k] = wave_number * (sine_slope - from_root + from_tip);
      curvature[k] = wave_number * wave_number * (-sine + from_root + from_tip);
      if (xi == 0) hold(root_, phi[k], slope[k], curvature[k]);
      if (xi == 1) hold(tip_, phi[k], slope[k], curvature[k]);
    }
  }

 private:
  static void hold(EndCondition end, double& phi, double& slope, double& curvature) {
    using enum EndCondition;
    if (end == clamped || end == pinned) phi = 0;
    if (end == clamped) slope = 0;
    if (end == pinned || end == free) curvature = 0;
  }

  double length_;
  EndCondition root_, tip_;
  std::vector<BeamWave> waves_;
};

/// Roots of the characteristic equations, k ≥ 1 (Blevins 1979, table 8-1), each divided by cosh β.
namespace beam_roots {

/// Root of f within 0.4 of `start`; f gives value and derivative, whose size there is one.
template <class F>
double near(double start, F f) {
  return boost::math::tools::newton_raphson_iterate(f, start, start - 0.4, start + 0.4, 53);
}

/// Root between a and b, where f changes its sign, to the last bit.
template <class F>
double between(double a, double b, F f) {
  return boost::math::tools::bisect(f, a, b, [](double x, double y) { return std::nextafter(x, y) >= y; }).first;
}

inline double half_waves(std::size_t k, double offset) {
  return (static_cast<double>(k) + offset) * boost::math::constants::pi<double>();
}

/// cosh β cos β = −1: one end clamped, one free.
inline double clamped_free(std::size_t k) {
  return near(half_waves(k, -0.5), [](double b) {
    const double sech = 1 / std::cosh(b);
    return std::make_pair(std::cos(b) + sech, -std::sin(b) - std::tanh(b) * sech);
  });
}

/// cosh β cos β = 1: both ends clamped, or both free.
inline double alike(std::size_t k) {
  return near(half_waves(k, 0.5), [](double b) {
    const double sech = 1 / std::cosh(b);
    return std::make_pair(std::cos(b) - sech, -std::sin(b) + std::tanh(b) * sech);
  });
}

/// tan β = tanh β: one end pinned, the other clamped or free.
inline double one_pinned(std::size_t k) {
  return near(half_waves(k, 0.25), [](double b) {
    const double tanh = std::tanh(b);
    return std::make_pair(std::sin(b) - std::cos(b) * tanh,
                          std::cos(b) + std::sin(b) * tanh - std::cos(b) * (1 - tanh * tanh));
  });
}

}  // namespace beam_roots

/// Functions of a beam whose characteristic equation has the roots `root(k)` and whose k-th function is wave(β).
template <class Root, class Wave>
std::unique_ptr<ShapeFunctions> beam_waves(double length, std::size_t count, EndCondition root_end,
                                           EndCondition tip_end, Root root, Wave wave) {
  std::vector<BeamWave> waves;
  for (std::size_t k = 1; k <= count; ++k) waves.push_back(wave(root(k)));
  return std::make_unique<BeamWaves>(length, root_end, tip_end, std::move(waves));
}

/// cosh βξ − cos βξ − σ (sinh βξ − sin βξ), given h = ½ (σ − 1) exp β: clamped at the root.
inline BeamWave clamped_wave(double beta, double h) {
  const double e = std::exp(-beta);
  return {beta, -1, 1 + 2 * h * e, 1 + h * e, -h};
}

/// h of σ = (cosh β − cos β)/(sinh β − sin β): the tip at φ = 0.
inline double h_of_held_tip(double beta) {
  const double e = std::exp(-beta);
  return (e - std::cos(beta) + std::sin(beta)) / (1 - e * e - 2 * e * std::sin(beta));
}

/// Eigenfunctions of the beam clamped at both ends, ∫₀ᴸ φ² dx = L.
inline std::unique_ptr<ShapeFunctions> clamped_clamped_beam(double length, std::size_t count) {
  return beam_waves(length, count, EndCondition::clamped, EndCondition::clamped, &beam_roots::alike,
                    [](double beta) { return clamped_wave(beta, h_of_held_tip(beta)); });
}

}  // namespace withy
