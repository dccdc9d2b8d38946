/// \file
/// Inverse dynamics of a model's tree with every body rigid in its undeformed shape.
#pragma once

#include <memory>
#include <span>

#include "withy/core/model/model.hpp"

namespace withy {

/// The recursive Newton–Euler algorithm (Luh, Walker & Paul 1980) on the tree that the sweeps use: bodies that hinges
/// without rates join are one link, planar trees cost planar algebra. Immutable; threads share it.
class [[gnu::visibility("default")]] RigidInverseDynamics {
 public:
  explicit RigidInverseDynamics(const Model& model);

  /// Doubles of scratch space that `efforts` needs.
  [[nodiscard]] std::size_t scratch() const;
  /// Efforts [N m, N] of the hinges that, with the model's gravity and no other load, give the tree of rigid bodies the
  /// accelerations u_dot at positions x and speeds u. All four are laid out as in the model's State: modal elements of
  /// the inputs are not read, modal elements of `efforts` not written. Allocates nothing.
  void efforts(std::span<const double> x, std::span<const double> u, std::span<const double> u_dot,
               std::span<double> efforts, std::span<double> scratch) const noexcept;

  /// The recursion in one space.
  class [[gnu::visibility("hidden")]] Algorithm;

 private:
  std::shared_ptr<const Algorithm> algorithm_;
};

}  // namespace withy
