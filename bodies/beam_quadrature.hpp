/// \file
/// Quadrature along a beam, fine enough for products of its shape functions.
#pragma once

#include <vector>

#include "withy/core/shape/panel_quadrature.hpp"

namespace withy {

/// A panel has 20 Gauss nodes and spans at most 2.5 wave-number lengths: interpolating a product of two functions there
/// leaves (2.5)²⁰/(2¹⁹ 20!) ≈ 1e-16 of it, and the integrals of products of four are exact to rounding.
class BeamQuadrature : public PanelQuadrature {
 public:
  /// No panel has one of the `kinks` inside, points of [0, length] in any order where an integrand may have a kink.
  BeamQuadrature(double length, double wave_number, std::vector<double> kinks = {});
};

/// For rotary inertia alone, whose sections are evaluated one after the other: as few nodes as integrate products of
/// four functions of this wave number to 1e-15 of the length, by the error of Gauss's rule with n nodes on a length h,
///   (4 k h)²ⁿ (n!)⁴ / ((2n + 1) ((2n)!)³)
/// of it. In multiples of four, as the sweeps take four at a time.
class SectionQuadrature : public PanelQuadrature {
 public:
  SectionQuadrature(double length, double wave_number, std::vector<double> kinks = {});
};

}  // namespace withy
