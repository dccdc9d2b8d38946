/// \file
/// From the bodies and hinges of a scene to a model.
#pragma once

#include <memory>

#include "withy/core/model/model.hpp"
#include "withy/scene/check.hpp"
#include "withy/scene/scene.hpp"

namespace withy {

/// The tree of a scene.
struct SceneTree {
  std::unique_ptr<Model> model;  ///< null after reported problems
  SceneNames names;              ///< of all bodies and hinges in the scene, right or wrong
  Value bodies;                  ///< checked
  std::vector<BodyModes> modes;  ///< of Scene
  Value hinges;                  ///< checked
};

/// Checks bodies and hinges, makes them, and puts them together. Null values stand for missing ones. A station of a
/// body becomes a frame where a hinge or `scene`, the whole scene as it is given, names it.
SceneTree build_tree(const Value& bodies, const Value& hinges, const Value& scene, const Vector3& gravity,
                     const Checker& checker);

/// Bytes of memory that the modes asked for in a body's checked value need, at most about: by far the greatest part of
/// a model.
double predicted_bytes(const Value& body, const std::vector<ParameterSpec>& specs);

}  // namespace withy
