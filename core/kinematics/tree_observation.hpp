/// \file
/// An observation of a tree: one pass outward to a state, from which all else is read.
#pragma once

#include "withy/core/kinematics/observed_tree.hpp"
#include "withy/core/sweep/rod/rod_terms.hpp"
#include "withy/core/sweep/station_motion.hpp"

namespace withy::observed {

/// With V, X the twist of a node's frame in its axes and its pose in the world, S a station, M the hinge frame:
///   V_M = X_M V_S + H ẋ,   V_S = X_S V + J q̇;   where a moving section holds the hinge, V_M = X_M (X_S V + J q̇).
/// Momentum and energy are sums over the parts of the nodes, each about its own frame.
template <class Space>
class TreeObservation final : public Observation {
 public:
  explicit TreeObservation(std::shared_ptr<const Tree<Space>> tree);
  void observe(std::span<const double> y) noexcept override;
  [[nodiscard]] Energies energies() const noexcept override;
  [[nodiscard]] WorldPose frame_pose(int body, int frame) const noexcept override;
  [[nodiscard]] WorldVelocity frame_velocity(int body, int frame) const noexcept override;
  [[nodiscard]] std::array<double, 3> deflection(int body, int frame) const noexcept override;

 private:
  using Twist = typename Space::Twist;
  using Motion = Moving<Space>;

  [[nodiscard]] const double* q(const Node<Space>& node) const { return y_.data() + node.mode_position; }
  [[nodiscard]] const double* q_dot(const Node<Space>& node) const {
    return y_.data() + tree_->positions + node.mode_speed;
  }
  [[nodiscard]] sweep::RodWork rod(const Node<Space>& node) const {
    return sweep::rod_work_at(node.rod, node.modes, rods_.data() + node.rod_work);
  }
  void move(std::size_t index) noexcept;
  [[nodiscard]] sweep::StationMotion<Space> section(const Node<Space>& node, int station) const noexcept;
  /// A station of a node, or its frame.
  [[nodiscard]] Motion motion_at(int node, int station) const noexcept;
  void add_flexible(std::size_t index, Sums<Space>& sums) const noexcept;
  [[nodiscard]] double strain_energy() const noexcept;

  std::shared_ptr<const Tree<Space>> tree_;
  std::vector<double> y_;
  std::vector<Motion> nodes_;
  std::vector<Motion> stations_;  ///< of all nodes; those that carry something
  mutable std::vector<Pack> rods_, particles_;
  mutable std::vector<Twist> partials_;
};

}  // namespace withy::observed
