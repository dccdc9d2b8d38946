/// \file
/// Files of a store that several processes may write at once: each writes a part of its own, which takes the file's
/// name when it is whole.
#pragma once

#include <filesystem>

namespace withy::campaign {

/// A name beside a file that no other thread, process or machine has: "table.csv.part4711-123.node7".
std::filesystem::path own_part(const std::filesystem::path& file);

/// Removes what processes that were killed have left of a file. Of this machine that is known; a part that another one
/// has written stays until nothing was written to it for a day.
void clear_parts(const std::filesystem::path& file);

}  // namespace withy::campaign
