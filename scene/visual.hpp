/// \file
/// How a scene wants a body drawn. It changes pictures alone, and no number of a result.
#pragma once

#include <set>
#include <string>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/parameters.hpp"

namespace withy {

/// The member `visual` of a body.
ParameterSpec visual_spec();
/// Reports what cannot be drawn of a checked value: shapes that are missing or too many, a mesh that cannot be read, a
/// shape that this body cannot have. \param directory where relative names of files begin
/// \return whether all is well
bool check_visual(const Value& visual, const Body& body, const std::string& directory, Diagnostics& diagnostics);

/// Files of the meshes that bodies name, each once, as the scene has them. \param bodies as checked
std::set<std::string> meshes_of(const Value& bodies);

}  // namespace withy
