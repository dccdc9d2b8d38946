/// \file
/// Springs and dampers of joints that a file gives by how the joint comes to rest.
#pragma once

#include "tree.hpp"

namespace withy {
struct Scene;
}

namespace withy::exchange {

/// Whether a joint has a Relaxation.
bool has_relaxation(const Tree& tree);

/// Sets stiffness and damping of the joints that have a Relaxation, from the inertia I that a joint feels in the pose
/// of the file while all others are free: k = I/(T ζ)², c = 2 I/T. I counts the armature of every joint, as in MuJoCo.
/// \param rigid the scene made of the tree, all links rigid
void settle_relaxation(Tree& tree, const Scene& rigid, Diagnostics& diagnostics);

}  // namespace withy::exchange
