/// \file
/// Which build of the project is running.
#pragma once

#include <string>

namespace withy {

struct BuildIdentity {
  std::string version;      ///< "0.1.0"
  std::string description;  ///< by git, as "v0.1.0-12-g1a2b3c4"; empty where it was not built from a repository
  std::string build;        ///< SHA-256 of the build ids of the project's libraries in this process
};
/// The same for the life of the process. Plugins are not part of it.
const BuildIdentity& build_identity();

/// The build id that the linker gave a library of this process, in hexadecimal digits, or else the SHA-256 of the file;
/// empty where it cannot be read, or the file is none, as "built in".
std::string library_identity(const std::string& file);

}  // namespace withy
