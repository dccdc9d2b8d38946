/// \file
/// What an import of a mesh found, as JSON and in words.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/fem/import.hpp"

namespace withy::fem {

/// Mass, modes with effective masses, nodes, geometric stiffness, and what is missing.
/// \param file of Standard Input Data that is written
nlohmann::ordered_json import_json(const Imported& imported, const std::string& file);
/// The same in words. \param report of import_json
std::string import_text(const nlohmann::ordered_json& report);
/// Lines of a scene that use the file.
std::string scene_snippet(const std::string& file, const Imported& imported);
/// Where the body's surface is written: beside the file of Standard Input Data, with the ending .vtk.
std::string surface_file(const std::string& file);

}  // namespace withy::fem
