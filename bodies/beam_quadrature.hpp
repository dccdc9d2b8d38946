/// \file
/// Quadrature along a beam, fine enough for products of its shape functions.
#pragma once

#include <functional>
#include <vector>

#include "withy/core/shape/panel_quadrature.hpp"

namespace withy {

/// By how much the functions whose products are integrated go on between two points x [rad], which no kink lies
/// between: their wave number times the length between them, and what else turns there.
using PhaseBetween = std::function<double(double from, double to)>;

/// A panel has 20 Gauss nodes and spans at most 2.5 rad of phase: interpolating a product of two functions there
/// leaves (2.5)²⁰/(2¹⁹ 20!) ≈ 1e-16 of it, and the integrals of products of four are exact to rounding.
class BeamQuadrature : public PanelQuadrature {
 public:
  /// No panel has one of the `kinks` inside, points of [0, length] in any order where an integrand may have a kink.
  BeamQuadrature(double length, const PhaseBetween& phase, std::vector<double> kinks = {});
};

/// For rotary inertia alone, whose sections are evaluated one after the other: as few nodes as integrate products of
/// four functions of this phase to 1e-15 of the length, by the error of Gauss's rule with n nodes on a length h of a
/// wave number k,
///   (4 k h)²ⁿ (n!)⁴ / ((2n + 1) ((2n)!)³)
/// of it. In multiples of four, as the sweeps take four at a time.
class SectionQuadrature : public PanelQuadrature {
 public:
  SectionQuadrature(double length, const PhaseBetween& phase, std::vector<double> kinks = {});
};

}  // namespace withy
