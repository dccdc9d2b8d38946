/// \file
/// One pass outward over the nodes of an observed tree, of one case or of several in lanes, and the sums over it.
#pragma once

#include <algorithm>
#include <type_traits>
#include <vector>

#include "withy/core/kinematics/observed_mass.hpp"
#include "withy/core/sweep/rod/rod_terms.hpp"
#include "withy/core/sweep/station_motion.hpp"

namespace withy::observed {

/// With V, X the twist of a node's frame in its axes and its pose in the world, S a station, M the hinge frame:
///   V_M = X_M V_S + H ẋ,   V_S = X_S V + J q̇;   where a moving section holds the hinge, V_M = X_M (X_S V + J q̇).
/// Momentum and energy are sums over the parts of the nodes, each about its own frame. Allocates nothing once made.
template <class Space>
class TreePass {
 public:
  using Scalar = typename Space::Scalar;
  using Motion = Moving<Space>;

  /// Of nodes that outlive it. \param size of State::y, whose first numbers are `positions`
  TreePass(const std::vector<Node<Space>>& nodes, std::size_t size, std::size_t positions)
      : nodes_(nodes), positions_(positions), y_(size, Scalar(0)), of_nodes_(nodes.size()) {
    std::size_t stations = 0, rods = 0, modes = 0;
    for (const Node<Space>& node : nodes) {
      stations += node.stations.size();
      if constexpr (sweep::has_rods<Space>) rods += sweep::rod_work(node.rod, node.modes);
      modes = std::max(modes, static_cast<std::size_t>(node.modes));
    }
    of_stations_.resize(stations);
    rods_.resize(rods);
    particles_.resize(modes * Space::linear);
    partials_.resize(modes);
  }

  /// The state to go to; whoever sets it moves there.
  [[nodiscard]] std::vector<Scalar>& y() { return y_; }
  void move() noexcept {
    for (std::size_t i = 0; i < nodes_.size(); ++i) move(i);
  }
  /// A station of a node, or its frame.
  [[nodiscard]] Motion motion_at(int index, int station) const noexcept {
    const Motion& B = of_nodes_[static_cast<std::size_t>(index)];
    if (station < 0) return B;
    const Node<Space>& node = nodes_[static_cast<std::size_t>(index)];
    const auto k = static_cast<std::size_t>(station);
    if (node.stations[k].needed) return of_stations_[node.first_station + k];
    const sweep::StationMotion<Space> m = section(node, station);
    return {Space::compose(B.X, m.frame), Space::to_child(m.frame, B.V) + m.rate};
  }
  /// Of a section in its body's frame; a rod's only at the state of the last `move` or `bend`.
  [[nodiscard]] sweep::StationMotion<Space> section(const Node<Space>& node, int station) const noexcept {
    sweep::StationMotion<Space> m;
    const auto k = static_cast<std::size_t>(station);
    if constexpr (sweep::has_rods<Space>) {
      if (node.is_rod()) {
        sweep::rod_station_motion<any_count>(node.rod, k, rod(node), node.modes, q(node), q_dot(node), m,
                                             partials_.data());
        return m;
      }
    }
    const auto find = [&](auto modes) {
      sweep::station_motion<Space, modes.value>(node.stations[k].fields, node.modes, q(node), q_dot(node), m,
                                                partials_.data());
    };
    if (node.modes == 2) {
      find(std::integral_constant<int, 2>{});
    } else {
      find(std::integral_constant<int, any_count>{});
    }
    return m;
  }
  /// Brings a rod alone to the state; nothing where the node is none.
  void bend(const Node<Space>& node) const noexcept {
    if constexpr (sweep::has_rods<Space>)
      if (node.is_rod()) sweep::rod_motion<any_count>(node.rod, node.modes, q(node), q_dot(node), rod(node));
  }
  [[nodiscard]] Sums<Space> sums() const noexcept {
    Sums<Space> sums;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Node<Space>& node = nodes_[i];
      add_fixed(node.base, of_nodes_[i], sums);
      for (std::size_t k = 0; k < node.stations.size() && node.stations[k].needed; ++k)
        add_fixed(node.stations[k].carried, of_stations_[node.first_station + k], sums);
      if (node.modes > 0) add_flexible(node, of_nodes_[i], sums);
      if (node.joint.kind == sweep::Joint::fixed) continue;
      const Scalar rate = y_[positions_ + node.joint.speed];
      sums.kinetic += 0.5 * node.joint.reflected * rate * rate;  // 0 of several rates
    }
    return sums;
  }
  [[nodiscard]] Scalar strain_energy() const noexcept {
    Scalar energy = 0;
    for (const Node<Space>& node : nodes_) {
      const Scalar* x = q(node);
      const Scalar* K = node.stiffness.data();
      for (int i = 0; i < node.modes; ++i) {
        Scalar force = 0;
        for (int j = 0; j < node.modes; ++j) force += *K++ * x[j];
        energy += 0.5 * x[i] * force;
      }
    }
    return energy;
  }

 private:
  using Twist = typename Space::Twist;

  [[nodiscard]] const Scalar* q(const Node<Space>& node) const { return y_.data() + node.mode_position; }
  [[nodiscard]] const Scalar* q_dot(const Node<Space>& node) const { return y_.data() + positions_ + node.mode_speed; }
  [[nodiscard]] sweep::RodWork rod(const Node<Space>& node) const requires(sweep::has_rods<Space>) {
    return sweep::rod_work_at(node.rod, node.modes, rods_.data() + node.rod_work);
  }

  void move(std::size_t index) noexcept {
    const Node<Space>& node = nodes_[index];
    bend(node);
    sweep::JointMotion<Space> joint{};  // a planar tree has hinges that set all of it; the compiler does not know that
    sweep::joint_motion<Space>(node.joint, y_.data() + node.joint.position, y_.data() + positions_ + node.joint.speed,
                               joint);
    Motion& B = of_nodes_[index];
    B = {joint.SM, joint.rate};
    if (node.parent >= 0) {
      const Node<Space>& parent = nodes_[static_cast<std::size_t>(node.parent)];
      const Motion& outer = node.parent_station < 0
                                ? of_nodes_[static_cast<std::size_t>(node.parent)]
                                : of_stations_[parent.first_station + static_cast<std::size_t>(node.parent_station)];
      B.X = Space::compose(outer.X, joint.SM);
      B.V += Space::to_child(joint.SM, outer.V);
    }
    if (node.root_station >= 0) {
      const sweep::StationMotion<Space> root = section(node, node.root_station);
      const typename Space::Frame BM = Space::compose(root.frame, node.M);
      B.V = Space::from_child(BM, B.V - Space::to_child(node.M, root.rate));
      B.X = Space::compose(B.X, Space::inverse(BM));
    }
    for (std::size_t k = 0; k < node.stations.size() && node.stations[k].needed; ++k) {
      const sweep::StationMotion<Space> m = section(node, static_cast<int>(k));
      of_stations_[node.first_station + k] = {Space::compose(B.X, m.frame), Space::to_child(m.frame, B.V) + m.rate};
    }
  }

  void add_flexible(const Node<Space>& node, const Motion& B, Sums<Space>& sums) const noexcept {
    PartMomentum<Space> part;
    if (node.is_rod()) {
      if constexpr (sweep::has_rods<Space>) add_rod(node.rod, rod(node), node.modes, q_dot(node), B.V, part);
    } else {
      add_own_mass(node, B.V, part);
      if constexpr (sweep::has_sections<Space>) add_sections(node.rotary, node.modes, q(node), q_dot(node), B.V, part);
    }
    add_part<Space>(B.X, part.h, part.moment, part.mass, part.kinetic, node.flexible_height, sums);
  }

  void add_own_mass(const Node<Space>& node, const Twist& V, PartMomentum<Space>& part) const noexcept {
    if constexpr (sweep::has_straight_mass<Space, 2>) {
      const Scalar* const products = node.mass.products.data();
      if (products != nullptr && node.modes == 2)
        return add_straight_mass<Space, 2>(products, q(node), q_dot(node), V, part);
      if (products != nullptr) return add_straight_mass<Space, 4>(products, q(node), q_dot(node), V, part);
    }
    if (node.modes == 2)
      add_mass<Space, 2>(node.mass, 2, q(node), q_dot(node), V, particles_.data(), part);
    else
      add_mass<Space, any_count>(node.mass, node.modes, q(node), q_dot(node), V, particles_.data(), part);
  }

  const std::vector<Node<Space>>& nodes_;
  std::size_t positions_;
  std::vector<Scalar> y_;
  std::vector<Motion> of_nodes_;
  std::vector<Motion> of_stations_;  ///< of all nodes; those that carry something
  mutable std::vector<Pack> rods_;
  mutable std::vector<typename Space::Group> particles_;
  mutable std::vector<Twist> partials_;
};

}  // namespace withy::observed
