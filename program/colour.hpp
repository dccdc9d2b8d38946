/// \file
/// Colours on terminals: what went well and what did not is seen before it is read.
#pragma once

#include <string>
#include <string_view>

namespace withy::program {

/// Whether a stream (1, 2) is a terminal that shows colours: the variable NO_COLOR is not set, and TERM is not `dumb`.
bool shows_colours(int stream) noexcept;
/// How runs ended, as words of a text, green or red.
std::string with_outcomes_coloured(std::string_view text);
/// The place at the head of each line, "scene.yaml:3:7:", bold.
std::string with_places_bold(std::string_view text);

}  // namespace withy::program
