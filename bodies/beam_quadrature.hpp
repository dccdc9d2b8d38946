/// \file
/// Quadrature along a beam, by the wave number of its shape functions.
#pragma once

#include <algorithm>
#include <cmath>

#include "withy/core/shape/panel_quadrature.hpp"

namespace withy {

/// Panels fine enough for products of functions of wave number up to `wave_number`.
///
/// A panel has 20 Gauss nodes and spans at most 2.5 wave-number lengths: interpolating a product of two functions there
/// leaves (2.5)²⁰/(2¹⁹ 20!) ≈ 1e-16 of it, and the integrals of products of four are exact to rounding.
class BeamQuadrature : public PanelQuadrature {
 public:
  BeamQuadrature(double length, double wave_number)
      : PanelQuadrature(length, std::max<Eigen::Index>(1, std::lround(std::ceil(wave_number * length / 2.5))), 20) {}
};

}  // namespace withy
