/// \file
/// Models of other programs to scenes: what `withy import` does with files that are no meshes.
#pragma once

#include <string>
#include <vector>

namespace withy {
class Registry;
}

namespace withy::exchange {

struct ModelImport {
  std::string file;        ///< .urdf, .xml (URDF or MJCF, by its root element), .dat (ElastoDyn)
  std::string flexible;    ///< file that makes links flexible; empty: none. Of URDF and MJCF.
  bool free_base = false;  ///< whether the root link of a URDF floats
  double length = 0;       ///< of an ElastoDyn blade or tower [m]
  double tip_mass = 0;     ///< on the tip of it [kg]
};

struct ImportedScene {
  std::string text;                  ///< of the scene
  std::string from;                  ///< what the file was, as "URDF"
  std::vector<std::string> remarks;  ///< what was left out, a sentence each
};

/// Whether a file is a model by its name, and not a mesh.
bool is_model_file(const std::string& file);

/// Reads, translates, and checks the scene. \throws SceneError with every problem and its place in the files;
/// std::system_error where they cannot be read; std::invalid_argument where an option does not fit the file.
ImportedScene import_model(const ModelImport& what, Registry& registry);

}  // namespace withy::exchange
