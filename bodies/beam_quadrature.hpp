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

}  // namespace withy
