/// \file
/// Eigenfunctions of the uniform rod in torsion or elongation, φ″ = −(β/L)² φ: sines and cosines of amplitude 1.
#pragma once

#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "withy/core/plugin/mode_family.hpp"

namespace withy {

class RodWaves final : public ShapeFunctions {
 public:
  enum class Root { clamped, free };  ///< sin βξ or cos βξ, ξ = x/L

  /// `betas` rise.
  RodWaves(double length, Root root, std::vector<double> betas)
      : length_(length), root_(root), betas_(std::move(betas)) {}
  /// β_k = (k + offset) π, k = 1 … count.
  RodWaves(double length, Root root, double offset, std::size_t count) : length_(length), root_(root) {
    for (std::size_t k = 1; k <= count; ++k) {
      betas_.push_back((static_cast<double>(k) + offset) * boost::math::constants::pi<double>());
    }
  }

  std::size_t count() const override { return betas_.size(); }
  double wave_number() const override { return betas_.back() / length_; }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    for (std::size_t k = 0; k < betas_.size(); ++k) {
      const double b = betas_[k] / length_;
      const double sine = std::sin(b * x);
      const double cosine = std::cos(b * x);
      phi[k] = root_ == Root::clamped ? sine : cosine;
      slope[k] = b * (root_ == Root::clamped ? cosine : -sine);
      curvature[k] = -b * b * phi[k];
    }
  }

 private:
  double length_;
  Root root_;
  std::vector<double> betas_;
};

}  // namespace withy
