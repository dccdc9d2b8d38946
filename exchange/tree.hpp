/// \file
/// A tree of rigid links as other programs describe it, before it becomes a scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/value.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy::exchange {

/// A link. Its frame is that of its file.
struct Link {
  std::string name;
  Place place;
  double mass = 0;                    ///< [kg]
  Vector3 center = Vector3::Zero();   ///< of mass, link frame [m]
  Matrix3 inertia = Matrix3::Zero();  ///< about the centre of mass, link axes [kg m²]
};

/// A spring and damper by how the joint comes to rest, MuJoCo's `springdamper`.
struct Relaxation {
  double time = 0;                    ///< constant of the decay [s]
  double ratio = 0;                   ///< of the damping to the critical one
  bool spring = true, damper = true;  ///< which of the two acts
};

/// What holds a link.
struct Joint {
  std::string name;
  Place place;
  std::string type = "weld";        ///< a hinge of withy
  Vector3 axis = Vector3::UnitX();  ///< of `revolute` and `prismatic`; normal of `planar`; axes of F
  int parent = -1;                  ///< index among the links; −1: world
  int child = 0;
  Pose offset;                           ///< of the hinge frame F in the parent link's frame
  Vector3 point = Vector3::Zero();       ///< of the hinge frame M in the child's frame, whose axes it has
  double stiffness = 0, damping = 0;     ///< of a spring and damper on the coordinate
  double free_position = 0;              ///< where the spring is slack
  std::optional<Relaxation> relaxation;  ///< gives stiffness and damping (relaxation.hpp)
  double armature = 0;                   ///< inertia on each speed; of joints of several for relaxations alone
  std::string remark;                    ///< what the file says beside, for the scene's comment

  /// Whether its armature stands in the scene.
  [[nodiscard]] bool has_reflected_inertia() const {
    return armature > 0 && (type == "revolute" || type == "prismatic");
  }
};

struct Tree {
  std::string name;
  Vector3 gravity = Vector3(0, 0, -9.81);  ///< world axes [m/s²]
  std::string gravity_remark;              ///< where it comes from
  std::vector<Link> links;
  std::vector<Joint> joints;         ///< one for each link, in the same order
  std::vector<std::string> remarks;  ///< what was left out or chosen, a sentence each
};

/// Checks names against the rules of scenes, replacing what they may not have (with a remark), and that every part
/// that moves has mass or inertia, or carries some.
void check_tree(Tree& tree, Diagnostics& diagnostics);

}  // namespace withy::exchange
