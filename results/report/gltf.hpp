/// \file
/// Motions as glTF 2.0, for programs that draw in three dimensions.
#pragma once

#include <string>
#include <vector>

#include "withy/results/report/animation.hpp"

namespace withy {

/// A binary file (.glb) that needs no other: each run a node, under it each body a node that is moved from key to key;
/// flexible bodies are deformed by morph targets, shapes whose weights change from key to key. They are the fewest
/// that leave no vertex farther off, at any key, than 1e-4 of the greatest displacement of its body. Far from the
/// world's origin the bodies are under a node that goes along with the first one, from the file's origin, whose place
/// in the world [m] the run's node tells as `extras.origin`.
std::string gltf_binary(const std::vector<Animation>& runs);

}  // namespace withy
