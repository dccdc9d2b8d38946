/// \file
/// Which links of a tree are beams: a small YAML file beside a URDF or MJCF.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "tree.hpp"
#include "withy/scene/document.hpp"

namespace withy::exchange {

/// A link as a beam from `root` to `tip`, points of the link's frame [m].
struct FlexibleLink {
  Pose beam;          ///< of the beam's body frame (x along it) in the link's frame
  double length = 0;  ///< [m]
  Value parameters;   ///< of the body `beam` as the file has them, but for its length
};

struct FlexibleLinks {
  std::string file;  ///< empty: none
  Document document;
  std::map<int, FlexibleLink> of_link;  ///< by index in the tree
};

/// Reads
///   format: withy-flexible/1
///   links: {upper_arm: {tip: elbow, y: [0, 1, 0], bending_y: {stiffness: 80, modes: 2}, …}}
/// where `tip` is a joint of the link or a point, `root` a point (default: the link's origin), `y` a direction.
/// \throws SceneError with every problem and its place.
FlexibleLinks read_flexible(std::string_view text, const std::string& file, const Tree& tree);

}  // namespace withy::exchange
