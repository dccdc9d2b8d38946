/// \file
/// Folders for results.
#pragma once

#include <filesystem>

namespace withy {

/// Makes a folder and those above it. \throws std::runtime_error that says why not, and what to do
void make_folder(const std::filesystem::path& path);

}  // namespace withy
