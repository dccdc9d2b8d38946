/// \file
/// Finished runs, by the pages that they left: taken together on one page, or as motion for other programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace withy {

/// The runs on the page of a folder, or on the page itself: what RunReport::write wrote of each.
/// \param out the file to be written
/// \throws study::InputError where there is no such folder, or the page is `out`; ResultsError where it holds no page
std::vector<std::string> runs_at(const std::filesystem::path& given, const std::filesystem::path& out);
/// Their titles, each once.
std::string title_of_runs(const std::vector<std::string>& runs);
/// Writes the motion of runs where the name ends with .glb (glTF) or .pvd (a series for ParaView); false where it does
/// not. \throws std::system_error
bool write_motion(const std::filesystem::path& out, const std::vector<std::string>& runs);

}  // namespace withy
