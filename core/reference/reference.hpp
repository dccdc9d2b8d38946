/// \file
/// The plain way to the equations of motion: explicit Jacobians of every particle, M = Σ m JᵀJ, f = −Σ m Jᵀ(a_bias −
/// g). It costs O(bodies · speeds²), allocates, and is what the sweeps are checked against; `withy eval` prints it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

struct RodTable;

namespace reference {
struct PlacedWrench;
template <class S>
class ReferenceTree;
}  // namespace reference

/// Dense reference dynamics of a model. Const functions allocate; they may throw std::bad_alloc.
class ReferenceDynamics {
 public:
  /// `terms` hold for every body that has none of its own.
  /// \throws std::invalid_argument as Model::require_rods.
  ReferenceDynamics(std::shared_ptr<const Model> model, Terms terms);

  /// M and f of M u̇ = f (theory (3) for the strict truncation), and the loads' efforts at t.
  [[nodiscard]] DenseSystem system(double t, std::span<const double> y) const;
  /// Energies of the strain kinematics without truncation.
  [[nodiscard]] Energies energies(std::span<const double> y) const;
  [[nodiscard]] WorldPose frame_pose(std::span<const double> y, int body, int frame) const;
  [[nodiscard]] std::array<double, 3> deflection(std::span<const double> y, int body, int frame) const;

 private:
  [[nodiscard]] Terms terms_of(std::size_t body) const;
  /// Those of all loads, given at the deformation that the truncations keep.
  [[nodiscard]] std::vector<reference::PlacedWrench> wrenches_at(double t, std::span<const double> y) const;
  /// Every body in its own strain kinematics, without truncation.
  [[nodiscard]] reference::ReferenceTree<double> untruncated(std::span<const double> y) const;

  std::shared_ptr<const Model> model_;
  Terms terms_;
  std::vector<const Slot*> slots_;                     ///< of each body's modes; null where it has none
  std::vector<std::shared_ptr<const RodTable>> rods_;  ///< one a body; null where its kinematics is an expansion
};

}  // namespace withy
