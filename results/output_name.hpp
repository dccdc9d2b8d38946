/// \file
/// Names of files that commands write: none takes the place of what the same command reads, and a name that nobody gave
/// takes the place of nothing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace withy {

struct Scene;

/// \throws study::InputError where a file to be written is one of those that are read, by whatever name or link
void keep_inputs(const std::filesystem::path& out, const std::vector<std::filesystem::path>& read);

/// \throws study::InputError where one of the names in a folder is, or is a folder that holds, one of the files that
/// are read
void keep_inputs_in(const std::filesystem::path& folder, const std::vector<std::string>& names,
                    const std::vector<std::filesystem::path>& read);

/// The file to write: as its user named it, else `otherwise`. \param force replaces a file that nobody named
/// \throws study::InputError where nobody named a file that is there and `force` is false; as keep_inputs
std::string output_name(const std::string& given, const std::filesystem::path& otherwise, bool force,
                        const std::vector<std::filesystem::path>& read);

/// The name of a file with another ending, in the working folder.
std::filesystem::path renamed(const std::filesystem::path& file, const char* ending);

/// The file of a scene, those that it names, and one more where that is not empty.
std::vector<std::filesystem::path> files_of(const Scene& scene, const std::string& also = {});

/// What was left out, a line each, then the name of the file written.
std::string written_text(const std::vector<std::string>& remarks, const std::string& file);

}  // namespace withy
