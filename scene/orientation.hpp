/// \file
/// How a scene says how something is turned.
#pragma once

#include <vector>

#include "withy/scene/check.hpp"

namespace withy {

/// Whether a parameter is an orientation: a vector of four numbers without a unit, named so. Its checked value is the
/// quaternion w, x, y, z, whichever form the scene has.
bool is_orientation(const ParameterSpec& spec);

/// The forms that an orientation takes beside the quaternion [w, x, y, z], for schemas:
///   {axis: [x, y, z], angle: a}   turned by a about the axis, of any length but zero
///   {xyz: [a, b, c]}              turned by a about x, then by b about the new y, then by c about the new z
std::vector<std::vector<ParameterSpec>> orientation_forms();

/// The unit quaternion of such a map, at the map's place; nothing after reporting what is wrong with it.
std::optional<Value> read_orientation(const Value& map, const Checker& checker);

}  // namespace withy
