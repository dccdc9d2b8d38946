/// \file
/// What a plugin library says about itself before it is loaded.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace withy {

/// The file `<name>.plugin` beside a library:
///
///     [withy-plugin]
///     library = beam.so
///     entry = withy_plugin_beam
///     provides = body/beam
///     version = 0.1.0
struct Manifest {
  std::string library;                ///< name of a file in the manifest's directory
  std::string entry;                  ///< symbol of the descriptor
  std::vector<std::string> provides;  ///< "kind/id", sorted, at least one
  std::string version;
};

/// \throws PluginError where the file cannot be read or is malformed.
Manifest read_manifest(const std::filesystem::path& file);

}  // namespace withy
