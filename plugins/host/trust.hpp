/// \file
/// Whether a file can be loaded as code: only what nobody controls who does not control the program itself.
#pragma once

#include <filesystem>
#include <string>

namespace withy {

/// Why somebody could replace or change the file or directory who could not replace this program, in a sentence; empty
/// where nobody can. Trusted are root, the user, owners of the program's own library and of the folders above it,
/// groups that may write those, and a user's own group. Looks at the path itself and at every directory above it; a
/// sticky directory, as /tmp, protects what is in it. `path` is canonical. \throws std::filesystem::filesystem_error
std::string exposure(const std::filesystem::path& path);

/// The same of a file, no symbolic link, in a directory that is not exposed: it remains to look at the file itself.
std::string exposure_in_safe_directory(const std::filesystem::path& file);

}  // namespace withy
