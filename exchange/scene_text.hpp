/// \file
/// A tree of links as the text of a scene, for people to read and go on with.
#pragma once

#include <string>

#include "flexible.hpp"
#include "tree.hpp"
#include "withy/scene/one_line.hpp"

namespace withy::exchange {

/// \param source the file that the tree was read from, for the comments
std::string scene_text(const Tree& tree, const FlexibleLinks& flexible, const std::string& source);

/// "[1, 2.5, 0]", each number with the digits that give it back.
std::string in_one_line(const Vector3& v);
/// The unit quaternion of a rotation matrix, [w, x, y, z], w not negative.
std::string quaternion_text(const Matrix3& R);

}  // namespace withy::exchange
