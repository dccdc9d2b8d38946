/// \file
/// Forward dynamics of one or two hinges of a rigid tree whose efforts are limited.
#pragma once

#include <vector>

#include "withy/core/sweep/rigid_inverse_dynamics.hpp"

namespace withy {

/// A hinge with one coordinate, where it goes [rad, m] and the greatest |effort| it has [N m, N].
struct LimitedAxis {
  std::size_t position = 0;
  std::size_t speed = 0;
  double from = 0;
  double to = 0;
  double limit = 0;
};

/// The rigid tree with the limited axes alone free to move; the others rest at their reference. For set-up, in one
/// thread: it keeps its scratch space.
class LimitedTree {
 public:
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1>;  ///< coordinates, then rates

  LimitedTree(const Model& model, std::vector<LimitedAxis> axes);
  [[nodiscard]] const std::vector<LimitedAxis>& axes() const { return axes_; }
  /// Time derivative of (x, ẋ) under efforts, one for each axis: M ẍ = τ − ID(x, ẋ, 0).
  [[nodiscard]] Vector derivative(const Vector& state, const double* efforts) const;
  /// Efforts that hold the axes where each is by `place`: &LimitedAxis::from, &LimitedAxis::to.
  [[nodiscard]] std::vector<double> holding(double LimitedAxis::*place) const;

 private:
  /// ID of the tree, for accelerations that are zero but for that of `moving` (−1: none), which is one.
  void inverse(const Vector& state, int moving, double* efforts) const;

  RigidInverseDynamics dynamics_;
  std::vector<LimitedAxis> axes_;
  mutable std::vector<double> x_, u_, u_dot_, tau_,
      scratch_;  ///< all elements of hinges that rest stay as they were made
};

}  // namespace withy
