/// \file
/// What the program does, told to those who ask for it.
#pragma once

#include <string_view>

namespace withy::program {

/// Writes a line to standard error, behind the time of day: standard output carries results alone.
void log(std::string_view line);

}  // namespace withy::program
