/// \file
/// Where a scene begins.
#pragma once

#include "withy/scene/check.hpp"
#include "withy/scene/scene.hpp"

namespace withy {

/// Sets the initial state of a scene whose values are read: where the loads begin, then what its `initial` says; driven
/// hinges where their motions have them, loops closed. Problems are reported to the checker's diagnostics.
void set_start(const Model& model, const Document& document, const Checker& checker, Scene& scene);

}  // namespace withy
