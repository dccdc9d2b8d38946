/// \file
/// A picture of several runs of one scene.
#pragma once

#include <string>
#include <vector>

#include "withy/study/comparison.hpp"

namespace withy {

/// Tip deflections and the coordinates of one-coordinate hinges over time, as SVG. The axes fit the runs that were
/// completed; one that diverged leaves the frame.
std::string comparison_picture(const std::string& title, const std::vector<const study::ComparedRun*>& runs);

}  // namespace withy
