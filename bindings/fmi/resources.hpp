/// \file
/// What an FMU carries of its scene: resources/withy.json, and the scene with its files in resources/scene/.
#pragma once

#include <string>

#include "withy/scene/scene.hpp"

namespace withy::fmi {

inline constexpr const char* recipe_file = "withy.json";
inline constexpr const char* scene_folder = "scene";

/// Text of withy.json: the name of the scene's file, and what was asked for beyond it.
std::string write_recipe(const std::string& scene_file, const SceneOptions& options);

/// The scene's values as they were when it was exported. \param resources folder
/// \throws std::runtime_error, SceneError where they cannot be read.
SceneValues read_resources(const std::string& resources);

/// The folder that `fmuResourceLocation` of FMI 2.0 (a URI) or `resourcePath` of FMI 3.0 names.
/// \throws std::invalid_argument where the URI is of no file of this machine.
std::string folder_of(std::string_view location);

}  // namespace withy::fmi
