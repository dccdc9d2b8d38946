/// \file
/// Bending eigenfunctions of the uniform beam clamped at the root whose tip carries a rigid body.
///
/// The body has mass m, its centre of mass lies a beyond the tip along the beam, J is its inertia about that centre and
/// the bending axis. With ξ = x/L, primes d/dξ, and
///   μ = m/ρAL, ς = m a/ρAL², ι = (J + m a²)/ρAL³
/// the tip's section obeys φ‴ = −β⁴ (μ φ + ς φ′), φ″ = β⁴ (ς φ + ι φ′). Functions of different β are orthogonal with
/// respect to the loaded mass, ∫ φ_i φ_j dξ + μ φ_i φ_j + ς (φ_i φ_j′ + φ_i′ φ_j) + ι φ_i′ φ_j′ (at ξ = 1) = 0, i ≠ j.
#pragma once

#include "uniform_beam.hpp"

namespace withy {

/// The tip body in units of the beam.
struct TipLoad {
  double mass = 0;             ///< μ ≥ 0
  double offset = 0;           ///< a/L, of either sign
  double central_inertia = 0;  ///< J/ρAL³ ≥ 0

  [[nodiscard]] double moment() const { return mass * offset; }                              ///< ς
  [[nodiscard]] double inertia() const { return central_inertia + mass * offset * offset; }  ///< ι
};

/// k-th root (k ≥ 1) of the characteristic equation.
double loaded_beam_root(const TipLoad& tip, std::size_t k);

/// The first `count` functions, ∫₀ᴸ φ² dx = L.
std::unique_ptr<ShapeFunctions> loaded_beam(double length, const TipLoad& tip, std::size_t count);

}  // namespace withy
