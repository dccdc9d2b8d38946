/// \file
/// A picture of several runs of one scene.
#pragma once

#include <string>

#include "withy/study/comparison.hpp"

namespace withy {

/// As SVG: the tree in every run halfway, or where the run stopped, in the plane it takes up most of; how far the last
/// tip is from where the reference has it; tip deflections and the coordinates of one-coordinate hinges over time. The
/// axes fit the runs that were completed; one that diverged leaves the frame, and ends at a cross.
std::string comparison_picture(const std::string& title, const study::Comparison& comparison);

}  // namespace withy
