/// \file
/// Quadrature along a beam: Gauss–Legendre panels, and running integrals ∫₀ˣ from values at their nodes.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace withy {

/// Nodes and weights on [0, length], fine enough for products of functions of wave number up to `wave_number`.
///
/// A panel has 20 Gauss nodes and spans at most 2.5 wave-number lengths: interpolating a product of two functions there
/// leaves (2.5)²⁰/(2¹⁹ 20!) ≈ 1e-16 of it, and the integrals of products of four are exact to rounding.
class BeamQuadrature {
 public:
  /// No panel has one of the `kinks` inside, points of [0, length] in any order where an integrand may have a kink.
  BeamQuadrature(double length, double wave_number, std::vector<double> kinks = {});

  [[nodiscard]] const std::vector<double>& nodes() const { return nodes_; }      ///< [m], increasing
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }  ///< [m]
  /// ∫₀ˣ f at every node, from the values of f at the nodes; one row a node, one column a function.
  [[nodiscard]] Eigen::MatrixXd running_integral(const Eigen::MatrixXd& values) const;
  /// ∫₀ˣ f at one x in [0, length]; one element a function.
  [[nodiscard]] Eigen::RowVectorXd integral_to(double x, const Eigen::MatrixXd& values) const;

 private:
  [[nodiscard]] Eigen::Index panels() const { return static_cast<Eigen::Index>(edges_.size()) - 1; }
  [[nodiscard]] double half_length(Eigen::Index panel) const;

  std::vector<double> edges_;  ///< of the panels, increasing from 0 to length
  std::vector<double> nodes_;
  std::vector<double> weights_;
};

}  // namespace withy
