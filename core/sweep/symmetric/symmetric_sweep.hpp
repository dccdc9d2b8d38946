/// \file
/// Forward dynamics where the mass matrix is symmetric – ruthless nodes and nodes without truncation – in time
/// proportional to the number of bodies: the articulated-body recursion (Featherstone 1983) with a body's modal
/// coordinates eliminated together with its hinge (Jain & Rodriguez 1992).
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/terms.hpp"
#include "withy/core/sweep/branches.hpp"
#include "withy/core/sweep/joint_step.hpp"
#include "withy/core/sweep/mass_table.hpp"
#include "withy/core/sweep/rod/rod_kinematics.hpp"
#include "withy/core/sweep/rod/rotary_table.hpp"
#include "withy/core/sweep/shared_value.hpp"
#include "withy/core/sweep/station_motion.hpp"

namespace withy::sweep {

/// What of a node the compiler knows: rigid; ruthless; its modes without truncation, of expanded or exact kinematics.
enum class Flavor { rigid, frozen, full, exact };

/// A station in a symmetric sweep.
template <class Space>
struct SymmetricStation {
  Fields<Space> fields;
  bool loaded = false;  ///< it carries mass or children
  bool has_children = false;
  std::size_t work_I = 0;                  ///< where its children sum their articulated inertia
  SharedNumbers<typename Space::Twist> J;  ///< at q = 0
  SharedValue<RigidPart<Space>> carried;   ///< rigid bodies it carries; nothing in a frozen node
};

/// What a node's body is, wherever it stands: equal bodies in equal company share it.
template <class Space>
struct SymmetricBody {
  using Twist = typename Space::Twist;

  SharedValue<RigidPart<Space>> base;  ///< the rigid part; everything in a frozen node
  std::vector<SymmetricStation<Space>> stations;
  SharedNumbers<typename Space::Scalar> stiffness, damping;  ///< n×n
  // Frozen nodes: theory (3) at order zero.
  SharedNumbers<Twist> C0;
  SharedNumbers<typename Space::Scalar> G0;
  SharedNumbers<Variation<Space>> I1;  ///< h_k = −½ Vᵀ I1_k V
  // The others.
  MassTable<Space> mass;
  RotaryTable<Space> rotary;
  // Frozen leaves: the eliminated modal block, once for ever.
  std::vector<typename Space::Scalar> factor;    ///< of G0, see factorize
  std::vector<Twist> Y0;                         ///< L⁻¹ C0ᵀ, n twists
  SharedValue<typename Space::Inertia> reduced;  ///< base − Y0ᵀ Δ⁻¹ Y0
  SharedValue<typename Space::Frame> M;          ///< hinge frame in the root station's section, where there is one
  SharedValue<RodKinematics<Space>> rod;         ///< in place of mass and rotary inertia where kinematics is exact
};

/// Constants of a node. What all passes read stands first and together: long chains are limited by the memory that goes
/// through the caches, so what equal nodes have in common stands elsewhere, once.
template <class Space>
struct SymmetricNode {
  int body = 0, parent = -1, parent_station = -1, root_station = -1, modes = 0;
  /// Frozen is ruthless: integrals at q = 0, velocity terms at q̇ = 0; sections parallel to the node's frame.
  Flavor flavor = Flavor::rigid;
  bool leaf = true;            ///< nothing hangs on it
  bool has_children = false;   ///< on its frame, not on a station
  bool begins = false;         ///< it is the first to write the sum of inertias of what it hangs on
  bool begins_frozen = false;  ///< and of the velocity wrench, of a station that carries nothing else
  SharedValue<SymmetricBody<Space>> own;
  std::size_t mode_position = 0, mode_speed = 0;
  // Work memory.
  std::size_t work = 0, work_stations = 0, work_C = 0, work_G = 0, work_y = 0, work_J = 0;
  std::size_t work_I = 0;        ///< where its children sum their articulated inertia
  std::size_t work_outer_I = 0;  ///< the same of what it hangs on
  JointData<Space> joint;
  std::size_t work_frames = 0;  ///< of the stations in the node's frame; a frozen node has none
  std::size_t work_h = 0, work_P = 0, work_rod = 0, work_rod_mass = 0, work_root = 0, work_elimination = 0,
              work_driven = 0;

  SymmetricNode() = default;
  /// \param twin a node whose body's mass is the same, in the same place and terms; null: there is none
  SymmetricNode(const NodeSpec& spec, Terms terms, const SymmetricNode* twin = nullptr);
};

template <class Space>
struct SymmetricState;

/// The sweep over all nodes.
template <class Space>
class SymmetricSweep {
 public:
  /// `terms` of each node.
  SymmetricSweep(const NodeTree& tree, const std::vector<Terms>& terms, const Vector3& gravity);
  /// Bytes of work memory.
  [[nodiscard]] std::size_t work_size() const { return work_size_; }
  [[nodiscard]] const std::vector<SymmetricNode<Space>>& nodes() const { return nodes_; }
  /// −g: weight as an acceleration of the world.
  [[nodiscard]] const typename Space::Twist& world_acceleration() const { return world_acceleration_; }
  /// What was computed once for all evaluations, a line each.
  [[nodiscard]] std::vector<std::string> savings(const NodeTree& tree) const;
  /// Accelerations of all speeds from positions, speeds and applied efforts. Those of driven speeds are given in
  /// `result`; all efforts on them, the applied ones among them, are left in `efforts`. With M + δ D + δ² K in the
  /// place of M.
  Evaluation accelerations(const double* positions, const double* speeds, double* efforts, double delta, double* result,
                           std::byte* work) const noexcept;
  /// M u̇ − f from positions, speeds and accelerations; with `inertial` alone, M u̇: speeds, weight and K q count as
  /// zero.
  void inverse(const double* positions, const double* speeds, const double* accelerations, bool inertial,
               double* efforts, std::byte* work) const noexcept;
  /// Leaves in `work` the factors of M + δ D + δ² K; `at_rest` are zeros, one for each speed.
  Evaluation factorize(const double* positions, const double* at_rest, double delta, std::byte* work) const noexcept;
  /// Solves (M + δ D + δ² K) result = forces with these factors.
  void solve(const double* forces, double delta, double* result, std::byte* work) const noexcept;

  // The passes over a part of the nodes of a state. A node's numbers come from one code whoever asks for it: the same
  // bits.
  static void outward_motions(const SymmetricState<Space>& state, NodeRange nodes) noexcept;
  /// \returns the first node whose block cannot be solved; null: there is none
  static const SymmetricNode<Space>* inward_inertias(const SymmetricState<Space>& state, NodeRange nodes) noexcept;
  static void outward_accelerations(const SymmetricState<Space>& state, NodeRange nodes) noexcept;
  /// The three, one after the other.
  static Evaluation accelerations(const SymmetricState<Space>& state, NodeRange nodes) noexcept;

 private:
  [[nodiscard]] NodeRange all() const { return {0, nodes_.size()}; }

  std::vector<SymmetricNode<Space>> nodes_;
  typename Space::Twist world_acceleration_;
  std::size_t work_size_ = 0;
};

extern template class SymmetricSweep<Spatial>;
extern template class SymmetricSweep<Planar>;

}  // namespace withy::sweep
