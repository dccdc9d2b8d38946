/// \file
/// What a scene is made of and what its compilation saved.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/study/prepared.hpp"

namespace withy {

/// A plugin in use: "body/beam" and the file it came from.
struct LoadedPlugin {
  std::string name, file;
};

/// Bodies, loads, motions, coordinates, savings, plugins, and the mass matrix at a state: condition, attainable
/// accuracy of accelerations, nearly massless directions; modes with their families, and how the state stands against
/// the limits of the formulation. The matrix is null for models too large to look at.
nlohmann::ordered_json inspection_json(const study::Prepared& prepared, const State& state, Registry& registry,
                                       const std::vector<LoadedPlugin>& plugins);
/// The same in words, with the tree drawn. \param inspection of inspection_json for this scene
std::string inspection_text(const Scene& scene, const nlohmann::ordered_json& inspection);

}  // namespace withy
