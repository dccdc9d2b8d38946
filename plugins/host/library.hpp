/// \file
/// Loads one plugin library.
#pragma once

#include <filesystem>

#include "withy/core/plugin/registry.hpp"
#include "withy/plugins/host/manifest.hpp"

namespace withy {

/// Loads the library of a manifest in `directory` (canonical, not exposed) and collects its plugins, which are exactly
/// those the manifest promises. The library stays in memory, whatever comes of it: code of it may be referred to.
/// \throws PluginError saying why the library is refused; the floating-point state is then as before.
Enrollment load_library(const std::filesystem::path& directory, const Manifest& manifest);

}  // namespace withy
