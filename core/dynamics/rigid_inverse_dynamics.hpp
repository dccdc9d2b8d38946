/// \file
/// Inverse dynamics of a model's tree with every body rigid in its undeformed shape: the recursive Newton–Euler
/// algorithm (Luh, Walker & Paul 1980) in the axes of each hinge's frame M.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/spatial/space.hpp"

namespace withy {

/// Immutable; threads share it. Bodies that hinges without rates join are one link, so the cost is that of the moving
/// hinges alone.
class RigidInverseDynamics {
 public:
  explicit RigidInverseDynamics(const Model& model);

  /// Doubles of scratch space that `efforts` needs.
  [[nodiscard]] std::size_t scratch() const { return scratch_; }
  /// Efforts [N m, N] of the hinges that, with the model's gravity and no other load, give the tree of rigid bodies the
  /// accelerations u_dot at positions x and speeds u. All four are laid out as in the model's State: modal elements of
  /// the inputs are not read, modal elements of `efforts` not written. Allocates nothing.
  void efforts(std::span<const double> x, std::span<const double> u, std::span<const double> u_dot,
               std::span<double> efforts, std::span<double> scratch) const noexcept;

 private:
  /// What one moving hinge carries. Inertia is about the origin of the hinge's frame M, in its axes.
  struct Link {
    std::shared_ptr<const Hinge> hinge;
    Slot slot;        ///< of the hinge in the model's layout
    int parent = -1;  ///< link; −1: world
    Pose X_PF;        ///< hinge frame F in the parent link's M, or in the world
    Spatial::Matrix inertia = Spatial::Matrix::Zero();
    std::size_t scratch = 0;  ///< where its part of the scratch space begins
  };

  std::vector<Link> links_;
  Vector3 gravity_;
  std::size_t scratch_ = 0;
};

}  // namespace withy
