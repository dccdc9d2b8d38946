/// \file
/// Whether a file can be loaded as code: only what its owner alone controls.
#pragma once

#include <filesystem>
#include <string>

namespace withy {

/// Why anybody could replace or change the file or directory, in a sentence; empty where only its owner (and group)
/// can. Looks at the path itself and at every directory above it; a sticky directory, as /tmp, protects what is in it.
/// `path` is canonical. \throws std::filesystem::filesystem_error
std::string exposure(const std::filesystem::path& path);

/// The same of a file, no symbolic link, in a directory that is not exposed: it remains to look at the file itself.
std::string exposure_in_safe_directory(const std::filesystem::path& file);

}  // namespace withy
