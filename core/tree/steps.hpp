/// \file
/// The steps of compile_placed_tree.
#pragma once

#include <optional>

#include "withy/core/tree/placed_tree.hpp"

namespace withy::compilation {

inline Pose at(const Vector3& p) { return {Matrix3::Identity(), p}; }
inline Pose turned(const Matrix3& R) { return {R, Vector3::Zero()}; }

/// The model's bodies as nodes, rigid neighbours merged.
PlacedTree merge(const Model& model);
/// The normal of the plane in which everything moves, world axes; nothing where there is none.
std::optional<Vector3> plane_normal(const NodeTree& tree);
/// A rotation whose third column is z and whose first is as near to the x axis as can be.
Matrix3 basis_near_x(const Vector3& z);
/// Turns the hinge frames so that a revolute axis is the third axis and a prismatic axis the first; in a plane the
/// third axis is the normal. The node's frame becomes the hinge frame M where the hinge holds the node's frame.
void align(PlacedTree& tree);
/// Whether the modes move a section in the plane with this normal alone, both in one frame's axes.
bool fields_in_plane(const PlacedPoint& point, const Vector3& normal);
inline bool fields_in_plane(const PointExpansion& e, const Vector3& normal) {
  return fields_in_plane(PlacedPoint(e), normal);
}

}  // namespace withy::compilation
