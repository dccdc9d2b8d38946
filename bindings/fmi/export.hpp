/// \file
/// Makes an FMU of a scene.
#pragma once

#include <filesystem>

#include "withy/bindings/fmi/model_description.hpp"

namespace withy::fmi {

struct Export {
  int version = 2;  ///< of the standard, 2 or 3
  bool model_exchange = true, co_simulation = true;
  std::filesystem::path out;
};

/// What an FMU has become.
struct Exported {
  Description description;
  Variables variables;
  std::uintmax_t bytes = 0;
};

/// Writes the FMU: model description, library, scene and files, documentation, licences.
/// \param options with which the scene was prepared: the FMU makes it in the same way
/// \throws study::InputError where the scene cannot be an FMU; std::system_error where a file cannot be read or
/// written; PluginError where withy was installed without the library for FMUs.
Exported export_fmu(const study::Prepared& prepared, const SceneOptions& options, Registry& registry,
                    const Export& what);

}  // namespace withy::fmi
