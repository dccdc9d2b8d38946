/// \file
/// The tree as the sweeps see it: bodies welded rigidly to each other, or to a station of a flexible body, have become
/// one node; frames are aligned with the hinges. Values in three dimensions; the sweeps take from it what they need.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/tree/placed_mass.hpp"

namespace withy {

/// Mass of a rigid part about the origin of the frame it is fixed to, in that frame's axes.
struct RigidInertia {
  double mass = 0;                    ///< [kg]
  Vector3 moment = Vector3::Zero();   ///< Σ m r [kg m]
  Matrix3 inertia = Matrix3::Zero();  ///< Σ m (r·r 1 − r rᵀ) [kg m²]

  [[nodiscard]] bool empty() const { return mass == 0 && inertia.isZero(0) && moment.isZero(0); }
  /// The same part seen from frame A, X_AB the pose of its own frame B in A.
  [[nodiscard]] RigidInertia seen_from(const Pose& AB) const;
  RigidInertia& operator+=(const RigidInertia& other);
};

/// A section of a node's flexible body where children or rigid bodies are attached.
struct StationSpec {
  PointExpansion at;
  RigidInertia carried;  ///< rigid bodies welded to the section, section axes and origin
};

/// A movable body with its inboard hinge. Fields of the flexible part are in the node's frame.
struct NodeSpec {
  std::string name;
  int body = 0;             ///< model body whose modes the node has, or its first rigid one
  int parent = -1;          ///< node; −1: world
  int parent_station = -1;  ///< station of the parent's node; −1: its frame
  Pose F;                   ///< hinge frame in the parent station's section, the parent node's frame, or the world
  std::shared_ptr<const Hinge> hinge;
  std::optional<HingeKernel> kernel;
  double direction = 1;   ///< ±1: sense of the hinge coordinate about or along the aligned axis
  Slot slot;              ///< of the hinge
  bool driven = false;    ///< a motion prescribes the hinge's rates
  double reflected = 0;   ///< HingeNode::reflected_inertia
  int root_station = -1;  ///< station that the inboard hinge holds; −1: the node's frame
  Pose M;                 ///< hinge frame in that section or the node's frame (then identity once aligned)

  std::size_t modes = 0;
  std::size_t mode_position = 0;  ///< first modal coordinate among the positions
  std::size_t mode_speed = 0;
  RigidInertia base;  ///< rigid bodies fixed to the node's frame
  PlacedMass mass;
  Eigen::MatrixXd stiffness, damping;
  std::vector<StationSpec> stations;
  const Rod* rod = nullptr;  ///< of the model's body
  Pose rod_frame;            ///< that body's frame in the node's
};

/// The nodes, parents first.
struct NodeTree {
  std::vector<NodeSpec> nodes;
  bool planar = false;
  Pose plane;                        ///< when planar: the plane's frame in the world, z its normal
  std::vector<std::string> savings;  ///< what was merged and recognised, a line each
};

/// Merges and aligns. When the motion of every node stays in one plane the tree is planar, and each node's frame and
/// station has its third axis along the plane's normal.
NodeTree compile_tree(const Model& model);

/// Expansion in a frame A of a point given in B; the section's axes become parallel to A.
PointExpansion moved(const PointExpansion& e, const Pose& AB);
/// Expansion of a point relative to the frame fixed at `M` to the section `root`, second order (exact for strict and
/// ruthless truncation). Frames: everything given in the body frame, the result in the frame M.
PointExpansion relative_to(const PointExpansion& e, const PointExpansion& root, const Pose& M);

}  // namespace withy
