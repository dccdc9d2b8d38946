/// \file
/// Orientations as people tell them: an axis and an angle, or turns about x, y and z.
#pragma once

#include <optional>

#include "withy/scene/check.hpp"

namespace withy {

/// Whether the specification is that of a unit quaternion `orientation`, which a map may tell too.
bool is_orientation(const ParameterSpec& spec);
/// The quaternion w x y z of `{axis: [x, y, z], angle: rad}`, the axis of any length, or of `{xyz: [rad, rad, rad]}`,
/// intrinsic turns R = R_x R_y R_z. Nothing after reporting what is wrong.
std::optional<Value> orientation_of(const Value& map, const Checker& checker);

}  // namespace withy
