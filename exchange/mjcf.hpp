/// \file
/// The tree of MuJoCo's MJCF: bodies, joints and inertias; no actuators, contacts, tendons or constraints.
#pragma once

#include "tree.hpp"
#include "xml.hpp"

namespace withy::exchange {

/// Reads <mujoco>. A body has the frame of its file; a body with several joints hangs on links without mass between
/// them, in their order. Masses come from <inertial>, else from geoms. What has no place in a scene is remarked upon;
/// what would change the tree (<include>, <frame>, <replicate>, …) is an error.
Tree read_mjcf(const Element& mujoco, Diagnostics& diagnostics);

}  // namespace withy::exchange
