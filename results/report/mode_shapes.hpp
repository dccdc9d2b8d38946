/// \file
/// Where the points of a body are at its modal coordinates: what does not change over a run, and what does.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "withy/core/shape/modal_shape.hpp"

namespace withy {

/// Displacements Φ q + ½ qᵀ Γ q of many points [m, body axes] as a sum of fixed shapes: one for each modal coordinate,
/// and where the second order is kept, one for each product q_k q_l, k ≤ l. A moment takes as many numbers as there are
/// shapes, however many points there are.
class ModeShapes {
 public:
  ModeShapes() = default;
  /// Of points that are expanded in the same coordinates. \param second_order whether Γ is kept
  ModeShapes(const std::vector<PointExpansion>& points, bool second_order);
  /// \param first 3V×n, Φ of V points below each other
  /// \param second 3V×n(n+1)/2, Γ_kl of the pairs k ≤ l, k outermost; without columns: none
  ModeShapes(const Eigen::MatrixXf& first, const Eigen::MatrixXf& second);

  /// 3V×shapes, to be summed with `weights`.
  [[nodiscard]] const Eigen::MatrixXf& shapes() const { return shapes_; }
  /// How much there is of each shape at the modal coordinates q.
  [[nodiscard]] Eigen::VectorXf weights(std::span<const double> q) const;

 private:
  void scale_squares();

  Eigen::Index modes_ = 0;
  Eigen::MatrixXf shapes_;
};

}  // namespace withy
