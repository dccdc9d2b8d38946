/// \file
/// Commands that users can repeat, as texts for a shell.
#pragma once

#include <string>
#include <vector>

namespace withy {

/// In single quotes, for a shell.
std::string quoted(const std::string& text);

/// `command` with a file, then " --plugins FOLDER" for each of these; names that a shell would take apart in quotes.
std::string command_with(const std::string& command, const std::string& file,
                         const std::vector<std::string>& plugin_folders);

}  // namespace withy
