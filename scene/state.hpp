/// \file
/// States as values: the form under `initial` of a scene and in state files.
#pragma once

#include "withy/core/model/model.hpp"
#include "withy/scene/check.hpp"

namespace withy {

/// A hinge's or frame's quaternion w, x, y, z in `q`, scaled to unit length where it is off by rounding alone (1e-14 to
/// 1e-6); false after reporting where it is not one.
bool accept_quaternion(std::span<double> q, const Place& place, Diagnostics& diagnostics);

/// Sets what `value` names in `state`. \returns false after reporting problems.
bool set_state(const Value& value, const Model& model, const Checker& checker, State& state);

}  // namespace withy
