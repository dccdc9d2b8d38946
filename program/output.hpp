/// \file
/// What the program prints: every byte is known to have left it, or the program fails.
#pragma once

#include <string_view>

namespace withy::program {

/// Writes to standard output; lines of words that are too long for a terminal are folded there. \throws
/// std::system_error
void print(std::string_view text);
/// Makes sure that what was printed has left the program. \throws std::system_error
void finish_printing();
/// Writes to standard error, ending the text's last line if it does not end itself; folded alike.
void complain(std::string_view text) noexcept;
/// Whether anything was complained of.
bool has_complained() noexcept;

}  // namespace withy::program
