/// \file
/// Quadrature along a line: Gauss–Legendre panels, and running integrals ∫₀ˣ from values at their nodes.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace withy {

/// Nodes and weights on panels of `order` Gauss nodes each. Integrals over a whole panel are
/// exact for polynomials of degree 2·order − 1, running integrals for those of degree order − 1.
class PanelQuadrature {
 public:
  /// Panels between these edges, which increase.
  PanelQuadrature(std::vector<double> edges, Eigen::Index order);
  /// Equal panels on [0, length].
  PanelQuadrature(double length, Eigen::Index panels, Eigen::Index order);

  [[nodiscard]] Eigen::Index panels() const { return static_cast<Eigen::Index>(edges_.size()) - 1; }
  [[nodiscard]] Eigen::Index order() const { return order_; }
  [[nodiscard]] const std::vector<double>& nodes() const { return nodes_; }      ///< [m], increasing
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }  ///< [m]
  /// order×order: row i gives ∫ from the first panel's beginning to its node i from the values at its nodes [m]; the
  /// same for every panel where they are equal.
  [[nodiscard]] const Eigen::MatrixXd& running() const { return running_; }
  /// ∫₀ˣ f at every node, from the values of f at the nodes; one row a node, one column a function.
  [[nodiscard]] Eigen::MatrixXd running_integral(const Eigen::MatrixXd& values) const;
  /// ∫₀ˣ f at one x in [0, length]; one element a function.
  [[nodiscard]] Eigen::RowVectorXd integral_to(double x, const Eigen::MatrixXd& values) const;
  /// The weights of `integral_to`, one a node.
  [[nodiscard]] Eigen::RowVectorXd weights_to(double x) const;

 private:
  /// Weights of ∫₋₁^s f from the values at the nodes of the rule on [−1, 1].
  [[nodiscard]] Eigen::RowVectorXd partial_weights(double s) const;

  [[nodiscard]] double half_length(Eigen::Index panel) const;

  std::vector<double> edges_;
  Eigen::Index order_;
  Eigen::VectorXd node_, weight_;  ///< the rule on [−1, 1], increasing
  std::vector<double> nodes_, weights_;
  Eigen::MatrixXd running_;
};

}  // namespace withy
