/// \file
/// Line charts as text.
#pragma once

#include <string>
#include <vector>

#include "withy/results/svg_plot.hpp"

namespace withy {

/// The panels below each other, each 78 characters wide, drawn with Braille dots; each of several curves with a letter
/// of its own, which the legend says.
std::string terminal_plot(const std::vector<std::string>& legend, const std::vector<Panel>& panels);

}  // namespace withy
