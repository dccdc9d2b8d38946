/// \file
/// Sentences on terminals: lines that are too long go on below, between words.
#pragma once

#include <string>
#include <string_view>

namespace withy::program {

/// Columns of a terminal that a stream (1, 2) is, at most 100; 0 where it is none.
std::size_t columns_of(int stream) noexcept;
/// The text with lines of at most `width` characters, as far as words let them. What goes on stands below where the
/// words of its line begin: behind a label and two or more spaces, or else two spaces in. Tables, which have a rule,
/// and commands of this program stay as they are.
std::string folded(std::string_view text, std::size_t width);

}  // namespace withy::program
