/// \file
/// How long a scene runs.
#pragma once

#include "withy/scene/check.hpp"
#include "withy/scene/scene.hpp"

namespace withy {

/// Sets the end of a scene that has its initial state: what its `time` says, or else the latest end of its loads and
/// motions, if any has one. Reports ends before the beginning, and outputs and samples that are too many.
void set_span(const Model& model, const Document& document, const Checker& checker, Scene& scene);

}  // namespace withy
