/// \file
/// The Unified Robot Description Format of ROS: robots to trees of links, and back.
#pragma once

#include <string>

#include "tree.hpp"
#include "xml.hpp"

namespace withy {
class Model;
}

namespace withy::exchange {

/// Reads <robot> of versions 1.0 to 1.2. Frames: a link has the frame of its joint; `rpy` turns about fixed x, then y,
/// then z.
/// \param free_base whether the root link floats; otherwise it is fixed to the world. A root link called "world"
/// without inertia is the world itself, unless it is to float with what is fixed to it. \param mend_inertias as
/// InertiaRule
Tree read_urdf(const Element& robot, bool free_base, bool mend_inertias, Diagnostics& diagnostics);

struct Urdf {
  std::string text;
  std::vector<std::string> remarks;  ///< what it cannot say, a sentence each
};
/// A model as URDF: hinges become joints, bodies links in the frame of their hinge, flexible ones rigid in their
/// undeformed shape. \throws std::domain_error where a hinge has no joint in URDF (spherical, screw)
Urdf write_urdf(const Model& model, const std::string& name);

}  // namespace withy::exchange
